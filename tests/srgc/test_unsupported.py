"""Clauses that `check` reads and `synth` and `plan` refuse: exit 5, the clause marked."""

from __future__ import annotations

import pytest

import srgc as api
from srgc.session import SpecErrors
from tests.oracles.small_specs import SLIDER

pytestmark = pytest.mark.usefixtures("without_pictures")


CLAUSE = "avoid self with body;"
WITH_CLAUSE = SLIDER.replace("reach T;", f"reach T; {CLAUSE}")


@pytest.mark.parametrize("command", ["synth", "plan"])
def test_refused(srgc, spec, command):
    assert CLAUSE in WITH_CLAUSE
    path = spec(WITH_CLAUSE)
    assert srgc("check", path).status == 0
    ran = srgc(command, path)
    assert (ran.status, ran.out) == (5, "")
    line = next(n for n, text in enumerate(WITH_CLAUSE.splitlines(), 1) if CLAUSE in text)
    column = WITH_CLAUSE.splitlines()[line - 1].index(CLAUSE) + 1
    assert f":{line}:{column}: error[SRG0190]: `avoid self` cannot be compiled" in ran.err
    assert not (path.parent / "out").exists()


def test_other_tasks_and_commands_are_not_affected(srgc, spec):
    second = SLIDER[SLIDER.index("task Slide") :].replace("Slide {", "Plain {")
    path = spec(WITH_CLAUSE + second)
    assert srgc("plan", path, "--task", "Plain").status == 0
    assert srgc("plan", path, "--task", "Slide").status == 5
    assert srgc("words", path, "--limit", "1").status == 0
    assert srgc("graph", path, "--of", "workspace").status == 0


def test_the_python_interface(spec):
    program = api.load(spec(WITH_CLAUSE))
    with pytest.raises(SpecErrors) as raised:
        api.synthesize(program)
    [error] = raised.value.checked.diagnostics
    assert error.code.value == "SRG0190"


def test_a_contradictory_formula_is_an_error_of_check(srgc, spec):
    ran = srgc("check", spec(SLIDER.replace("reach T;", "reach T; satisfy last[0] not T;")))
    assert ran.status == 1
    assert "error[SRG0704]: task `Slide` contradicts itself" in ran.out
