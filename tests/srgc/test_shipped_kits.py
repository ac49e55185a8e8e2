"""Shipped kits and what `srgc expand` prints of them: same grammars, robots and certificates."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from grammar_lang import ir
from grammar_lang.diagnostics.diagnostic import Sink
from grammar_lang.files.file_tree import LIBRARY
from grammar_lang.formatting.expansion import expanded
from grammar_lang.formatting.formatter import canonical
from grammar_lang.load import Loaded, load
from tests.oracles.some_cases import some
from tests.srgc.conftest import ROOT, Ran

Run = Callable[..., Ran]
FILES = sorted([*(ROOT / "specs").glob("*.srg"), *(ROOT / "srgc" / "starters").glob("*.srg")])


def has_ports(loaded: Loaded) -> bool:
    return loaded.program is not None and any(
        grammar.listed for grammar in loaded.program.grammars.values()
    )


KITS = [file for file in FILES if has_ports(load(file))]
CHEAPEST_FIRST = sorted(KITS, key=lambda file: file.stem != "pelican_reach")


def needed(program: ir.Program) -> ir.Program:
    """What the tasks are about, without how the text is spread over files."""
    names = {task.grammar for task in program.tasks.values()}
    grammars = {name: grammar for name, grammar in program.grammars.items() if name in names}
    used = {x.name for g in grammars.values() for p in g.productions for x in p.right}
    modules = {name: module for name, module in program.modules.items() if name in used}
    terminals = tuple(name for name in program.terminals if name in used)
    return replace(program, modules=modules, terminals=terminals, grammars=grammars, sources=())


def test_there_are_kits() -> None:
    """The starter, and a spec for at least six robots of the library."""
    texts = [file.read_text(encoding="utf-8") for file in KITS if file.parent.name == "specs"]
    assert len([text for text in texts if "include std" in text]) >= 6
    assert len(KITS) > len(texts)
    assert len([text for text in texts if "include std" in text and "avoid self" in text]) >= 6


@pytest.mark.parametrize("file", KITS, ids=lambda file: file.stem)
def test_an_expanded_kit_is_the_kit(file: Path, tmp_path: Path, srgc: Run) -> None:
    loaded = load(file)
    text = expanded(loaded)
    assert "from ports" not in text
    assert canonical(text, Sink()) == text
    # Maps and meshes are looked for beside the spec.
    shutil.copytree(
        file.parent, tmp_path, ignore=shutil.ignore_patterns("*.srg"), dirs_exist_ok=True
    )
    path = tmp_path / file.name
    path.write_text(text, encoding="utf-8")
    again = load(path)
    assert loaded.program is not None
    assert again.program is not None, again.diagnostics
    assert needed(again.program) == needed(loaded.program)
    findings = json.loads(srgc("check", "--json", path).out)
    assert {found["severity"] for found in findings} <= {"note"}


def claimed(folder: Path) -> dict[str, Any]:
    """The certificate but for the specification."""
    found = json.loads((folder / "certificate.json").read_text(encoding="utf-8"))
    return {
        key: value for key, value in found.items() if key not in {"spec", "spec_sha256", "digest"}
    }


@pytest.mark.parametrize("path", some(CHEAPEST_FIRST, 1), ids=lambda path: path.stem)
def test_an_expanded_kit_has_the_same_certificate(path: Path, tmp_path: Path, srgc: Run) -> None:
    # Maps and meshes are looked for beside the spec.
    shutil.copytree(
        path.parent, tmp_path, ignore=shutil.ignore_patterns("*.srg"), dirs_exist_ok=True
    )
    (tmp_path / "again.srg").write_text(expanded(load(path)), encoding="utf-8")
    for name, file in (("first", path), ("second", tmp_path / "again.srg")):
        assert srgc("synth", file, "-o", tmp_path / name, "-q").status == 0
        assert srgc("verify", tmp_path / name, "-q").status == 0
    first, second = claimed(tmp_path / "first"), claimed(tmp_path / "second")
    assert first.keys() == second.keys()
    assert first == second


def test_the_library_is_in_the_package() -> None:
    assert Path(LIBRARY).is_dir()
    assert {file.suffix for file in Path(LIBRARY).iterdir()} == {".srg"}
