"""Pages that show programs and what ``srgc check`` says about them: every word of it is compared.

``make golden`` rewrites what the pages show; this test fails once then, so that nobody does so
without looking at the difference.
"""

from __future__ import annotations

import os
import re
from contextlib import redirect_stderr, redirect_stdout
from io import StringIO
from pathlib import Path

import pytest

import srgc.cli
from grammar_lang.diagnostics.code_pages import (
    FOLDER,
    Example,
    catalogue,
    examples,
    find_code,
    page_text,
    read_page,
)
from grammar_lang.diagnostics.diagnostic import Code
from grammar_lang.diagnostics.render import to_text
from srgc.session import check_file

ROOT = Path(__file__).parents[1]
GOLDEN = sorted((ROOT / "tests" / "golden").glob("*.md"))
CATALOGUE = sorted(FOLDER.glob("*.md"))
ALL_CODES = ROOT / "docs" / "reference" / "codes.md"
UPDATE = "UPDATE_GOLDEN" in os.environ

# The files of examples that a page cannot show, by page.
UNPRINTABLE: dict[str, dict[str, bytes]] = {
    "SRG0101": {},
    "SRG0102": {
        "spec.srg": "// Greifer für Äpfel\nmodule Grip { role effector; }\n".encode("cp1252")
    },
    "SRG0110": {"spec.srg": b" " * 9_000_000},
    "SRG0735": {"out/Fetch/design.json": b'{"verdict": "impossible"}'},
    "files": {
        "latin.srg": "module B { role base; }  // Fuß\n".encode("cp1252"),
        "wide.srg": b"m\0o\0d\0u\0l\0e\0 \0B\0",
    },
}


def shown(example: Example, page: Path, folder: Path) -> tuple[str, list[str]]:
    """What is printed about an example, and the severities in it."""
    folder.mkdir()
    for name, content in example.files:
        place = folder / name
        place.parent.mkdir(exist_ok=True)
        place.write_text(content, encoding="utf-8")
    if not example.files or example.command is not None:
        for name, data in UNPRINTABLE.get(page.stem, {}).items():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            (folder / name).write_bytes(data)
    before = Path.cwd()
    try:
        os.chdir(folder)
        if example.command is not None:
            return said_by(example.command)
        checked = check_file(Path(example.checked))
    finally:
        os.chdir(before)
    found = checked.diagnostics
    return to_text(found, checked.sources), [d.severity.value for d in found]


def said_by(command: str) -> tuple[str, list[str]]:
    """What another command than a check says, and whether it is an error."""
    told = StringIO()
    with redirect_stderr(told), redirect_stdout(told):
        status = srgc.cli.run(command.split())
    assert status in {0, 2}
    return told.getvalue(), ["error"] if status else []


def rewrite(page: Path, text: str, printed: list[tuple[Example, str]]) -> None:
    """Put what was printed in the place of what the page says."""
    new = text
    for example, output in reversed(printed):
        if example.expected is not None:
            start, end = example.place
            new = new[:start] + output + new[end:]
    if new != text:
        page.write_text(new, encoding="utf-8")
        pytest.fail(f"{page.name} is rewritten: read the difference, then run again")


@pytest.mark.parametrize("page", [*GOLDEN, *CATALOGUE], ids=lambda page: page.stem)
def test_pages_show_what_is_printed(page: Path, tmp_path: Path) -> None:
    text = page.read_text(encoding="utf-8")
    printed = []
    for number, example in enumerate(examples(text)):
        output, severities = shown(example, page, tmp_path / str(number))
        printed.append((example, output))
        if example.expected is None:
            assert "error" not in severities, output
        elif not UPDATE:
            assert output == example.expected
    assert printed
    if UPDATE:
        rewrite(page, text, printed)


@pytest.mark.parametrize("file", CATALOGUE, ids=lambda file: file.stem)
def test_a_page_is_about_its_code_alone(file: Path, tmp_path: Path) -> None:
    page = read_page(file.read_text(encoding="utf-8"))
    assert page.code.value == file.stem
    assert {code for _, code in page.failing.findings} == {file.stem}
    repaired, severities = shown(page.repaired, file, tmp_path / "repaired")
    assert "error" not in severities
    assert file.stem not in repaired
    assert page.title[0].islower() or page.title.split()[0].isupper()
    assert not page.title.endswith(".")
    assert len(page.title) <= 60
    assert 60 <= len(page.why) <= 1200


def test_every_code_has_a_page() -> None:
    pages = {file.stem for file in CATALOGUE}
    codes = {code.value for code in Code}
    assert pages == codes


