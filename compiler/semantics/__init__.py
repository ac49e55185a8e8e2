"""The semantic rules of a derivation, applied: robot families (FRG, Definition 6)."""
