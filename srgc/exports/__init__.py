"""Designs for other tools."""
