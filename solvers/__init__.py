"""Search and check.  Empty on purpose: importing the verifier must not load any search code."""
