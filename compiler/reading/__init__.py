"""Reading words from left to right: automata as fast as Python reads, and residuals."""
