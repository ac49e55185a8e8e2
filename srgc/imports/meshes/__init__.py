"""Read meshes, decompose them into convex pieces, and check that these hold every triangle."""
