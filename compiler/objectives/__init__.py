"""The objectives that a task minimises: modules, mass, effort and sums of attributes."""
