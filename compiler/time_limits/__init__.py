"""A limit of time that long computations ask about."""
