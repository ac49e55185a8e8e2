"""Motions that go on for ever, of a mass on a rail, whose rounds are known exactly."""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from functools import lru_cache

import pytest

from solvers.verifier.proofs.checked_condition import CheckedCondition
from solvers.verifier.proofs.control_law import ControlLaw
from solvers.verifier.proofs.loop_set import Loop
from solvers.verifier.proofs.trajectory_proof import Motion, Scene, prove_motion
from solvers.verifier.proofs.tube_checks import Status
from tests.oracles.some_cases import some
from tests.solvers.test_disturbed_proof import FAMILY, SLIDE, scene

F = Fraction
Row = tuple[Fraction, Fraction]
STEP, MASS, BOUND = F(1, 10), F(3, 2), 9
GAIN: Row = (F(2), F(3))
"""N/m and N*s/m."""
PUSH = F(3, 2)
"""N: forwards for five steps, backwards for ten, forwards for five, and the mass is back."""
ROUND = (PUSH,) * 5 + (-PUSH,) * 10 + (PUSH,) * 5
HOME: Row = (F(0), F(0))


@lru_cache
def rail(clauses: str, steps: int = 20, disturbances: str = "") -> Scene:
    text = FAMILY.replace("CLAUSES", f"{clauses} repeat;").replace("STEPS", str(steps))
    text = text.replace("REGION", "box [0.213, 3] x [-1, 1]").replace("DISTURBANCES", disturbances)
    text = text.replace("Begin box [-3, 3] x [-3, 3]", "Begin box [-0.11, 0.107] x [-1, 1]")
    return scene(SLIDE, text)


def moved(state: Row, u: Fraction, gain: Row = GAIN, about: Row | None = None) -> Row:
    """One step of m q'' = u - K (x - x*), the force being held: exact."""
    at = state if about is None else about
    force = u - sum((k * (x - y) for k, x, y in zip(gain, state, at, strict=True)), F(0))
    q, v = state
    a = force / MASS
    return q + STEP * v + STEP**2 / 2 * a, v + STEP * a


@dataclass(frozen=True)
class Rounds:
    """Inputs and the motion they make from a start; ``first`` is the first sample of the loop."""

    inputs: tuple[Fraction, ...] = ROUND
    first: int = 0
    start: Row = HOME

    @property
    def states(self) -> list[Row]:
        found = [self.start]
        for u in self.inputs:
            found.append(moved(found[-1], u))
        return found

    def motion(self, size: Row, centre: Row | None = None) -> Motion:
        """The motion with the set of all states within ``size`` of its own."""
        states = self.states
        law = ControlLaw(tuple(states[:-1]), ((GAIN,),) * len(self.inputs))
        middle = states[self.first] if centre is None else centre
        loop = Loop(self.first, middle, ((size[0], F(0)), (F(0), size[1])))
        inputs = tuple((u,) for u in self.inputs)
        return Motion((), self.start, inputs, 0, (), law, loop)

    def reach(self, size: Row) -> Fraction:
        """How far the motions from the set get after a round, in its size: at most 1 in it."""
        states, images = self.states, list[Row]()
        for unit in ((F(1), F(0)), (F(0), F(1))):
            off = unit
            for _ in self.inputs[self.first :]:
                off = moved(off, F(0), GAIN, HOME)
            images.append(off)
        drift = [a - b for a, b in zip(states[-1], states[self.first], strict=True)]
        return max(
            (abs(drift[i]) + sum(abs(images[j][i]) * size[j] for j in range(2))) / size[i]
            for i in range(2)
        )


def judged(where: Scene, rounds: Rounds, motion: Motion) -> dict[str, CheckedCondition]:
    places = [where.abstraction.containing((q, F(0)))[0] for q, _ in rounds.states]
    path = (tuple(where.abstraction.cells[place].name for place in places),)
    return {each.name: each for each in prove_motion(where, replace(motion, path=path))}


def holds(conditions: dict[str, CheckedCondition]) -> bool:
    return all(each.status is Status.HOLDS for each in conditions.values())


AGAIN = "satisfy always (eventually End and eventually Begin);"
SIZE: Row = (F(1, 100), F(1, 50))
FORMULAS = (
    (AGAIN, True),
    ("satisfy eventually always End;", False),
    ("satisfy always eventually[0 s, 2 s] Begin;", True),
    ("satisfy always eventually[0 s, 1 s] Begin;", False),
    ("satisfy always (Begin implies eventually[100 s, 102 s] End);", True),
    ("satisfy always not Post;", True),
    ("satisfy Begin until Post;", False),
    ("reach End;", True),
)


