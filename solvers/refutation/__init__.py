"""Poses that answer a question about a structure, or a script that refutes it."""
