"""Kinematics and the equations of motion as one expression graph."""
