"""The check of a refutation: the list of structures, and the evidence of each."""
