"""Fixed parameters of kept modules, in the robots of candidates."""

from __future__ import annotations

from fractions import Fraction

import pytest

from compiler.robots.candidate import candidates, robot_in_task
from compiler.robots.normal_form import RobotFamily, family_of
from compiler.robots.robot import RobotModel
from compiler.robots.robot_key import robot_key
from compiler.words.derivation import Derivation
from grammar_lang import ir
from grammar_lang.ir.constants import rational
from tests.oracles.formulas import program
from tests.oracles.small_specs import TURNER

LABELS = {"B": "base", "JO": "joint", "L": "link", "EN": "tool"}
OLD = "B JO L JO L EN"
FIXED = "fixed L1.length = 1.25 m, L2.length = 1.75 m"


def task(fixed: str = FIXED) -> tuple[RobotFamily, ir.Origin]:
    clause = f"from {' eps '.join(OLD.split())} {fixed};"
    found = program(TURNER.replace("reach T;", f"reach T; {clause}"))
    (item,) = found.tasks.values()
    assert item.origin is not None
    return family_of(found, item), item.origin


def derivation(family: RobotFamily, modules: str) -> Derivation:
    return family.replay(tuple(LABELS[name] for name in reversed(modules.split())))


def single_values(model: RobotModel) -> dict[int, Fraction | None]:
    """By the place of its module among all modules, the value of a parameter that has but one."""
    return {
        p.symbol // 2: rational(p.domain.values[0])
        for p in model.parameters
        if isinstance(p.domain, ir.Choices) and len(p.domain.values) == 1
    }


FIRST, SECOND = Fraction(5, 4), Fraction(7, 4)


@pytest.mark.parametrize(
    ("modules", "expected"),
    [
        (OLD, {2: FIRST, 4: SECOND}),
        ("B JO L JO L JO L EN", {2: FIRST, 4: SECOND}),
        ("B JO JO L JO L EN", {3: FIRST, 5: SECOND}),
        # The second joint and link are gone, or the first; what stays comes first in the old word.
        ("B JO L EN", {2: FIRST}),
        ("B JO JO L EN", {3: SECOND}),
        ("B JO EN", {}),
    ],
)
def test_the_parameters_of_kept_modules(modules: str, expected: dict[int, Fraction]) -> None:
    family, origin = task()
    model = robot_in_task(family, origin, derivation(family, modules))
    assert single_values(model) == expected
    free = family.robot(derivation(family, modules))
    assert [(p.symbol, p.name) for p in model.parameters] == [
        (p.symbol, p.name) for p in free.parameters
    ]
    assert robot_in_task(family, None, derivation(family, modules)) == free


def test_only_what_is_fixed() -> None:
    family, origin = task("fixed L2.length = 1.75 m")
    model = robot_in_task(family, origin, derivation(family, OLD))
    assert single_values(model) == {4: SECOND}
    family, origin = task("")
    assert single_values(robot_in_task(family, origin, derivation(family, OLD))) == {}


def test_robots_are_equal_only_with_equal_values() -> None:
    family, origin = task()

    def key(modules: str, fixed: ir.Origin | None = origin) -> str:
        return robot_key(robot_in_task(family, fixed, derivation(family, modules)))

    # A joint behind the tool moves nothing, with or without `fixed`.
    assert key("B JO L JO L EN JO") == key(OLD)
    assert key("B JO L JO L EN JO", None) == key(OLD, None) != key(OLD)
    other, swapped = task("fixed L1.length = 1.75 m, L2.length = 1.25 m")
    assert robot_key(robot_in_task(other, swapped, derivation(other, OLD))) != key(OLD)


def test_candidates_have_these_robots_in_this_order() -> None:
    family, origin = task()
    found = list(candidates(family, 6, origin))
    assert [c.number for c in found] == list(range(len(found)))
    assert " ".join(found[0].derivation.word[::2]) == OLD
    assert all(c.model == robot_in_task(family, origin, c.derivation) for c in found)
    plain = list(candidates(family, 6, None))
    assert {c.derivation for c in plain} == {c.derivation for c in found}
    lengths = [len(c.derivation.word) for c in plain]
    assert lengths == sorted(lengths) != [len(c.derivation.word) for c in found]
