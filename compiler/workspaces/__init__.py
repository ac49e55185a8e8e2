"""Exact polytopes, maps of obstacles, and the abstraction of a workspace into cells."""
