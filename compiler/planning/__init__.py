"""Planning problems as clauses: paths of cells that satisfy a formula."""
