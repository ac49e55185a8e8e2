"""Finite and pushdown automata: the accept condition, the SRA and the FRA."""
