"""Where effectors are said to be, against poses of random robots of random words."""

from __future__ import annotations

from fractions import Fraction
from itertools import islice

import numpy as np
import pytest
from flint import arb

from compiler.arrays import Array
from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.expressions.evaluators.balls import working_precision
from compiler.lemmas.effector_bounds import (
    PRECISION,
    BallBound,
    HalfSpaceBound,
    keep_to,
    placements_of,
)
from compiler.lemmas.frame_placement import Placement
from compiler.robots.candidate import candidates_of
from compiler.robots.normal_form import RobotFamily, family_of
from grammar_lang import ir
from tests.oracles.formulas import program
from tests.oracles.random_kits import RandomKit

TASK = """
workspace W { %s bounds box %s m; region S box %s m; target T box %s m; }
task Go {
  robot G; workspace W; start in S at rest; reach T;
  effort <= 1 N*m; effort <= 1 N; horizon 9 steps of 0.1 s;
}
"""
WORDS, POSES = 25, 40
GRAVITY = (Fraction(0),) * 3


def task_text(plane: bool) -> str:
    sides = ["[-90, 90]", "[0, 1]", "[2, 3]"]
    boxes = [" x ".join([side] * (2 if plane else 3)) for side in sides]
    return TASK % ("plane xy;" if plane else "space xyz;", *boxes)


def poses(family: RobotFamily, condition: ir.Accept, rng: np.random.Generator) -> Array:
    """Positions (k, 3) of effectors: random words of a condition, parameters and coordinates."""
    narrowed = RobotFamily(
        family.program,
        ir.Grammar(
            "G", family.grammar.start, family.grammar.nonterminals, family.grammar.productions,
            ir.AllOf((family.grammar.accept, condition)), family.grammar.semantics,
        ),
        family.dimension,
    )  # fmt: skip
    words = list(islice(narrowed.language.words(max_modules=9), 400))
    found = [np.zeros((0, 3))]
    for index in rng.permutation(len(words))[:WORDS]:
        for candidate in candidates_of(narrowed, [words[index]], None):
            model = candidate.model
            if model is None or not model.effectors:
                continue
            numeric = NumericRobot(robot_graph(model, GRAVITY))
            low, high = _ranges(model.parameters)
            theta = rng.uniform(low, high)
            turns = rng.uniform(-np.pi, np.pi, size=(POSES, numeric.n))
            points = numeric.points(turns, theta).value[:, : len(model.effectors)]
            padded = np.zeros((points.shape[0] * points.shape[1], 3))
            padded[:, : points.shape[2]] = points.reshape(-1, points.shape[2])
            found.append(padded)
    return np.concatenate(found)


def _ranges(parameters: tuple[object, ...]) -> tuple[list[float], list[float]]:
    return [0.2] * len(parameters), [0.6] * len(parameters)


def within(placements: tuple[Placement, ...], points: Array, rng: np.random.Generator) -> float:
    """By how much points keep to random bounds at least: the tightest that placements allow."""
    slack = np.inf
    for _ in range(10):
        normal = tuple(Fraction(x).limit_denominator(1000) for x in rng.normal(size=3))
        centre = tuple(Fraction(x).limit_denominator(1000) for x in rng.normal(size=3))
        with working_precision(PRECISION):
            reach = max(
                min(_float(p.known.furthest(normal)), _float(p.based.furthest(normal)))
                for p in placements
            )
            away = min(
                max(_float(p.known.nearest(centre)), _float(p.based.nearest(centre)))
                for p in placements
            )
        slack = min(slack, reach - float(np.max(points @ np.array(normal, float))))
        near = np.linalg.norm(points - np.array(centre, float), axis=1)
        slack = min(slack, float(np.min(near)) - away)
    return slack


def _float(value: arb) -> float:
    return float(value) if value.is_finite() else float("inf" if value > 0 else "-inf")


def check_kit(seed: int) -> None:
    kit = RandomKit(seed)
    rng = np.random.default_rng(seed)
    found = program(kit.text + task_text(kit.plane))
    (task,) = found.tasks.values()
    family = family_of(found, task)
    modules = [name for name in found.modules if name != "Base"]
    condition: ir.Accept = ir.AllOf(
        tuple(ir.Count(name, "<=", int(rng.integers(0, 3))) for name in modules)
    )
    points = poses(family, condition, rng)
    placements = placements_of(family, condition)
    if len(points):
        assert within(placements, points, rng) >= -1e-9


@pytest.mark.parametrize("block", range(3))
def test_effectors_of_random_kits(block: int) -> None:
    for seed in range(10 * block, 10 * block + 10):
        check_kit(seed)


