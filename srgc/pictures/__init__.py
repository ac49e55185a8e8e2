"""Figures of results, cells and plans, as SVG."""
