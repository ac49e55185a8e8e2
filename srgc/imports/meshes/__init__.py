"""Meshes: read with care, cut into convex pieces, and every triangle checked to be in these."""
