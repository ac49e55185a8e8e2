"""Missions: boxes of parameters, what it takes to rebuild a robot, and the cheapest chains."""
