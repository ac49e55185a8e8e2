"""The language reference: its examples run, its rules are the grammar's, its tables the code's.

With UPDATE_GOLDEN in the environment, what `srgc check` says now is written into the page; the test
fails once then, so that nobody does so without looking at the difference.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from fractions import Fraction
from functools import cache
from itertools import pairwise
from pathlib import Path

import pytest
from lark import Lark, Token, Tree

import srgc.cli
from compiler.words.finite_automaton import STATE_LIMIT
from grammar_lang.diagnostics.code_pages import page_text, read_page
from grammar_lang.diagnostics.diagnostic import Code, Sink
from grammar_lang.diagnostics.render import to_text
from grammar_lang.elaboration import emissions, typecheck
from grammar_lang.elaboration.sorts import PLAUSIBLE
from grammar_lang.elaboration.tasks import MOST_STEPS
from grammar_lang.files.file_tree import IMAGE_LIMIT, LIMIT
from grammar_lang.formatting.formatter import canonical
from grammar_lang.ir import expressions
from grammar_lang.parsing import lalr, parse, tree_builder
from grammar_lang.parsing.tables import RESERVED
from grammar_lang.units import MAX_EXPONENT, UNIT_NAMES, unit
from solvers.conclusion import DEFAULT_MODULES
from srgc.session import check_file
from tests.oracles.pages import Block, blocks, files, prose

ROOT = Path(__file__).parents[1]
FILE = ROOT / "docs" / "reference" / "language.md"
PAGE = FILE.read_text(encoding="utf-8")
LARK = (ROOT / "grammar_lang" / "parsing" / "srg.lark").read_text(encoding="utf-8")
BLOCKS = blocks(PAGE)
PROGRAMS = [block for block in BLOCKS if block.kind == "srg"]
SPEC = "spec.srg"
UNSEEN = {
    "module_item", "grammar_item", "statement", "workspace_item", "task_item", "mission_item",
    "item",
}  # fmt: skip
"""Rules that only choose."""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A working directory with the files of the page."""
    for name, body in files(PAGE).items():
        file = tmp_path / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(body, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def at_line(block: object) -> str | None:
    return f"line {block.line}" if isinstance(block, Block) else None


# --- examples ------------------------------------------------------------------------------------


@pytest.mark.parametrize("program", PROGRAMS, ids=at_line)
def test_of_examples_is_said_what_is_shown(program: Block, folder: Path) -> None:
    after = BLOCKS[BLOCKS.index(program) + 1]
    name = program.name or SPEC
    (folder / name).write_text(program.body, encoding="utf-8")
    checked = check_file(Path(name))
    expected = after.body if after.kind == "diagnostics" else ""
    said = to_text(checked.diagnostics, checked.sources)
    if said and expected and said != expected and "UPDATE_GOLDEN" in os.environ:
        text = FILE.read_text(encoding="utf-8")
        FILE.write_text(text.replace(expected, said, 1), encoding="utf-8")
        pytest.fail("docs/reference/language.md is rewritten: read the difference, then run again")
    assert said == expected


@pytest.mark.parametrize("program", PROGRAMS, ids=at_line)
def test_examples_are_in_canonical_form(program: Block) -> None:
    assert canonical(program.body, Sink()) == program.body


def test_diagnostics_follow_an_example() -> None:
    for before, block in pairwise(BLOCKS):
        assert block.kind != "diagnostics" or before.kind == "srg", block.line


def test_the_first_example_has_ten_lines() -> None:
    assert len([line for line in PROGRAMS[0].body.split("\n") if line]) == 10


@pytest.mark.slow
def test_the_first_example_has_the_robot_that_is_named(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert srgc.cli.run(["synth", "fetch.srg", "-o", str(folder / "out")]) == 0
    robot = "Base Elbow Tube Hand"
    assert f"finds the robot `{robot}`" in PAGE
    assert f"robot:   {robot}\n" in capsys.readouterr().out
    assert srgc.cli.run(["verify", str(folder / "out")]) == 0


# --- rules ---------------------------------------------------------------------------------------


def rules(text: str) -> Iterator[tuple[str, str]]:
    """The rules of a grammar, without what only builds trees: name, and what it stands for."""
    text = re.sub(r"^//.*$", "", text, flags=re.MULTILINE)
    text = re.sub(r"^%ignore (\w+)$", r"%\1: ignored", text, flags=re.MULTILINE)
    for part in re.split(r"^(?=[!?%]?\w+(?:\.\d+)?:)", text, flags=re.MULTILINE):
        name, colon, body = part.partition(":")
        if colon:
            unnamed = re.sub(r" -> [a-z_]+(?=\s)", "", f"{body} ")
            yield name.lstrip("!?").partition(".")[0], " ".join(unnamed.split())


RULES = dict(rules(LARK))
*BESIDE, AT_THE_END = [block for block in BLOCKS if block.kind == "ebnf"]


def test_the_rules_are_read() -> None:
    """So that the tests below say something."""
    made = {str(rule.origin.name) for rule in language().rules} - {"file"}
    assert {name for name in RULES if name[0].islower()} == {n for n in made if n[0] != "_"}
    assert {name for name in RULES if name.isupper() and name[0] != "%"} == {
        name for name in (t.name for t in language().terminals) if f"\n{name}" in LARK
    }
    assert RULES["production"] == 'label ":" NAME "->" right ";"'
    assert RULES["mark"] == '"*" | "+" | "?"'
    assert RULES["factor"] == 'power | "-" factor'


def test_the_grammar_at_the_end_is_the_grammar() -> None:
    assert list(rules(AT_THE_END.body)) == list(RULES.items())


@pytest.mark.parametrize("block", BESIDE, ids=at_line)
def test_rules_beside_their_meaning_are_those_of_the_grammar(block: Block) -> None:
    found = list(rules(block.body))
    assert found
    for name, body in found:
        assert body == RULES[name], name


def test_every_rule_stands_once_beside_its_meaning() -> None:
    found = [name for block in BESIDE for name, _ in rules(block.body)]
    assert sorted(found) == sorted(name for name in RULES if not name.startswith("%"))


@cache
def language(*, keep_all_tokens: bool = False) -> Lark:
    return Lark(
        f"{LARK}\nfile: item*\n", start="file", parser="lalr", keep_all_tokens=keep_all_tokens
    )


def tokens(tree: Tree[Token]) -> Iterator[str]:
    return (str(t.type) for t in tree.scan_values(lambda value: isinstance(value, Token)))


def test_examples_have_every_construct_and_every_word() -> None:
    """The correct ones among them."""
    rules_used: set[str] = set()
    words_used: set[str] = set()
    whole = language(keep_all_tokens=True)
    for program, after in pairwise(BLOCKS):
        if program.kind == "srg" and ": error[" not in (after.kind == "diagnostics") * after.body:
            for tree in language().parse(program.body).iter_subtrees():
                rules_used.add(str(tree.data))
            words_used |= set(tokens(whole.parse(program.body)))
    assert set(tree_builder.BUILDERS) - UNSEEN <= rules_used
    assert {t.name for t in language().terminals} - {"COMMENT", "BLANK"} <= words_used


# --- tables --------------------------------------------------------------------------------------


def section(title: str) -> str:
    """From a heading to the next one."""
    _, found, after = PAGE.partition(f"# {title}\n")
    assert found, title
    return re.split(r"^#+ ", after, maxsplit=1, flags=re.MULTILINE)[0]


def sentences(title: str) -> str:
    """A section with its lines joined."""
    return " ".join(section(title).split())


def rows(title: str, number: int = 0) -> list[list[str]]:
    """The cells of a table of a section, without its head."""
    tables = re.findall(r"(?:^\|.*\n)+", section(title), re.MULTILINE)
    lines = tables[number].splitlines()[2:]
    return [[cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]] for line in lines]


def test_reserved_words() -> None:
    [listed] = [block for block in BLOCKS if block.kind == "text" and block.body[:3] == "and"]
    assert tuple(listed.body.split()) == RESERVED
    assert "Eleven words are reserved" in sentences("Names and keywords")
    assert len(RESERVED) == 11


def test_units() -> None:
    listed = {row[0].strip("`"): row[2] for row in rows("Units")}
    assert sorted(listed) == sorted(UNIT_NAMES)
    for name, value in listed.items():
        found = unit(name)
        assert found is not None
        if name == "deg":
            assert (value, found.factor, found.pi_power) == ("π/180", Fraction(1, 180), 1)
            continue
        number, _, base = value.partition(" ")
        assert found.factor == Fraction(number), name
        assert set(re.findall("[A-Za-z]+", base)) <= {"m", "kg", "s", "A"}
        stands_for = unit(base)
        assert stands_for is not None
        assert (stands_for.dimension, stands_for.factor) == (found.dimension, 1), name
    assert f"up to {MAX_EXPONENT} in size" in sentences("Units")


def test_plausible_values() -> None:
    expected = [
        [due.name, f"{due.least:g} {due.units[0]}", f"{due.most:g} {due.units[0]}"]
        for due in PLAUSIBLE.values()
    ]
    assert rows("Plausible values") == expected


def test_functions() -> None:
    named = {name for row in rows("Functions") for name in re.findall(r"`(\w+)\(", row[0])}
    assert {*named, *re.findall(r"`(\w+)\(", " ".join(rows("Functions")[3]))} == {
        *typecheck.FUNCTIONS,
        "rate",
    }


def test_emissions() -> None:
    found: dict[str, list[str]] = {}
    for kind, argument, text, _ in rows("Bodies and effectors"):
        if kind:
            arguments = found.setdefault(kind.strip("`"), [])
        arguments.append(argument.strip("`"))
        optional = (list(found)[-1], arguments[-1]) in emissions._OPTIONAL
        assert text.startswith("optional") == optional, argument
    assert {kind: tuple(names) for kind, names in found.items()} == emissions._ARGUMENTS


def test_limits() -> None:
    said = [row[1] for row in rows("Limits")]
    numbers = [LIMIT >> 20, IMAGE_LIMIT >> 20, lalr.MAX_DEPTH, expressions.MAX_NODES, STATE_LIMIT]
    numbers += [MOST_STEPS, parse.MAX_ERRORS]
    assert [int(re.sub(r",|\D.*", "", text.replace(",", ""))) for text in said] == numbers
    assert f"{expressions.MAX_DEPTH} deep" in said[3]
    assert f"at most {tree_builder.MAX_LITERAL} characters" in sentences("Numbers")
    assert f"at most {typecheck.MAX_POWER} in size" in sentences("Operators")
    assert f"ends at {DEFAULT_MODULES}" in section("Tasks")


def test_every_clause_of_a_task_is_in_the_table() -> None:
    named = " ".join(row[0] for row in rows("Tasks"))
    for alternative in re.findall(r"\w+", RULES["task_item"]):
        for keyword in re.findall(r'(?:^|\| )"(\w+)"', RULES[alternative]):
            assert re.search(f"`{keyword}[ ;]", named), alternative


def test_severities_are_those_of_the_catalogue() -> None:
    for line in re.findall(r"^\| \[SRG.*$", PAGE, re.MULTILINE):
        _, codes, severity, *_ = line.split("|")
        for code in re.findall(r"SRG\d{4}", codes):
            assert read_page(page_text(Code(code))).severity in severity, code


def test_codes_lead_to_their_pages() -> None:
    """`[SRG0301]` is a link wherever it stands."""
    used = set(re.findall(r"\[(SRG\d{4})\](?!:)", prose(PAGE)))
    defined = dict(re.findall(r"^\[(SRG\d{4})\]: codes\.md#(\S+)$", PAGE, re.MULTILINE))
    assert used == set(defined)
    for code, anchor in defined.items():
        assert anchor.startswith(f"{code.lower()}-")


# --- not supported -------------------------------------------------------------------------------

MAPS = """\
include "robots.srg";
workspace Bench {{
  plane xy;
  bounds box [-2, 4] x [-2, 4] m;
  region Home box [0.8, 1.2] x [-0.2, 0.2] m;
  target Shelf box [-0.2, 0.2] x [0.8, 1.2] m;
  obstacles from "posts.geojson";
}}
{task}
"""
TASK = """\
task T {{
  robot Arm;
  workspace Bench;
  start in Home;
  reach Shelf;
  effort <= 10 N*m;
  horizon 20 steps of 0.1 s;
  {clause}
}}
"""
JOINED = 'include "robots.srg";\ninclude "bench.srg";\n{task}'


def test_a_map_is_avoided_by_its_name(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = MAPS.format(task=TASK.format(clause="avoid posts with effector;"))
    (folder / SPEC).write_text(text, encoding="utf-8")
    assert srgc.cli.run(["plan", SPEC]) == 0
    assert "posts" not in capsys.readouterr().out
