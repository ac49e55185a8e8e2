"""Export designs to other tools."""
