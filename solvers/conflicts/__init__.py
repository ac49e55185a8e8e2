"""Tasks that no motion fulfils, and formulas that ask for nothing."""
