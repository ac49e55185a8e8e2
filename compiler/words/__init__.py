"""Grammars and automata over words of modules: reading, listing, counting, ambiguity."""
