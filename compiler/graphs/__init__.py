"""Labelled graphs of robots (Definition 1)."""
