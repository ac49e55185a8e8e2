"""Meshes: read with care, taken apart into convex pieces, and every triangle checked to be in one."""
