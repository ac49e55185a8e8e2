"""Records that are made once: files with what they are of; a run goes on where it ended."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from timing import ROOT

from srgc.version import VERSION


def digest(spec: str) -> str:
    """The SHA-256 digest of a shipped specification, by its name without the ending."""
    return hashlib.sha256((ROOT / "specs" / f"{spec}.srg").read_bytes()).hexdigest()


def kept(path: Path, of: Mapping[str, Any], make: Callable[[], Any]) -> Any:
    """The content of a record, made and written where there is none of the same version.

    Args:
        path: the file.
        of: what the content depends on, as values of JSON; the version of srgc is added.
        make: gives the content, of values of JSON.
    """
    known = {**of, "version": VERSION}
    if path.exists():
        record = json.loads(path.read_text(encoding="utf-8"))
        if record["of"] == known:
            return record["content"]
    content = make()
    path.parent.mkdir(parents=True, exist_ok=True)
    text = json.dumps({"of": known, "content": content}, indent=1, allow_nan=False)
    unfinished = path.with_suffix(".part")
    unfinished.write_text(f"{text}\n", encoding="utf-8")
    unfinished.replace(path)
    return content
