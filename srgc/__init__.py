"""The public face of srgc."""
