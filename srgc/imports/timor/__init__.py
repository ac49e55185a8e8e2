"""Import module sets of Timor, a toolbox for modular robots (Külz, Mayer, Althoff, 2023)."""
