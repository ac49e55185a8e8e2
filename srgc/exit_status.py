"""The exit statuses of the commands."""

from __future__ import annotations

FOUND, REFUSED, USAGE, IMPOSSIBLE, UNKNOWN, SPEC_ERRORS, UNEXPECTED = 0, 1, 2, 3, 4, 5, 6
INTERNAL, INTERRUPTED, NO_READER = 70, 130, 141
VERDICT_STATUS = {"found": FOUND, "impossible": IMPOSSIBLE, "unknown": UNKNOWN}
