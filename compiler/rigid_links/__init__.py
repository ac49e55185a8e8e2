"""Robots as trees of rigid links with numeric values, for other tools."""
