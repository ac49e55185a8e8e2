"""What an editor holds of files counts more than what stands on the disk."""

from __future__ import annotations

from pathlib import Path

from grammar_lang.diagnostics.diagnostic import Sink
from grammar_lang.files.file_tree import LIMIT
from grammar_lang.load import load, load_text
from grammar_lang.parsing.lalr import Parser
from grammar_lang.parsing.tables import tables
from grammar_lang.parsing.tokens import cut, tokenise
from grammar_lang.parsing.tree_builder import BUILDERS

MAIN = 'include "parts.srg";\nmodule A { role link; }\n'


def errors(found: object) -> list[str]:
    return [d.code.name for d in found.diagnostics if d.severity.value == "error"]  # type: ignore[attr-defined]


def test_an_open_include(tmp_path: Path) -> None:
    parts = tmp_path / "parts.srg"
    parts.write_text("module A { role base; }\n", encoding="utf-8")
    on_disk = load_text(MAIN, str(tmp_path / "main.srg"), tmp_path)
    assert errors(on_disk) == ["DUPLICATE_NAME"]
    held = {str(parts.resolve()): b"module B { role base; }\n"}
    as_held = load_text(MAIN, str(tmp_path / "main.srg"), tmp_path, held)
    assert errors(as_held) == []
    assert as_held.sources[1].data == held[str(parts.resolve())]
    assert as_held.syntax is not None
    assert len(as_held.syntax.items) == 3


def test_an_open_file_that_is_not_on_the_disk(tmp_path: Path) -> None:
    held = {str((tmp_path / "parts.srg").resolve()): b"module B { role base; }\n"}
    assert errors(load_text(MAIN, "main.srg", tmp_path, held)) == []
    assert errors(load_text(MAIN, "main.srg", tmp_path)) == ["UNREADABLE_REFERENCE"]


def test_an_open_main_file(tmp_path: Path) -> None:
    main = tmp_path / "main.srg"
    main.write_text("module A { role link; }\n", encoding="utf-8")
    held = {str(main.resolve()): b"module A { role bse; }\n"}
    assert errors(load(main)) == []
    assert errors(load(main, held)) == ["UNKNOWN_NAME"]


def test_limits_hold_for_what_is_held(tmp_path: Path) -> None:
    held = {str((tmp_path / "parts.srg").resolve()): b" " * (LIMIT + 1)}
    assert errors(load_text(MAIN, "main.srg", tmp_path, held)) == ["TOO_LARGE"]


def test_syntax_survives_errors() -> None:
    loaded = load_text("module A { role link; }\nmodule B { rle base; role base; }\n", "x.srg")
    assert errors(loaded) == ["SYNTAX"]
    assert loaded.program is None
    assert loaded.syntax is not None
    assert len(loaded.syntax.items) == 2


def expected(text: str) -> frozenset[str]:
    tokens = tokenise(text)
    *_, last = cut(tokens)
    return Parser(tables(), tokens, BUILDERS, lambda *_: True).expected(last)


def test_what_may_stand_next() -> None:
    assert expected("task T { reach R") >= {"by", "at", ";"}
    assert expected("module M { dof q:") == {"revolute", "prismatic"}
    assert "UNIT" in expected("module M { const a = 3")
    assert expected("task T { avoid O with") == {"effector", "body"}
    # A statement that cannot be read is behind us.
    assert "horizon" in expected("task T { reach reach reach;")
    assert expected("module 5 5") == expected("module 5 5 5")


def test_what_it_says_is_what_the_parser_takes() -> None:
    """Each terminal that is said to fit shifts no error's place before itself."""
    text = "workspace W { region S"
    for word in sorted(expected(text)):
        sink = Sink()
        from grammar_lang.parsing.parse import parse

        parse(f"{text} {word} @", sink)
        assert all(found.span.start > len(text) for found in sink.found), word
