"""Graphs of automata, words, robots and cells, and their files."""
