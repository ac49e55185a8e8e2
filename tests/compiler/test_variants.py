"""Neutral productions by their definition, and variants by brute force on derivations."""

from __future__ import annotations

from functools import cache
from itertools import islice

import numpy as np
import pytest

from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.lemmas.neutral_productions import neutral_productions
from compiler.lemmas.variants import holds_of_variants
from compiler.robots.candidate import candidates
from compiler.robots.normal_form import RobotFamily, family_of
from compiler.words.acceptance import accept_dfa
from compiler.words.derivation import Derivation
from compiler.words.finite_automaton import Dfa
from grammar_lang.conditions import condition_of
from tests.oracles.formulas import program
from tests.oracles.some_cases import examples

SPEC = """
module B {{ role base; }}
module J {{ role joint; dof q: revolute z in [-90, 90] deg; }}
module K {{ role joint; {knee} }}
module L {{ role link; param length in [0.5, 1] m; const density = 1 kg/m; }}
module W {{ role link; const mass = 2 kg; }}
module E {{ role effector; }}
edge eps;
grammar G {{
  start N;
  base: N -> B; joint: N -> N eps J; knee: N -> N eps K; link: N -> N eps L;
  weight: N -> N eps W; tool: N -> N eps E;
  accept contains E;
}}
semantics G {{
  base {{ this.frame = world; }}
  joint {{ this.frame = N.frame * rot(z, J.q); }}
  knee {{ {rule} }}
  link {{
    this.frame = N.frame * move(x, L.length);
    rod(frame: N.frame, axis: x, length: L.length, density: L.density);
  }}
  weight {{ this.frame = N.frame; point(frame: N.frame, mass: W.mass); }}
  tool {{ this.frame = N.frame; effector(frame: N.frame); }}
}}
workspace W1 {{ plane xy; bounds box [-9, 9] x [-9, 9] m; region S box [0, 1] x [0, 1] m;
  target T box [2, 3] x [2, 3] m; }}
task Go {{ robot G; workspace W1; start in S at rest; reach T;
  effort <= 1 N*m; effort <= 1 N; horizon 9 steps of 0.1 s; }}
"""
KNEE = ("dof q: revolute z in [-90, 90] deg;", "this.frame = N.frame * rot(z, K.q);")


def family(knee: str = KNEE[0], rule: str = KNEE[1]) -> RobotFamily:
    found = program(SPEC.format(knee=knee, rule=rule))
    (task,) = found.tasks.values()
    return family_of(found, task)


def labels(of: RobotFamily, kind: str) -> list[str]:
    found = neutral_productions(of.program, of.grammar)
    return [of.grammar.productions[n].label for n in sorted(getattr(found, kind))]


@pytest.mark.parametrize(
    ("knee", "rule", "removable"),
    [
        (*KNEE, True),
        ("dof q: revolute z;", KNEE[1], True),
        ("dof q: revolute z in [10, 90] deg;", KNEE[1], False),
        ("dof q: revolute z in [0, 90] deg;", KNEE[1], True),
        ("dof q: revolute z in [-90, 90] deg rate in [1, 2] rad/s;", KNEE[1], False),
        ("dof q: revolute z in [-90, 90] deg rate in [-1, 2] rad/s;", KNEE[1], True),
        # A neutral value other than zero: the joint takes back what the bracket turns.
        (KNEE[0], "this.frame = N.frame * rot(z, 80 deg) * rot(z, K.q);", True),
        (KNEE[0], "this.frame = N.frame * rot(z, 91 deg) * rot(z, K.q);", False),
        (KNEE[0], "this.frame = N.frame * rot(z, 80 deg) * move(x, 0 m) * rot(z, K.q);", False),
        (KNEE[0], "this.frame = N.frame * rot(z, K.q) * move(x, 10 cm);", False),
        (
            "dof q: revolute z in [-90, 90] deg; param arm in [0, 1] m;",
            "this.frame = N.frame * rot(z, K.q) * move(x, K.arm);",
            True,
        ),
        (
            "dof q: revolute z in [-90, 90] deg; param arm in [0.1, 1] m;",
            "this.frame = N.frame * rot(z, K.q) * move(x, K.arm);",
            False,
        ),
        ("dof q: prismatic x in [-1, 1] m;", "this.frame = N.frame * move(x, K.q);", True),
        ("dof q: prismatic x in [0.1, 1] m;", "this.frame = N.frame * move(x, K.q);", False),
        (KNEE[0], "let f = N.frame * rot(z, K.q); this.frame = f;", True),
        (KNEE[0], f"{KNEE[1]} point(frame: N.frame, mass: 1 kg);", False),
        (KNEE[0], "this.frame = world * rot(z, K.q);", False),
    ],
)  # fmt: skip
def test_joints_that_may_be_missing(knee: str, rule: str, removable: bool) -> None:
    found = labels(family(knee, rule), "removable")
    assert found == (["joint", "knee"] if removable else ["joint"])


