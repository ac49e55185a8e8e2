"""Adapters to native solvers, and the meaning of their answers."""
