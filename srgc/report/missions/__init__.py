"""The page about a mission: its robots, their motions, and what is proved about other robots."""
