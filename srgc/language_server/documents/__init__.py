"""Open documents, the programs they belong to, and the findings about them."""
