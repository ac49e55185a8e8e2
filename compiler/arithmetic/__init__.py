"""Scalar expressions, and balls and rationals that enclose their values."""
