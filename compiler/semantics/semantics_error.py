"""The error of semantic rules that define no robot."""

from __future__ import annotations


class SemanticsError(ValueError):
    """The semantic rules do not give a robot for this derivation."""
