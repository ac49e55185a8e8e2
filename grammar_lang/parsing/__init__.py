"""Parsing: from text to abstract syntax, with the grammar of the language."""
