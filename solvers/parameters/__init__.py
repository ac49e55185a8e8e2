"""The search for the parameters of a path."""
