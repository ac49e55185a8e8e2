"""Automata, words, robots and cells as graphs, and their files."""
