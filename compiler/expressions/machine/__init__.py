"""Expression graphs in balls of doubles, by one compiled loop."""
