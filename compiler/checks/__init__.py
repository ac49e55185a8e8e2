"""Findings about grammars, robots, workspaces and tasks."""
