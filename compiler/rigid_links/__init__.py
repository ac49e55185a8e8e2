"""Robots as trees of rigid links with numbers, for other tools."""
