"""The catalogue: one Markdown page for every diagnostic code, with examples that the tests run.

A page says why something is a mistake.  It shows the smallest file that makes it, what
``srgc check spec.srg`` prints about that file, and the repaired file.  The idea is from Dafny's
error catalogue (https://dafny.org/dafny/HowToFAQ/Errors), whose examples are run as well.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path
from typing import TypeAlias

from grammar_lang.diagnostics.diagnostic import Code

FOLDER = Path(__file__).with_name("catalogue")
MAIN = "spec.srg"

Files: TypeAlias = tuple[tuple[str, str], ...]

_FENCE = re.compile(r"^```(?P<kind>\w+)[ ]*(?P<name>.*)\n(?P<body>(?s:.*?))^```$", re.MULTILINE)
_BREAK = re.compile(r"^(?:#+ .*|Repaired:)$", re.MULTILINE)
_COMMAND = re.compile(r"\$ srgc (?:check (?P<file>\S+)|(?P<other>(?:evolve|import) .+))\n")
_HEADING = re.compile(r"# (?P<code>SRG\d{4}): (?P<title>.+)\n\n")
_SEVERITY = re.compile(r"^(?:\S+:\d+:\d+: )?(error|warning|note)\[(SRG\d{4})\]", re.MULTILINE)
_NUMBER = re.compile(r"(?:SRG)?0*([0-9]{1,4})", re.IGNORECASE)

_INTRODUCTION = """\
# Diagnostic codes

Every diagnostic of `srgc check` has a code whose meaning never changes. A result without the robot
that a command needs, and problems that `srgc import` finds in a file, have codes too. This page
shows for each code a small file that causes it and the same file repaired; `srgc explain CODE`
prints the same text.
This page is generated from `grammar_lang/diagnostics/catalogue` by `make golden`.

