"""Validated integration, and the proofs along the resulting tube."""
