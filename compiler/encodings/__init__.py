"""Tasks as SAT and SMT problems."""
