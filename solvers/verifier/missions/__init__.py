"""Check missions: designs that belong together, and robots that cannot do their tasks."""
