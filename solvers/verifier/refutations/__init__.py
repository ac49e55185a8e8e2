"""Check a refutation: the list of structures, and the evidence against each."""
