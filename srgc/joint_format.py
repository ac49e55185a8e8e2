"""The file beside a URDF with what that has no place for: how it is called, and what it says it is.

``srgc export`` writes it, ``srgc import`` reads it.
"""

from __future__ import annotations

FORMAT = "srgc joints 1"
SUFFIX = ".joints.json"
"""In place of the suffix of the URDF."""
