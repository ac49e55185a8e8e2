"""What tasks say: formulas, their monitors, necessary conditions, and plans as clauses."""
