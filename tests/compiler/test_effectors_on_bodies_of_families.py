"""Whether all effectors of a family are on bodies, by hand and against points of random poses."""

from __future__ import annotations

from itertools import islice

import numpy as np
import pytest
from scipy.optimize import nnls

from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.robots.effectors_on_bodies import effectors_are_on_bodies
from compiler.robots.normal_form import family_of
from compiler.words.structures import derivations_of
from grammar_lang.load import load, load_text
from tests.conftest import ROOT

ONE = """
module B {{ role base; }}
module J {{ role joint; dof q: revolute z in [-90, 90] deg; }}
module L {{ role link; param a in [0.3, 1] m; }}
module E {{ role effector; }}
grammar G {{ start R; r: R -> B J L E; }}
semantics G {{ r {{ this.at = world * rot(z, J.q); {emissions} }} }}
"""
ROD = "rod(frame: this.at, axis: x, length: L.a, density: 1 kg/m);"
TIP = "effector(frame: this.at * move(x, L.a));"
POINT = "point(frame: this.at * move(x, L.a), mass: 1 kg);"
SPHERE = "sphere(frame: {}, radius: 10 cm);"


@pytest.mark.parametrize(
    ("emissions", "wanted"),
    [
        (ROD + TIP, True),
        (ROD + "effector(frame: this.at * move(x, L.a) * rot(z, 30 deg));", True),
        (ROD + "effector(frame: this.at * rot(z, 30 deg) * move(x, L.a));", False),
        (ROD + "effector(frame: this.at * move(x, 2 * L.a));", False),
        (ROD + TIP + "effector(frame: this.at * move(x, -1 cm));", False),
        (ROD.replace("axis: x", "axis: -x") + TIP, False),
        (ROD.replace("axis: x", "axis: -x") + "effector(frame: this.at * move(-x, L.a));", True),
        (("this.tip = this.at * move(y, L.a);"
         "rod(frame: this.tip, axis: -y, length: L.a, density: 1 kg/m); effector(frame: this.at);"),
         True),
        (POINT + TIP, True),
        (POINT + TIP + SPHERE.format("world"), False),
        (POINT + TIP + SPHERE.format("this.at * move(x, L.a)"), True),
        ("capsule(frame: this.at, axis: x, length: L.a, radius: 1 cm);" + TIP, True),
        ("box(frame: this.at * move(x, L.a), size: (1, 2) cm);" + TIP, True),
        (TIP, False),
    ],
)  # fmt: skip
def test_one_production(emissions: str, wanted: bool) -> None:
    loaded = load_text(ONE.format(emissions=emissions), "one.srg")
    assert loaded.program is not None, loaded.diagnostics
    assert effectors_are_on_bodies(loaded.program, loaded.program.grammars["G"]) is wanted


def test_a_frame_of_very_many_parts_is_nowhere_known() -> None:
    """Each attribute has the one before it twice: a thousand billion steps in all."""
    doubled = "".join(f"this.a{i + 1} = this.a{i} * this.a{i}; " for i in range(40))
    both = "point(frame: this.a40, mass: 1 kg); effector(frame: this.a40);"
    text = ONE.format(emissions=f"this.a0 = this.at * move(x, 1 mm); {doubled} {both}")
    program = load_text(text, "one.srg").program
    assert program is not None
    assert not effectors_are_on_bodies(program, program.grammars["G"])


KIT = """
module B {{ role base; }}
module J {{ role joint; dof q: revolute z in [-90, 90] deg; }}
module L {{ role link; const a = 1 m; }}
module E {{ role effector; }}
grammar G {{
  start N;
  base: N -> B;  joint: N -> N J;  link: N -> N L;  tool: N -> N E;
  accept {accept};
}}
semantics G {{
  base  {{ this.frame = world; }}
  joint {{ this.frame = N.frame * rot(z, J.q); }}
  link  {{ this.frame = N.frame * move(x, L.a);
          rod(frame: N.frame, axis: x, length: L.a, density: 1 kg/m); }}
  tool  {{ this.frame = N.frame * move(y, {off}); effector(frame: N.frame); }}
}}
"""


@pytest.mark.parametrize(
    ("accept", "off", "wanted"),
    [
        ("matches B (J | L)* E", "0 m", False),
        ("matches B (J | L)* L J* E", "0 m", True),
        ("matches B J L E E", "0 m", True),
        ("matches B J L E E", "1 m", False),
        ("matches B J L E L E", "1 m", True),
        ("count(L) >= 1 and ends with E", "0 m", False),
        ("starts with B J L and ends with E and count(E) == 1", "0 m", True),
    ],
)
def test_accepted_words_alone_count(accept: str, off: str, wanted: bool) -> None:
    """In a word that leads over a link every frame behind it, turned or not, is at its end."""
    loaded = load_text(KIT.format(accept=accept, off=off), "kit.srg")
    assert loaded.program is not None, loaded.diagnostics
    assert effectors_are_on_bodies(loaded.program, loaded.program.grammars["G"]) is wanted


SPECS = sorted(path.stem for path in (ROOT / "specs").glob("*.srg"))
WORDS, POSES, NEAR, HEAVY = 6, 3, 1e-6, 1e3


