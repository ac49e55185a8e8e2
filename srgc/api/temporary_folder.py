"""Folders that last as long as what refers to them."""

from __future__ import annotations

import shutil
import tempfile
import weakref
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True, slots=True, weakref_slot=True)
class TemporaryFolder:
    """A new folder, which is removed when nothing refers to this any more."""

    path: Path

    @classmethod
    def made(cls, files: Mapping[str, bytes] | None = None) -> TemporaryFolder:
        """A new one, with these files in it."""
        folder = cls(Path(tempfile.mkdtemp(prefix="srgc-")))
        weakref.finalize(folder, shutil.rmtree, folder.path, ignore_errors=True)
        for name, content in (files or {}).items():
            place = folder.path / name
            place.parent.mkdir(parents=True, exist_ok=True)
            place.write_bytes(content)
        return folder

    def files(self) -> dict[str, bytes]:
        """All that is in it."""
        return {
            path.relative_to(self.path).as_posix(): path.read_bytes()
            for path in sorted(self.path.rglob("*"))
            if path.is_file()
        }
