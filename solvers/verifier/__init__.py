"""The independent verifier, which decides whether a verdict holds. It imports no searcher."""
