"""Runs in Pyodide while the page is built: compiled modules in place of sources.

A browser that has to compile what it imports starts several times as slowly.
"""

from __future__ import annotations

import marshal
from importlib.util import MAGIC_NUMBER, source_hash
from zipfile import ZIP_DEFLATED, ZipFile, ZipInfo

UNCHECKED = (1).to_bytes(4, "little")
"""Of a compiled module that is never compared with its source (PEP 552)."""


def compile_archive(source: str, target: str) -> None:
    """Copy an archive, with `module.pyc` for `module.py`."""
    with ZipFile(source) as old, ZipFile(target, "w") as new:
        for name in sorted(old.namelist()):
            data = old.read(name)
            if name.endswith(".py"):
                code = marshal.dumps(compile(data, name, "exec", dont_inherit=True))
                data = MAGIC_NUMBER + UNCHECKED + source_hash(data) + code
            made = name.removesuffix(".py") + ".pyc" if name.endswith(".py") else name
            new.writestr(ZipInfo(made), data, ZIP_DEFLATED)