@pytest.mark.parametrize("name", SPECS)
def test_no_effector_is_elsewhere_in_random_poses(name: str) -> None:
    """Those of all shipped families that are said to be on bodies, by distances to their points."""
    program = load(ROOT / "specs" / f"{name}.srg").program
    assert program is not None
    for task in program.tasks.values():
        if not effectors_are_on_bodies(program, program.grammars[task.grammar]):
            continue
        family = family_of(program, task)
        for word in islice(family.language.words(), WORDS):
            for derivation in islice(derivations_of(family.language, word), 1):
                numeric = NumericRobot(robot_graph(family.robot(derivation), task.gravity))
                assert farthest(numeric) < NEAR


def farthest(numeric: NumericRobot) -> float:
    """The largest distance, in metres, of an effector from the nearest body, in random poses."""
    model, rng = numeric.graph.model, np.random.default_rng(1)
    theta = np.array([float(rng.uniform(0.3, 0.9)) for _ in model.parameters])
    points = numeric.positions(rng.uniform(-1, 1, (POSES, numeric.n)), theta)
    count = len(model.effectors)
    worst = 0.0
    for pose in points:
        for effector in pose[:count]:
            worst = max(worst, min(_gap(effector, pose[count:], h) for h in numeric.spanning.hulls))
    return worst


def _gap(point: np.ndarray, corners: np.ndarray, hull: tuple[int, ...]) -> float:
    """The distance to the convex hull of some corners: least squares with weights that sum to 1."""
    own = corners[list(hull)] - point
    sides = np.vstack([own.T, np.full(len(own), HEAVY)])
    weights, _ = nnls(sides, np.append(np.zeros(len(point)), HEAVY))
    return float(np.linalg.norm(weights @ own / weights.sum()))


STEPS = "", " * move(x, 1 m)", " * move(y, 0.5 m)", " * rot(z, 40 deg)", " * move(x, L.a)"
BODIES = (
    "rod(frame: {0}, axis: x, length: 1 m, density: 1 kg/m);",
    "rod(frame: {0}, axis: -x, length: 1 m, density: 1 kg/m);",
    "rod(frame: {0}, axis: y, length: 0.5 m, density: 1 kg/m);",
    "point(frame: {0}, mass: 1 kg);",
    "sphere(frame: {0}, radius: 1 cm);",
    "capsule(frame: {0}, axis: x, length: 1 m, radius: 1 cm);",
)
ACCEPTED = "", "count(E) == 1", "count(L) >= 1 and ends with E", "contains J L", "count(E) == 2"


def random_family(rng: np.random.Generator) -> str:
    """A text of a family whose frames are handed down, or up, from rule to rule."""
    pick = lambda options: options[int(rng.integers(len(options)))]  # noqa: E731

    def bodies(*frames: str) -> str:
        count = int(rng.integers(3))
        return " ".join(pick(BODIES).format(pick(frames)) for _ in range(count))

    down = rng.random() < 0.5
    own, other = ("this.at", "N.at") if down else ("N.at", "this.at")
    steps = [step for step in STEPS if "L.a" not in step]
    first = pick(steps)
    rules = [
        (
            f"base {{ {'N' if down else 'this'}.at = world{first};"
            f" {bodies('world', 'N.at' if down else 'this.at')} }}"
        ),
        f"joint {{ {other} = {own} * rot(z, J.q){pick(steps)}; {bodies(own, other)} }}",
        f"link {{ {other} = {own}{pick(STEPS)}; {bodies(own, other)} }}",
        (
            f"tool {{ {other} = {own}{pick(steps)}; {bodies(own, other)}"
            f" effector(frame: {pick([own, other])}{pick(['', '', ' * move(x, 1 m)'])}); }}"
        ),
    ]
    if down:
        shapes = "base: R -> B N; joint: N -> J N; link: N -> L N; tool: N -> E N; end: N -> empty;"
        rules.append("end { }")
    else:
        shapes = "base: N -> B; joint: N -> N J; link: N -> N L; tool: N -> N E;"
    accept = pick(ACCEPTED)
    modules = KIT.split("grammar", maxsplit=1)[0].format()
    return (
        f"{modules} grammar G {{ start {'R' if down else 'N'}; {shapes}"
        f" {f'accept {accept};' if accept else ''} }} semantics G {{ {' '.join(rules)} }}"
    )


TASK = """
workspace W { plane xy; bounds box [-9, 9] x [-9, 9] m; region H box [0, 1] x [0, 1] m; }
task T { robot G; workspace W; start in H by effector 1; reach H by effector 1;
  effort <= 5 N*m; horizon 4 steps of 0.1 s; modules <= 5; }
"""


@pytest.mark.parametrize("seed", range(16))
def test_random_families_against_their_words(seed: int) -> None:
    """What is said to be on bodies is there in all words of up to five modules."""
    rng, said = np.random.default_rng(seed), 0
    for _ in range(4):
        program = load_text(random_family(rng) + TASK, "random.srg").program
        if program is None or not effectors_are_on_bodies(program, program.grammars["G"]):
            continue
        said += 1
        family = family_of(program, program.tasks["T"])
        for word in family.language.words(max_modules=5):
            derivation = next(iter(derivations_of(family.language, word)))
            model = family.robot(derivation)
            if model.effectors:
                numeric = NumericRobot(robot_graph(model, program.tasks["T"].gravity))
                assert farthest(numeric) < NEAR
