"""The time limit of long computations."""
