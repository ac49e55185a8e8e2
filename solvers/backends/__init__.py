"""Adapters to native solvers, and what their answers may mean."""
