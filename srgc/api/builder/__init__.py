"""Specifications built in Python: modules, grammars, workspaces and tasks."""
