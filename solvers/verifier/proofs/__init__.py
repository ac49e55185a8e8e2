"""Validated integration, and what is proved along the tube."""
