"""Search and check.  Empty on purpose: importing the verifier must load no searcher."""