def test_parts_that_change_no_pose() -> None:
    assert labels(family(), "transparent") == ["weight"]


# --- Variants of a derivation ---------------------------------------------------------------------


def chain(derivation: Derivation) -> tuple[str, ...]:
    """The labels from the effector's end to the base: these grammars derive chains."""
    return derivation.labels


def is_variant(found: tuple[str, ...], base: tuple[str, ...]) -> bool:
    """By the definition: parts put in are left out, then joints of the base are missing."""
    bare = [label for label in found if label != "weight"]
    due = [label for label in base if label != "weight"]
    if [label for label in bare if label == "weight"]:
        return False
    place = 0
    for label in due:
        if place < len(bare) and bare[place] == label:
            place += 1
        elif label not in ("joint", "knee"):
            return False
    return place == len(bare)


CONDITIONS = [
    "matches B (eps J)? eps L (eps K)? eps L eps E",
    "matches B (eps W)* (eps J)? (eps W)* eps L (eps W)* (eps K)? eps L (eps W)* eps E (eps W)*",
    "matches B (eps J)* eps L (eps K)? eps L eps E",
    "matches B (eps J)? eps L eps L eps E",
    "matches B (eps K)? eps L eps L eps E",
    "matches B (eps J)? eps L (eps K | eps J)? eps L eps E",
    "count(L) == 2 and count(E) == 1 and count(J) <= 1 and count(K) <= 1",
    "count(L) == 1 and count(E) == 1",
    "matches B eps L eps L eps E (eps E)?",
]


@pytest.mark.parametrize("text", CONDITIONS)
def test_variants_by_brute_force(text: str) -> None:
    of = family()
    (task,) = of.program.tasks.values()
    base = of.replay(("tool", "link", "knee", "link", "joint", "base"))
    condition = condition_of(text, of.language.srg.terminals)
    read = [each for each in short_derivations() if accepted(text).accepts(each.word)]
    assert read
    expected = all(is_variant(chain(each), chain(base)) for each in read)
    assert holds_of_variants(of, task, base, condition) == expected


@cache
def short_derivations() -> tuple[Derivation, ...]:
    """Those of all robots of up to six modules, or seven."""
    return tuple(each.derivation for each in candidates(family(), examples(6, 7), None))


@cache
def accepted(text: str) -> Dfa:
    alphabet = ("B", "J", "K", "L", "W", "E", "eps")
    return accept_dfa(condition_of(text, alphabet), alphabet)


def test_a_variant_has_no_pose_that_the_other_has_not() -> None:
    """Positions of the effector of variants, found again with the missing joints at zero."""
    of = family()
    base = of.replay(("tool", "link", "knee", "link", "joint", "base"))
    rng = np.random.default_rng(3)
    whole = NumericRobot(robot_graph(of.robot(base), (0, 0, 0)))
    for labels_of in (
        ("tool", "link", "link", "joint", "base"),
        ("tool", "weight", "link", "knee", "link", "base"),
        ("weight", "tool", "link", "link", "base"),
    ):
        derivation = of.replay(labels_of)
        variant = NumericRobot(robot_graph(of.robot(derivation), (0, 0, 0)))
        kept = [label for label in ("joint", "knee") if label in labels_of]
        q = rng.uniform(-1.5, 1.5, size=(20, variant.n))
        full = np.zeros((20, 2))
        for column, label in enumerate(kept):
            full[:, ("joint", "knee").index(label)] = q[:, column]
        theta = rng.uniform(0.5, 1, size=2)
        mine = variant.points(q, theta).value[:, 0]
        assert np.allclose(mine, whole.points(full, theta).value[:, 0])


def test_where_nothing_is_neutral() -> None:
    of = family()
    base = next(islice(candidates(of, 5, None), 1)).derivation
    (task,) = of.program.tasks.values()
    at = program(
        SPEC.format(knee=KNEE[0], rule=KNEE[1]).replace("start in S at rest;", "start at (0 rad);")
    )
    (given,) = at.tasks.values()
    condition = condition_of("count(E) == 1", of.language.srg.terminals)
    assert not holds_of_variants(family_of(at, given), given, base, condition)
    assert task.origin is None
