"""Starter files, and what `srgc new` says about them."""
