"""What a task wants to be least: modules, mass, effort and sums of attributes."""