@pytest.mark.parametrize(("clauses", "true"), FORMULAS)
def test_formulas_are_about_all_rounds(clauses: str, true: bool) -> None:
    """The mass is at home every two seconds, and within 0.25 m and 0.5 m of it in between."""
    where, rounds = rail(clauses), Rounds()
    found = judged(where, rounds, rounds.motion(SIZE))
    assert holds(found) is true
    if not true:
        (wrong,) = [each for each in found.values() if each.status is not Status.HOLDS]
        assert wrong.status is Status.FAILS
        assert wrong.clause == 0


def test_the_conditions_name_the_loop() -> None:
    rounds = Rounds()
    found = judged(rail(AGAIN), rounds, rounds.motion(SIZE))
    # The prefix is the start alone, in the middle of the set.
    assert found["entry into the loop"].margin == pytest.approx(1, abs=1e-9)
    back = 1 - float(rounds.reach(SIZE))
    assert found["return of the loop"].margin == pytest.approx(back, abs=1e-6)
    # Inputs are bounded for all of the set, the plan has more margin.
    most = float(PUSH + GAIN[0] * SIZE[0] + GAIN[1] * SIZE[1])
    assert found["planned effort (N)"].margin == pytest.approx(BOUND - float(PUSH))
    assert found["effort (N)"].margin == pytest.approx(BOUND - most)


def test_a_prefix_leads_into_the_loop() -> None:
    """It brings the mass from a rest elsewhere to a rest at home."""
    there = Rounds((PUSH, *([F(0)] * 3), -PUSH, *ROUND), 5, (F(-1, 25), F(0)))
    assert there.states[5] == HOME
    where = rail(AGAIN, steps=25)
    assert holds(judged(where, there, there.motion(SIZE)))
    # What begins one step too early does not come back.
    early = replace(there, first=4)
    found = judged(where, early, early.motion(SIZE, centre=early.states[4]))
    assert found["return of the loop"].status is Status.UNDECIDED
    # A set that the prefix does not end in.
    beside = there.motion(SIZE, centre=(2 * SIZE[0], F(0)))
    found = judged(where, there, beside)
    assert found["entry into the loop"].status is Status.UNDECIDED


@pytest.mark.parametrize("beyond", some([F(1, 10**6), F(-1, 10), F(-1, 10**6), F(1, 10)], 2))
def test_a_round_that_leaves_its_set_by_a_millionth_is_not_believed(beyond: Fraction) -> None:
    """The reference drifts in each round; in a set that is wide enough it may."""
    drifting = Rounds((*ROUND[:-1], ROUND[-1] + F(1, 100)))
    for number, axis in enumerate(((F(1), F(2)), (F(1), F(1)))):
        # The size at which the motions get just so far beyond the set.
        one = drifting.reach(axis)
        still = Rounds().reach(axis)
        factor = _scale(drifting, axis, 1 + beyond)
        size = (factor * axis[0], factor * axis[1])
        assert still < one, number
        assert abs(drifting.reach(size) - (1 + beyond)) < F(1, 10**12)
        found = judged(rail("satisfy always not Post;"), drifting, drifting.motion(size))
        assert holds(found) is (beyond < 0)
        assert found["return of the loop"].margin == pytest.approx(float(-beyond), rel=1e-3)


def _scale(rounds: Rounds, axis: Row, wanted: Fraction) -> Fraction:
    """The factor of a size at which the reach is as wanted, by bisection, to 1e-16 of it."""
    low, high = F(1, 10**6), F(10**3)
    for _ in range(100):
        middle = (low + high) / 2
        reach = rounds.reach((middle * axis[0], middle * axis[1]))
        low, high = (middle, high) if reach > wanted else (low, middle)
    return (low + high) / 2


def test_a_set_that_is_too_small_for_the_disturbances_is_not_believed() -> None:
    """Inputs are off by 0.2 % of their bound at every instant; the start by 1 mm."""
    where = rail(AGAIN, disturbances="robust start 1 mm; robust effort 0.2 % of bound;")
    rounds = Rounds()
    wide = judged(where, rounds, rounds.motion((F(1, 50), F(1, 25))))
    assert holds(wide)
    narrow = judged(where, rounds, rounds.motion((F(1, 250), F(1, 250))))
    assert narrow["return of the loop"].status is Status.UNDECIDED
    tiny = judged(where, rounds, rounds.motion((F(1, 2000), F(1))))
    assert tiny["entry into the loop"].status is Status.UNDECIDED
