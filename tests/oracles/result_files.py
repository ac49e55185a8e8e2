"""Result folders read and altered without any code of the project."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any


def read(folder: Path, name: str = "certificate.json") -> dict[str, Any]:
    content = json.loads((folder / name).read_text(encoding="utf-8"))
    assert isinstance(content, dict)
    return content


def digest(content: dict[str, Any]) -> str:
    """SHA-256 of the compact JSON with sorted keys, without the digest."""
    bare = {key: value for key, value in content.items() if key != "digest"}
    text = json.dumps(bare, sort_keys=True, separators=(",", ":"), ensure_ascii=False)
    return hashlib.sha256(text.encode("utf-8", "surrogatepass")).hexdigest()


def spec_digest(files: dict[str, bytes]) -> str:
    """SHA-256 over paths and contents in order, each behind its length in eight bytes."""
    state = hashlib.sha256()
    for name, content in sorted(files.items()):
        for part in (name.encode(), content):
            state.update(len(part).to_bytes(8, "big") + part)
    return state.hexdigest()


def write(folder: Path, content: dict[str, Any], name: str = "certificate.json") -> None:
    (folder / name).write_text(json.dumps(content, ensure_ascii=False), encoding="utf-8")


def alter(folder: Path, change: Callable[[dict[str, Any]], None], *, sign: bool) -> dict[str, Any]:
    """Change the certificate in place, with the old digest or with one that fits."""
    content = read(folder)
    change(content)
    if sign:
        content["digest"] = digest(content)
    write(folder, content)
    return content


def alter_spec(folder: Path, old: str, new: str, *, sign: bool) -> None:
    """Replace text of the folder's own copy of the spec."""
    copies = folder / "spec"
    path = copies / str(read(folder)["spec"])
    text = path.read_text(encoding="utf-8")
    assert text.count(old) == 1
    path.write_text(text.replace(old, new), encoding="utf-8")
    if sign:
        files = (each for each in copies.rglob("*") if each.is_file())
        value = spec_digest(
            {each.relative_to(copies).as_posix(): each.read_bytes() for each in files}
        )
        alter(folder, lambda c: c.update(spec_sha256=value), sign=True)


def without_boxes(folder: Path) -> None:
    """Leave only the scripts of a claim that all structures are refuted."""

    def leave_out(content: dict[str, Any]) -> None:
        for structure in content["structures"]:
            assert structure["evidence"].endswith(".smt2")
            structure["boxes"] = None

    alter(folder, leave_out, sign=True)
