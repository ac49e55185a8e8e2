"""Name resolution: the entity that each name of a specification refers to."""
