"""Grammars and automata over words of modules: recognition, enumeration, counting, ambiguity."""
