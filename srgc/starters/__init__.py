"""Starter files, and what ``srgc new`` prints about them."""
