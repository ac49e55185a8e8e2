"""Bounds that hold along every motion of a robot: what its drives can do at most."""
