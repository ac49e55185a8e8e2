"""Diagnostics: their codes, the pages that explain the codes, and how diagnostics are shown."""