@pytest.mark.slow
@pytest.mark.parametrize("block", range(27))
def test_effectors_of_three_hundred_random_kits(block: int) -> None:
    for seed in range(10 * block + 30, 10 * block + 40):
        check_kit(seed)


ARM = """
module B { role base; }
module J { role joint; dof q: revolute z in [-180, 180] deg; }
module U { role joint; dof q: revolute y in [-90, 90] deg; }
module P { role joint; dof d: prismatic z in [0, 2] m; }
module L { role link; param length in [1, 3] m; const density = 1 kg/m; }
module K { role link; param length in [10, 11] m; const density = 1 kg/m; }
module E { role effector; }
edge eps;
grammar G {
  start N;
  base: N -> B; joint: N -> N eps J; up: N -> N eps U; slide: N -> N eps P;
  link: N -> N eps L; long: N -> N eps K; tool: N -> N eps E;
  accept count(E) == 1 and ends with E;
}
semantics G {
  base { this.frame = world * move(z, 0.5 m); }
  joint { this.frame = N.frame * rot(z, J.q); }
  up { this.frame = N.frame * rot(y, U.q); }
  slide { this.frame = N.frame * move(z, P.d); point(frame: N.frame, mass: 1 kg); }
  link {
    this.frame = N.frame * move(x, L.length);
    rod(frame: N.frame, axis: x, length: L.length, density: L.density);
  }
  long {
    this.frame = N.frame * move(x, K.length);
    rod(frame: N.frame, axis: x, length: K.length, density: K.density);
  }
  tool { this.frame = N.frame; effector(frame: N.frame); }
}
"""


@pytest.fixture(scope="module")
def arm() -> RobotFamily:
    found = program(ARM + task_text(plane=False))
    (task,) = found.tasks.values()
    return family_of(found, task)


def counts(**most: int) -> ir.Accept:
    return ir.AllOf(tuple(ir.Count(name, "<=", count) for name, count in most.items()))


EDGE = Fraction(1, 10**9)


@pytest.mark.parametrize(
    ("most", "normal", "reach"),
    [
        # Two links of 3 m and one of 11 m, in any order, beyond any joints.
        ({"L": 2, "K": 1, "P": 0}, (1, 0, 0), 17),
        # Heights are not lost where all joints turn about z: the base and two slides.
        ({"L": 2, "K": 0, "U": 0, "P": 2}, (0, 0, 1), Fraction(9, 2)),
        ({"L": 2, "K": 0, "U": 0, "P": 2}, (0, 0, -1), Fraction(-1, 2)),
        # Before a joint about y all that stands upright does, behind it anything may.
        ({"L": 1, "K": 0, "P": 0}, (0, 0, 1), Fraction(7, 2)),
    ],
)
def test_the_farthest(
    arm: RobotFamily, most: dict[str, int], normal: tuple[int, int, int], reach: Fraction
) -> None:
    placements = placements_of(arm, counts(**most))
    exact = tuple(Fraction(x) for x in normal)
    assert keep_to(HalfSpaceBound(exact, reach + EDGE), placements)
    assert not keep_to(HalfSpaceBound(exact, reach - EDGE), placements)


def test_the_nearest(arm: RobotFamily) -> None:
    """One long link and two short ones: 10 m less 2 times 3 m from the base."""
    one_long = ir.AllOf((counts(L=2, P=0), ir.Count("K", "==", 1)))
    placements = placements_of(arm, one_long)
    base = (Fraction(0), Fraction(0), Fraction(1, 2))
    assert keep_to(BallBound(base, 4 - EDGE), placements)
    assert not keep_to(BallBound(base, 4 + EDGE), placements)
    # Where the long link may be missing, or two of them are, an effector comes back to the base.
    for other in (counts(L=2, P=0, K=1), ir.AllOf((counts(L=2, P=0), ir.Count("K", "==", 2)))):
        assert not keep_to(BallBound(base, EDGE), placements_of(arm, other))


def test_an_unlimited_slide_goes_anywhere() -> None:
    found = program(ARM.replace("prismatic z in [0, 2] m", "prismatic z") + task_text(plane=False))
    (task,) = found.tasks.values()
    family = family_of(found, task)
    up = (Fraction(0), Fraction(0), Fraction(1))
    far = HalfSpaceBound(up, Fraction(10**9))
    assert not keep_to(far, placements_of(family, counts(L=1, K=0, P=1)))
    assert keep_to(far, placements_of(family, counts(L=1, K=0, P=0)))
