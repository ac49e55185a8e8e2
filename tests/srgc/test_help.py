"""The help teaches: its examples run, its statuses are the contract's, its pages are there."""

from __future__ import annotations

import re
import shlex
import shutil

import click
import pytest

from srgc.cli import run
from srgc.cli.arguments import DocumentedCommand
from srgc.cli.command_table import GROUPS, TABLE, all_commands, command_named
from tests.conftest import ROOT
from tests.oracles.some_cases import some

COMMANDS = [*TABLE]
CONTRACT = {
    "check": {0, 1}, "fmt": {0, 1}, "words": {0, 4}, "accepts": {0, 1}, "graph": {0},
    "plan": {0, 3, 4}, "synth": {0, 3, 4}, "verify": {0, 1, 4, 6},
}  # fmt: skip
"""The statuses of the commands themselves, beside those that all have."""
MADE = {
    "srgc synth specs/planar_arm.srg -o out/demo",
    "srgc synth specs/planar_arm.srg -o out/demo --quiet",
}
"""Examples that were run for other tests, with their result in out/demo."""
SERVES = {
    "srgc lsp", "srgc lsp --stdio", "srgc view out/demo",
    "srgc view out/demo --port 8090 --no-browser --no-tube",
}  # fmt: skip


def help_of(name, width=80):
    command = command_named(name)
    context = click.Context(
        command, info_name=f"srgc {name}", terminal_width=width - 2,
        help_option_names=["-h", "--help"],
    )  # fmt: skip
    return command.get_help(context)


def section(text, title):
    """The lines of a section, without their indentation."""
    lines = text.partition(f"\n{title}:\n")[2].splitlines()
    end = next((i for i, line in enumerate(lines) if not line.startswith("  ")), len(lines))
    return [line.strip() for line in lines[:end]]


@pytest.fixture(scope="module")
def checkout(made, tmp_path_factory):
    """A copy of what examples need: the specs, a result, and one without a design."""
    place = tmp_path_factory.mktemp("checkout")
    shutil.copytree(ROOT / "specs", place / "specs")
    shutil.copytree(made("planar_arm") / "out", place / "out" / "demo")
    shutil.copytree(made("beyond_reach") / "out", place / "out" / "impossible")
    return place


LONG = ("landscape", "replay")
"""Commands whose examples take seconds."""


@pytest.mark.parametrize(
    "name", some([*(name for name in COMMANDS if name not in LONG), *LONG], -len(LONG))
)
def test_every_example_runs(name, checkout, monkeypatch, capsys):
    monkeypatch.chdir(checkout)
    examples = section(help_of(name), "Examples")
    assert examples
    for example in examples:
        program, *arguments = shlex.split(example)
        assert program == "srgc", example
        if example not in MADE | SERVES:
            assert run(arguments) == 0, (example, capsys.readouterr().err)
    assert any(f"srgc {name}" in example for example in examples)


def test_the_options_of_every_example_are_there():
    for name in COMMANDS:
        for example in section(help_of(name), "Examples"):
            _, *arguments = shlex.split(example)
            command = command_named(arguments[0])
            command.make_parser(click.Context(command)).parse_args(arguments[1:])


@pytest.mark.parametrize("name", COMMANDS)
def test_every_page_of_help(name):
    text = help_of(name)
    assert text.startswith(f"Usage: srgc {name} ")
    described = text.partition("\n\n")[2].partition("\nOptions:")[0]
    assert len(described.split()) >= 12
    # Nothing is cut and nothing is too wide, but an example, which has to be copied whole.
    examples = section(text, "Examples")
    wide = [line for line in text.splitlines() if len(line) > 80 and line.strip() not in examples]
    assert not wide
    statuses = section(text, "Exit status")
    said = {int(line.split()[0]) for line in statuses if re.match(r"\d", line)}
    assert said >= {0, 2, 70, 130, 141}
    if name in CONTRACT:
        assert said - {2, 5, 70, 130, 141} == CONTRACT[name]
    pages = re.findall(r"docs/\S+?\.md", text)
    assert pages
    assert [page for page in pages if not (ROOT / page).is_file()] == []


def test_help_as_a_command(capsys):
    """As git and cargo have it."""
    for arguments, same in ((["help"], ["--help"]), (["help", "synth"], ["synth", "--help"])):
        assert run(arguments) == run(same) == 0
        one, other = capsys.readouterr().out.split("Usage: ")[1:]
        assert one == other
    assert run(["help", "synthh"]) == 2
    assert "Did you mean 'synth'?" in capsys.readouterr().err


def test_the_overview(capsys):
    assert run(["--help"]) == 0
    text = capsys.readouterr().out
    assert run(["-h"]) == 0
    assert capsys.readouterr().out == text
    for group, names in GROUPS.items():
        lines = section(text, group)
        assert [line.split()[0] for line in lines] == [*names]
        # Aligned, one line each.
        starts = {re.match(r"\S+ +", line).end() for line in lines}
        assert starts == {max(map(len, TABLE)) + 2}
    assert all(len(line) <= 80 for line in text.splitlines())
    # Without arguments it is shown as well, as a mistake.
    assert run([]) == 2
    out, err = capsys.readouterr()
    assert (out, err.strip()) == ("", text.strip())


def test_the_table_for_a_reference():
    found = all_commands()
    assert {group: [*names] for group, names in found.items()} == {
        group: [*names] for group, names in GROUPS.items()
    }
    for commands in found.values():
        for name, command in commands.items():
            assert command.name == name
            assert isinstance(command, DocumentedCommand)


@pytest.mark.parametrize(
    ("arguments", "meant"),
    [
        (["chekc"], "check"),
        (["verfy", "out"], "verify"),
        (["synth", "--tsk", "x", "a.srg"], "--task"),
        (["words", "a.srg", "--max-lenght", "3"], "--max-length"),
        (["graph", "a.srg", "--of", "dff"], "dfa"),
    ],
    ids=lambda value: value if isinstance(value, str) else " ".join(value),
)
def test_what_was_meant(arguments, meant, capsys):
    assert run(arguments) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert meant in err.splitlines()[-1]
    assert err.startswith("Usage: srgc ")


def test_nothing_near_is_no_suggestion(capsys):
    assert run(["qqqqqq"]) == 2
    assert "mean" not in capsys.readouterr().err


@pytest.mark.parametrize(
    "name", ["synth", "verify", "landscape", "why", "plan", "words", "compare", "report"]
)
def test_quiet_is_where_progress_is(name):
    assert "-q, --quiet" in help_of(name)
