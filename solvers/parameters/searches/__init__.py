"""Searches for the largest value of a function over the unit cube, one method a file."""
