"""The file of joint data that accompanies a URDF: its format and the suffix of its name.

It holds what URDF cannot express.  ``srgc export`` writes it, ``srgc import`` reads it.
"""

from __future__ import annotations

FORMAT = "srgc joints 1"
SUFFIX = ".joints.json"
"""Replaces the suffix of the URDF file."""
