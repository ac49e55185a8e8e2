"""The command of a report that searches again has the options of the search."""

from __future__ import annotations

import shlex

import pytest

from srgc.cli.synth import synth
from srgc.report.proof import search_options

OPTIONS = {
    "none": ([], {}),
    "a seed": (["--seed", "3"], {"seed": 3}),
    "budgets": (["--paths", "8", "--evaluations", "20"], {"paths": 8, "evaluations": 20}),
    "all": (["--all", "--cells", "12"], {"all_designs": True, "least_cells": 12}),
    "methods": (["--solver", "ecos", "--search", "nelder-mead"],
                {"solver": "ecos", "search": "nelder-mead"}),
}  # fmt: skip


@pytest.mark.parametrize("name", OPTIONS)
def test_the_command_line_has_the_same_meaning(name: str) -> None:
    """Read by the command itself, it gives what the options that were used give."""
    given, stated = OPTIONS[name]
    again = shlex.split(search_options({"seed": 0} | stated))
    read = [synth.make_context("synth", ["x.srg", *each]).params for each in (given, again)]
    assert read[0] == read[1]
