"""The interval and the exact reading of a graph."""