@pytest.mark.parametrize("page", GOLDEN, ids=lambda page: page.stem)
def test_golden_pages_are_for_reading(page: Path) -> None:
    """A title, prose before every program, and several mistakes."""
    text = page.read_text(encoding="utf-8")
    assert re.match(r"# [A-Z].+\n\n[\w`]", text)
    assert not re.search(r"^```\n\n```srg$", text, re.MULTILINE)
    assert sum(len(example.findings) for example in examples(text)) >= 3


def test_the_page_of_all_codes_is_up_to_date() -> None:
    if UPDATE and ALL_CODES.read_text(encoding="utf-8") != catalogue():
        ALL_CODES.write_text(catalogue(), encoding="utf-8")
        pytest.fail("docs/reference/codes.md is rewritten: read the difference, then run again")
    assert ALL_CODES.read_text(encoding="utf-8") == catalogue()


def test_the_contents_of_the_page_of_all_codes_lead_to_its_headings() -> None:
    text = ALL_CODES.read_text(encoding="utf-8")
    headings = {
        re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")
        for heading in re.findall(r"^## (.+)$", text, re.MULTILINE)
    }
    links = re.findall(r"\]\(#([^)]+)\)", text)
    assert set(links) == headings
    assert len(links) == len(headings) == len(CATALOGUE)


# --- reading pages --------------------------------------------------------------------------------

PAGE = """\
# SRG0301: a title

Why.

Fails:

```srg
include "m.srg";
```

```srg m.srg
one
```

```diagnostics
spec.srg:1:1: error[SRG0301]: message
```

Repaired:

```srg
two
```
"""


def test_a_page_is_read_into_its_parts() -> None:
    page = read_page(PAGE)
    assert (page.code, page.title, page.why) == (Code.UNIT_MISMATCH, "a title", "Why.")
    assert page.failing.files == (("spec.srg", 'include "m.srg";\n'), ("m.srg", "one\n"))
    assert page.failing.expected == "spec.srg:1:1: error[SRG0301]: message\n"
    start, end = page.failing.place
    assert PAGE[start:end] == page.failing.expected
    assert page.failing.findings == (("error", "SRG0301"),)
    assert (page.repaired.files, page.repaired.expected) == ((("spec.srg", "two\n"),), None)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("# SRG0301: a title", "# SRG301"),
        ("Fails:", "This fails:"),
        ("Repaired:", "Better:"),
        ("```diagnostics", "```text"),
        ("error[", "["),
    ],
)
def test_a_malformed_page_is_refused(old: str, new: str) -> None:
    with pytest.raises(ValueError, match=r"a page has|first example"):
        read_page(PAGE.replace(old, new))


def test_programs_end_at_headings_repairs_and_repeated_names() -> None:
    one, two = "```srg\none\n```\n\n", "```srg\ntwo\n```\n\n"
    for between in ("", "## A heading\n\n", "Repaired:\n\n"):
        found = examples(f"Text\n\n{one}{between}{two}")
        assert [example.files[0][1] for example in found] == ["one\n", "two\n"]
    [whole] = examples("```srg m.srg\none\n```\n\nand\n\n```srg\ntwo\n```\n")
    assert (len(whole.files), whole.checked) == (2, "spec.srg")


def test_a_console_block_names_the_file_that_is_checked() -> None:
    [example] = examples("```console\n$ srgc check a.srg\nthe output\n```\n")
    assert (example.files, example.checked, example.expected) == ((), "a.srg", "the output\n")
    assert examples("```console\n$ srgc words a.srg\nB\n```\n") == ()


def test_a_command_about_a_result_takes_the_program_before_it() -> None:
    """Prose may stand between: what the result is."""
    program, output = "```srg\none\n```\n\nIts result:\n\n", "error[SRG0735]: none\n"
    [example] = examples(f"{program}```console\n$ srgc evolve out/a spec.srg\n{output}```\n")
    assert example.files == (("spec.srg", "one\n"),)
    assert (example.command, example.expected) == ("evolve out/a spec.srg", output)
    assert example.findings == (("error", "SRG0735"),)


@pytest.mark.parametrize("text", ["SRG0301", "srg0301", "0301", "301", " 301 ", "SRG301"])
def test_a_code_is_found_however_it_is_written(text: str) -> None:
    assert find_code(text) is Code.UNIT_MISMATCH


@pytest.mark.parametrize("text", ["", "SRG", "30", "SRG9999", "unit", "-301", "SRG0301x", "٣٠١"])
def test_no_other_text_is_a_code(text: str) -> None:
    assert find_code(text) is None


def test_a_code_without_a_page(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr("grammar_lang.diagnostics.code_pages.FOLDER", tmp_path)
    with pytest.raises(LookupError, match="SRG0301 has no page"):
        page_text(Code.UNIT_MISMATCH)
