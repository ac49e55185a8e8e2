"""A robot's graph as formulas in canonical form."""
