"""Expression graphs in balls of doubles, evaluated by one compiled loop."""