"""
_CHAPTERS = {
    "01": "Files and syntax",
    "02": "Names",
    "03": "Sorts, units and numbers",
    "04": "Grammars",
    "05": "Semantics",
    "06": "Geometry",
    "07": "Tasks",
    "08": "Files of other tools",
}


@dataclass(frozen=True, slots=True)
class Example:
    """Files by name, and what ``srgc check`` prints about one of them.

    ``expected`` is None if no error is expected.  ``place`` holds the offsets of the expected text
    in the page.  ``files`` is empty if a page cannot show them, as for a missing file.  ``command``
    is the command to run instead of a check (such as ``evolve out/a b.srg``); ``expected`` is then
    its whole output.
    """

    files: Files
    checked: str
    expected: str | None
    place: tuple[int, int]
    command: str | None = None

    @property
    def findings(self) -> tuple[tuple[str, str], ...]:
        """The severity and code of each expected diagnostic."""
        return tuple(_SEVERITY.findall(self.expected or ""))


@dataclass(frozen=True, slots=True)
class CodePage:
    """The page of a code; ``why`` is Markdown."""

    code: Code
    title: str
    why: str
    failing: Example
    repaired: Example

    @property
    def severity(self) -> str:
        """``error``, ``warning`` or ``note``, as in the example."""
        return self.failing.findings[0][0]


def _parts(text: str) -> Iterator[re.Match[str] | None]:
    """The fences of a page in order, with None where a heading or ``Repaired:`` comes between."""
    position = 0
    for fence in _FENCE.finditer(text):
        if _BREAK.search(text, position, fence.start()):
            yield None
        yield fence
        position = fence.end()
    yield None


def examples(text: str) -> tuple[Example, ...]:
    """The examples of a Markdown page, in order.

    Blocks ``srg`` (or ``srg NAME``; ``json``, ``text`` or ``xml`` and a name for other files) make
    up a program.  The ``diagnostics`` block that follows says what is printed about it.  If a
    heading, ``Repaired:`` or another program follows instead, the program has no error.  A
    ``console`` block shows the command itself, either about files that no page can show, or another
    command after a program.
    """
    found: list[Example] = []
    files: dict[str, str] = {}

    def close(expected: str | None, place: tuple[int, int]) -> None:
        if files:
            checked = MAIN if MAIN in files else next(iter(files))
            found.append(Example(tuple(files.items()), checked, expected, place))
            files.clear()

    for fence in _parts(text):
        if fence is None:
            close(None, (0, 0))
            continue
        body = fence["body"]
        command = _COMMAND.match(body) if fence["kind"] == "console" else None
        if fence["kind"] == "srg" or (fence["kind"] in {"json", "text", "xml"} and fence["name"]):
            name = fence["name"] or MAIN
            if name in files:
                close(None, (0, 0))
            files[name] = body
        elif fence["kind"] == "diagnostics":
            close(body, fence.span("body"))
        elif command is not None:
            place = (fence.start("body") + command.end(), fence.end("body"))
            output = body[command.end() :]
            if command["other"]:
                found.append(Example(tuple(files.items()), MAIN, output, place, command["other"]))
                files.clear()
                continue
            close(None, (0, 0))
            found.append(Example((), command["file"], output, place))
    return tuple(found)


def read_page(text: str) -> CodePage:
    """Parse the page of a code.

    Raises:
        ValueError: a part is missing or occurs twice.
    """
    heading = _HEADING.match(text)
    why, fails, _ = text.partition("\n\nFails:\n\n")
    shown = examples(text)
    if heading is None or not fails or text.count("\n\nRepaired:\n\n") != 1 or len(shown) != 2:
        raise ValueError("a page has a heading, a why, `Fails:` and `Repaired:`")
    failing, repaired = shown
    if not failing.findings or repaired.findings:
        raise ValueError("the first example fails and says how, the second does not")
    return CodePage(
        Code(heading["code"]), heading["title"], why[heading.end() :], failing, repaired
    )


def has_page(code: Code) -> bool:
    """Whether the catalogue has a page for the code."""
    return (FOLDER / f"{code.value}.md").is_file()


def page_text(code: Code) -> str:
    """The page of a code, as Markdown.

    Raises:
        LookupError: the code has no page.
    """
    if not has_page(code):
        raise LookupError(f"{code.value} has no page")
    return (FOLDER / f"{code.value}.md").read_text(encoding="utf-8")


def title(code: Code) -> str:
    """What the code stands for, in a few words; its own name if it has no page."""
    if not has_page(code):
        return code.name.lower().replace("_", " ")
    return read_page(page_text(code)).title


def find_code(text: str) -> Code | None:
    """The code that a user means by ``SRG0301``, ``srg0301``, ``0301`` or ``301``."""
    match = _NUMBER.fullmatch(text.strip())
    value = "" if match is None else f"SRG{int(match[1]):04}"
    return next((code for code in Code if code.value == value), None)


def nearest_codes(text: str) -> tuple[Code, ...]:
    """The at most three codes nearest to a text that is not a code, the nearest first.

    For a number, codes of the same chapter come first; any other text is compared by spelling.
    """
    match = _NUMBER.fullmatch(text.strip())
    if match is None:
        known = [code.value for code in Code]
        return tuple(map(Code, get_close_matches(text.strip().upper(), known, n=3)))
    number = int(match[1])

    def distance(code: Code) -> tuple[bool, int]:
        own = int(code.value.removeprefix("SRG"))
        return own // 100 != number // 100, abs(own - number)

    return tuple(sorted(Code, key=distance)[:3])


def _anchor(page: CodePage) -> str:
    """The fragment that GitHub and Sphinx make from the heading of a page."""
    heading = f"{page.code.value}: {page.title}".lower()
    return re.sub(r"[^\w\- ]", "", heading).replace(" ", "-")


def catalogue() -> str:
    """All pages as one text with a table of contents, for ``docs/reference/codes.md``."""
    pages = [read_page(page_text(code)) for code in Code if has_page(code)]
    lines: list[str] = []
    chapter = ""
    for page in pages:
        if page.code.value[3:5] != chapter:
            chapter = page.code.value[3:5]
            lines += [
                "",
                f"**{_CHAPTERS[chapter]}**",
                "",
                "| code | severity | meaning |",
                "|---|---|---|",
            ]
        link = f"[{page.code.value}](#{_anchor(page)})"
        lines.append(f"| {link} | {page.severity} | {page.title} |")
    contents = "\n".join(lines[1:])
    texts = (page_text(page.code).rstrip("\n") for page in pages)
    return f"{_INTRODUCTION}{contents}\n\n" + "\n\n".join(f"#{text}" for text in texts) + "\n"
