"""Missions: one robot for several tasks, or robots that are rebuilt between tasks."""
