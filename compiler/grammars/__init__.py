"""The SRG as a context-free grammar over integers, and what is computed on it alone."""
