"""DOT texts of the objects."""
