"""Compare results with each other, and a design with the robots that would have less."""
