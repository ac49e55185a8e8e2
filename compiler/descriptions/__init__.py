"""Models of robots written for people, as text and as LaTeX."""
