"""Files: read and included, but never from outside the tree of the main file."""
