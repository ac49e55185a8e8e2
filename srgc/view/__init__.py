"""A live page on which designs move in space."""
