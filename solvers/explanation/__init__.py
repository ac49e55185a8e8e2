"""Explain why a task was not met: conflicting lines, and changes that would make it possible."""
