"""Tasks that no motion satisfies, and formulas that demand nothing."""
