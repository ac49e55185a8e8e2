"""Lemmas about all robots of a regular set of words: where their effectors can be at all."""
