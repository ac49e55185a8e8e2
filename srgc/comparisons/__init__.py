"""Results held against each other, and a design against the robots that would have less."""
