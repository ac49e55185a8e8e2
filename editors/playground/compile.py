"""Runs in Pyodide while the page is built: compiled modules in place of sources, the first apart.

A browser that has to compile what it imports starts several times as slowly, and one that unpacks
modules which it does not import yet starts later.
"""

from __future__ import annotations

import json
import marshal
import sys
from importlib.util import MAGIC_NUMBER, source_hash
from pathlib import Path
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


def split_archive(source: str, first: str, rest: str) -> None:
    """Compile an archive of srgc into two: what the first findings need, and the other modules.

    The modules of the first are those that checking the starters of `srgc new` and explaining a
    code import.  All other files are in the first as well: a module that is missing is an error
    that the page sees, while another file that is missing might be taken for an answer.
    """
    compile_archive(source, "/whole.zip")
    with ZipFile("/whole.zip") as whole:
        whole.extractall("/whole")
        imported = _imported([name for name in whole.namelist() if name.endswith(".srg")])
        with ZipFile(first, "w") as early, ZipFile(rest, "w") as late:
            for name in whole.namelist():
                is_late = name.endswith(".pyc") and f"/whole/{name}" not in imported
                target = late if is_late else early
                target.writestr(ZipInfo(name), whole.read(name), ZIP_DEFLATED)


def _imported(specs: list[str]) -> set[str | None]:
    """The files of the modules that are imported for the first findings."""
    sys.path.insert(0, "/whole")
    from srgc.playground.answers import answer

    for name in specs:
        if name.startswith("srgc/starters/"):
            text = Path("/whole", name).read_text(encoding="utf-8")
            answer(json.dumps({"ask": "check", "text": text}))
    answer(json.dumps({"ask": "explain", "text": "", "code": "301"}))
    return {getattr(module, "__file__", None) for module in sys.modules.values()}
