"""L(SRG) with its accept condition: membership, enumeration, counting, derivations, ambiguity."""
