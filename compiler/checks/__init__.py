"""Checks of grammars, robots, workspaces and tasks."""
