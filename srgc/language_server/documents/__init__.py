"""Open documents, the programs they make, and what is found in them."""
