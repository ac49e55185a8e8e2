"""Row 4.13: one moving link does not do, "obviously": it depends on what it turns about."""

from __future__ import annotations

from math import hypot

import numpy as np

from compiler.words.language import language
from grammar_lang import ir
from tests.oracles.arms import ArmBuilder, planar_arm
from tests.oracles.grammars import ARM_ACCEPT, ARM_MODULES, ARM_TERMINALS, arm
from tests.oracles.questions import SAT, UNSAT, decide

CENTRE, RADIUS = 5.5, 4.88
"""Two links of 2.75 m fixed to the base, and one of 4.88 m that turns: all in [0.5, 5] m."""


def test_about_the_base_start_and_target_are_at_other_distances() -> None:
    farthest_start, nearest_target = hypot(1.2, 1.4), hypot(3.5, 3.8)
    assert farthest_start < 1.85 < 5.16 < nearest_target
    assert decide(planar_arm(1)) == UNSAT


def test_about_a_centre_that_is_shifted_one_sweep_does_the_task() -> None:
    heights = np.linspace(1.38, 4.47, 10_001)
    x = CENTRE - np.sqrt(RADIUS**2 - heights**2)
    assert 0.8 < x[0] < 1.2
    assert 1.0 < heights[0] < 1.4
    assert 3.5 < x[-1] < 4.2
    assert 3.8 < heights[-1] < 4.5
    assert np.all((x > 0) & (x < 5))
    # All of the obstacle is nearer to the centre than the arc.
    corners = [hypot(CENTRE - a, b) for a in (1.7, 3.0) for b in (2.0, 3.0)]
    assert max(corners) < RADIUS - 0.03
    robot = ArmBuilder().link("2.75").link("2.75").revolute().link("4.88").effector()
    assert decide(robot) == SAT


def test_the_second_half_of_the_condition_is_what_rules_it_out() -> None:
    shifted = ["B", "eps", "L", "eps", "L", "eps", "JO", "eps", "L", "eps", "EN"]
    about_the_base = ["B", "eps", "JO", "eps", "L", "eps", "EN"]
    for accept, expected in ((ARM_ACCEPT, [False, True]), (ir.Contains(("EN",)), [True, True])):
        lang = language(arm(accept), ARM_TERMINALS, ARM_MODULES)
        assert [lang.accepts(tuple(word)) for word in (shifted, about_the_base)] == expected
