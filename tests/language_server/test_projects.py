"""Which programs a file is a part of, and what is then said of it."""

from __future__ import annotations

from pathlib import Path

from srgc.language_server.documents.analysis import analyse
from srgc.language_server.documents.projects import Projects, included
from srgc.language_server.documents.published import diagnostics_of
from srgc.language_server.documents.uris import path_of, uri_of


def write(path: Path, text: str) -> str:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")
    return str(path.resolve())


def test_includes_are_seen_but_not_in_comments() -> None:
    text = """include "a.srg"; // include "b.srg";
    /* include "c.srg"; */ include 'd // e.srg' ;"""
    assert included(text) == ["a.srg", "d // e.srg"]


def test_roots(tmp_path: Path) -> None:
    part = write(tmp_path / "lib" / "part.srg", "module A { role base; }\n")
    middle = write(tmp_path / "lib" / "middle.srg", 'include "part.srg";\n')
    one = write(tmp_path / "one.srg", 'include "lib/middle.srg";\n')
    two = write(tmp_path / "two.srg", 'include "lib/part.srg";\n')
    # This one may not include it: it is outside of its folder.
    write(tmp_path / "other" / "three.srg", 'include "../lib/part.srg";\n')
    assert Projects().roots(part, [tmp_path], {}) == [one, two]
    assert Projects().roots(middle, [tmp_path], {}) == [one]
    assert Projects().roots(one, [tmp_path], {}) == [one]
    # Without the folder only what lies beside it is known.
    assert Projects().roots(part, [], {}) == [middle]
    # What is open counts, not what is saved.
    assert Projects().roots(part, [tmp_path], {one: [], two: []}) == [middle]


def test_a_circle_has_no_root(tmp_path: Path) -> None:
    a = write(tmp_path / "a.srg", 'include "b.srg";\n')
    write(tmp_path / "b.srg", 'include "a.srg";\n')
    assert Projects().roots(a, [tmp_path], {}) == [a]


def test_the_findings_of_all_programs(tmp_path: Path) -> None:
    """What is wrong in one program only is told, and what is wrong in both is told once."""
    part = write(tmp_path / "part.srg", "module A { role bse; }\nedge e;\n")
    texts = ('include "part.srg";\n', 'edge e;\ninclude "part.srg";\n')
    analyses = [analyse(str(tmp_path / f"{n}.srg"), text, {}) for n, text in enumerate(texts)]

    def codes(*numbers: int) -> list[str]:
        found = diagnostics_of([analyses[n] for n in numbers], part, uri_of)
        return sorted(str(each.code) for each in found if each.severity == 1)

    assert codes(0) == ["SRG0201"]
    assert codes(1) == ["SRG0201", "SRG0202"]
    assert codes(0, 1) == ["SRG0201", "SRG0202"]


def test_uris() -> None:
    path = Path("/a folder/ü#?%.srg")
    assert path_of(uri_of(path)) == path
    assert path_of("file:///c%3A/x.srg") == Path("/c:/x.srg")
    for uri in ("untitled:Untitled-1", "vscode-vfs://github/a/b.srg", "", "file://[", "file:"):
        assert path_of(uri) is None
