"""The page about a mission: its line of robots, their motions, and what is proved of all others."""
