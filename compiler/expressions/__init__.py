"""Expression graphs, and the evaluators that compute their values."""
