"""Tasks: formulas, their monitors, necessary conditions, and plans as clauses."""
