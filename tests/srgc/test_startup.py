"""What is loaded when nothing is to be done: structure, not time."""

from __future__ import annotations

import sys
import tomllib
from importlib.metadata import version

import pytest

from srgc.version import VERSION
from tests.conftest import ROOT
from tests.oracles.loaded_modules import loaded_after

OURS = {
    "srgc", "srgc.cli", "srgc.cli.command_table", "srgc.faults", "srgc.cli.fault_report",
    "srgc.interruption", "srgc.terminal", "srgc.version",
}  # fmt: skip


@pytest.fixture(scope="module")
def bare():
    """What Python and click load by themselves."""
    return loaded_after("import click, click.shell_completion, gettext, locale, difflib")


def loaded(arguments, bare, **environment):
    program = (
        f"import os; os.environ |= {environment!r}\nfrom srgc.cli import run\nrun({arguments!r})"
    )
    return loaded_after(program) - bare


def not_of_the_library(names):
    """Those that are no module of Python's own."""
    return {n for n in names if n.partition(".")[0].lstrip("_") not in sys.stdlib_module_names} - {
        n for n in names if n.partition(".")[0] in sys.stdlib_module_names
    }


@pytest.mark.parametrize("arguments", [["--version"], ["--help"], [], ["chekc"]], ids=str)
def test_nothing_but_click_and_the_table(bare, arguments):
    found = not_of_the_library(loaded(arguments, bare))
    assert {name for name in found if not name.startswith(("org", "click."))} <= OURS
    # importlib.metadata takes as long as click.
    assert "importlib.metadata" not in loaded(arguments, bare)


@pytest.mark.parametrize(
    "name", ["check", "synth", "verify", "words", "landscape", "export", "compare"]
)
def test_the_help_of_a_command_loads_its_options_alone(bare, name):
    found = loaded([name, "--help"], bare)
    heavy = {n.partition(".")[0] for n in found} & {
        "grammar_lang", "compiler", "solvers", "numpy", "rich", "z3",
    }  # fmt: skip
    assert not heavy
    assert "srgc.session" not in found


@pytest.mark.parametrize(
    "words", ["srgc ", "srgc syn", "srgc synth --", "srgc verify ou", "srgc synth specs/pl"]
)
def test_completion_loads_no_compiler(bare, words):
    found = loaded(
        [], bare, _SRGC_COMPLETE="bash_complete", COMP_WORDS=words,
        COMP_CWORD=str(len(words.split(" ")) - 1),
    )  # fmt: skip
    assert "click.shell_completion" in bare
    assert not {n.partition(".")[0] for n in found} & {"grammar_lang", "compiler", "solvers"}


def test_the_entry_point_imports_nothing():
    """Until main has seen to it an interrupt is a traceback: so main is there at once."""
    before = loaded_after("import sys")
    after = loaded_after("import srgc.cli")
    assert after - before == {"srgc", "srgc.cli"}


def test_one_version():
    declared = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert version("srgc") == VERSION
    assert declared.get("version", VERSION) == VERSION
