"""Files: read, included, never outside their tree."""
