"""Specifications made by Python, without text: modules, grammars, workspaces, tasks."""
