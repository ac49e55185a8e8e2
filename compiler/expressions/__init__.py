"""Expression graphs, and the evaluators that give them values."""
