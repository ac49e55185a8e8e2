"""How programs, robots, graphs and results show themselves in notebooks, as HTML."""
