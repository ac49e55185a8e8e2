"""Modules whose parameters have values at which they change nothing (Theorem 1)."""
