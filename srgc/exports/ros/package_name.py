"""Names as ROS 2 takes them for packages (REP 144)."""

from __future__ import annotations

import re

SUFFIX = "robot"
"""Behind a name, so that it is that of no tool; a name needs a letter in front, too."""


def package_name(text: str) -> str:
    """A name of lower-case letters, digits and single underscores that begins with a letter.

    Every text has one; different texts may have the same.
    """
    words = re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", text)
    plain = re.sub(r"[^a-z0-9]+", "_", words.lower()).strip("_")
    if not plain[:1].isalpha():
        plain = f"task_{plain}".strip("_")
    return f"{plain}_{SUFFIX}"
