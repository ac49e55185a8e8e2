"""The name under which the obstacles of a map are avoided."""

from __future__ import annotations

import posixpath
import re

from grammar_lang.parsing.tables import RESERVED

_NO_LETTER = re.compile(r"[^A-Za-z0-9_]")


def map_name(path: str) -> str:
    """The name of a file without its end, as a NAME: ``maps/yard 2.yaml`` is ``yard_2``.

    What no NAME holds becomes ``_``; a first digit and a reserved word get one in front.
    """
    stem = posixpath.splitext(posixpath.basename(path))[0]
    name = _NO_LETTER.sub("_", stem)
    return f"_{name}" if not name or name[0].isdigit() or name in RESERVED else name
