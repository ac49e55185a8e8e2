"""Specs in canonical form."""
