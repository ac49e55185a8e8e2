"""The search of parameters for a path."""
