"""Figures, algorithm, case study and claims of Chen & Kong, beside what srgc computes.

A part of the page has a file: what it computes is kept as files in a folder, and what it writes of
these is a section.  ``paper_page.py`` is the program.
"""
