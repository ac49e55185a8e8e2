"""The robots that a task admits, in the order in which they are to be tried."""
