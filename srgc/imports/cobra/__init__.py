"""Tasks of CoBRA, a benchmark for robots (Mayer, Külz, Althoff, 2022), in its published schema."""
