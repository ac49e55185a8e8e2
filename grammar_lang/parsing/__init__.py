"""Text to abstract syntax, and the grammar that both follow."""
