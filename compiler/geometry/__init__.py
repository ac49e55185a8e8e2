"""Exact polytopes and the abstraction of a workspace into cells."""
