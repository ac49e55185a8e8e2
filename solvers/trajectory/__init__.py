"""Motions along a path of cells, by sequential convex programming."""
