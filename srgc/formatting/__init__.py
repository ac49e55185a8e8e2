"""Files in canonical form."""
