"""Coverings of a robot's parameters and coordinates by boxes, and what a task asks on a box."""
