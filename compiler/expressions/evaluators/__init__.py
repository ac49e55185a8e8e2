"""Evaluators of expression graphs, one file per kind of value."""
