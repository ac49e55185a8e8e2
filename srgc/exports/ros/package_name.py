"""Make valid names of ROS 2 packages (REP 144)."""

from __future__ import annotations

import re

SUFFIX = "robot"
"""Added to a name so that it differs from names of tools; names also begin with a letter."""


def package_name(text: str) -> str:
    """A name of lower-case letters, digits and single underscores that begins with a letter.

    Every text gives a name; different texts may give the same.
    """
    words = re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", text)
    plain = re.sub(r"[^a-z0-9]+", "_", words.lower()).strip("_")
    if not plain[:1].isalpha():
        plain = f"task_{plain}".strip("_")
    return f"{plain}_{SUFFIX}"
