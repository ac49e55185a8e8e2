"""Import tasks of CoBRA, a benchmark for robots (Mayer, Külz, Althoff, 2022)."""
