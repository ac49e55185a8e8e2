"""Clauses that `check` reads and `synth` and `plan` refuse: exit 5, the clause marked."""

from __future__ import annotations

import pytest

import srgc as api
from srgc.session import SpecErrors
from tests.oracles.small_specs import SLIDER

FORMULA = "satisfy eventually T;"
WITH_FORMULA = SLIDER.replace("reach T;", f"reach T; {FORMULA}")


@pytest.mark.parametrize("command", ["synth", "plan"])
def test_refused(srgc, spec, command):
    assert FORMULA in WITH_FORMULA
    path = spec(WITH_FORMULA)
    assert srgc("check", path).status == 0
    ran = srgc(command, path)
    assert (ran.status, ran.out) == (5, "")
    line = next(n for n, text in enumerate(WITH_FORMULA.splitlines(), 1) if FORMULA in text)
    column = WITH_FORMULA.splitlines()[line - 1].index(FORMULA) + 1
    assert f":{line}:{column}: error[SRG0190]: `satisfy` cannot be compiled" in ran.err
    assert not (path.parent / "out").exists()


def test_other_tasks_and_commands_are_not_affected(srgc, spec):
    second = SLIDER[SLIDER.index("task Slide") :].replace("Slide {", "Plain {")
    path = spec(WITH_FORMULA + second)
    assert srgc("plan", path, "--task", "Plain").status == 0
    assert srgc("plan", path, "--task", "Slide").status == 5
    assert srgc("words", path, "--limit", "1").status == 0
    assert srgc("graph", path, "--of", "workspace").status == 0


def test_the_python_interface(spec):
    program = api.load(spec(WITH_FORMULA))
    with pytest.raises(SpecErrors) as raised:
        api.synthesise(program)
    [error] = raised.value.checked.diagnostics
    assert error.code.value == "SRG0190"


def test_a_task_without_reach(srgc, spec):
    path = spec(SLIDER.replace("reach T;", FORMULA))
    assert srgc("check", path).status == 0
    assert srgc("synth", path).status == 5


def test_a_contradictory_formula_is_an_error_of_check(srgc, spec):
    ran = srgc("check", spec(SLIDER.replace("reach T;", "reach T; satisfy last[0] not T;")))
    assert ran.status == 1
    assert "error[SRG0704]: task `Slide` contradicts itself" in ran.out
