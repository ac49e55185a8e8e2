"""Coverings that a search finds: of what cannot be done, by brute force, and of nothing else."""

from __future__ import annotations

from collections import deque

import numpy as np
import pytest
from numpy.typing import NDArray

from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.robots.normal_form import family_of
from compiler.robots.robot import RobotModel
from compiler.unreachability.box_tree import text
from compiler.unreachability.motion_conditions import motion_conditions
from compiler.words.structures import structures
from grammar_lang import ir
from solvers.impossibility.box_search import CoveringBudget, find_covering
from solvers.impossibility.drive_search import AFTER_MOTIONS, drive_refutation
from solvers.impossibility.structure_refutation import Refutation, refute_structure
from solvers.run_context import RunContext
from solvers.search.synthesis import synthesise
from solvers.verifier.refutations.box_check import why_not
from tests.oracles import small_specs
from tests.oracles.formulas import program, spec

Flags = NDArray[np.bool_]
ONE, TWO = "eps J eps L eps E", "eps J eps L eps J eps L eps E"
WEDGE = """
region Near box [0.5, 1.5] x [-0.1, 0.1] m; target T box [-0.1, 0.1] x [0.5, 1.9] m;
obstacle O polytope { x - y <= 0.2; y - x <= 0.2; x >= 0.1; x <= 2; } m;
obstacle Behind box [-0.2, 0.2] x [-2.2, -0.3] m;
"""
"""A tilted wedge between start and target; another obstacle is in the way around."""
CORNER = """
target T box [-0.1, 0.1] x [-0.9, 1.9] m;
obstacle O polytope { x - y <= 0.2; y - x <= 0.2; x >= 0.3; x <= 2; } m;
"""
FREE_TURN = (("in [-170, 170] deg", ""), ("bounds box [-1, 4] x [-1, 4]",
             "bounds box [-4, 4] x [-4, 4]"))  # fmt: skip
EFFORT = CoveringBudget(3_000, 1_500, 120)


def robot(
    clauses: str, regions: str, arms: str, changes: tuple[tuple[str, str], ...] = ()
) -> tuple[ir.Program, ir.Task, RobotModel]:
    """The only robot of a family."""
    content = spec(f"{clauses} modules <= {2 + 2 * arms.count('L')};", regions, arms=arms)
    for old, new in changes:
        assert old in content
        content = content.replace(old, new)
    found = program(content)
    task = found.tasks["P"]
    family = family_of(found, task)
    (derivation,) = structures(family.language, 2 + 2 * arms.count("L"))
    return found, task, family.robot(derivation)


def answer(
    clauses: str, regions: str, arms: str, changes: tuple[tuple[str, str], ...] = ()
) -> Refutation:
    found, task, model = robot(clauses, regions, arms, changes)
    numeric = NumericRobot(robot_graph(model, task.gravity))
    return refute_structure(model, numeric, found, task, RunContext(seed=0))


@pytest.mark.parametrize(
    ("avoided", "changes", "refuted"),
    [("O", (), True), ("O", FREE_TURN, False), ("O, Behind", FREE_TURN, True)],
)
def test_one_joint_has_to_sweep_through(
    avoided: str, changes: tuple[tuple[str, str], ...], *, refuted: bool
) -> None:
    """A full turn is a circle: one wall is no obstacle to it, two are."""
    found = answer(f"start in Near; reach T; avoid {avoided} with effector;", WEDGE, ONE, changes)
    assert (found.refuted, found.script) == (refuted, None)
    if refuted:
        assert found.reason == "no way between the start region and the target for any parameters"


@pytest.mark.parametrize(
    ("start", "reason"),
    [
        ("200 deg, 0", "the given start is out of the range of a joint"),
        ("45 deg, 10 deg", "no way from the given start to the target for any parameters"),
        ("-45 deg, 60 deg", None),
    ],
)
def test_a_given_start(start: str, reason: str | None) -> None:
    found = answer(f"start at ({start}); reach T; avoid O with body;", CORNER, TWO)
    assert found.refuted == (reason is not None)
    if reason is not None:
        assert found.boxes is not None
        assert found.reason == reason


@pytest.mark.parametrize("content", [small_specs.BEYOND_REACH], ids=["beyond_reach"])
def test_every_refuted_structure_has_boxes(content: str) -> None:
    found = program(content)
    (task,) = found.tasks.values()
    result = synthesise(found, task, RunContext(lemmas=False))
    assert result.verdict == "impossible"
    for record in result.records:
        assert (record.boxes is not None) == (record.verdict == "refuted")


# --- brute force -------------------------------------------------------------------------------

SECOND_LINK = (
    ("edge eps;", "module M { role link; param length in [0.5, 2] m; } edge eps;"),
    ("link: N -> N eps L;", "link: N -> N eps L; other: N -> N eps M;"),
    (
        "  tool  {",
        """  other { this.frame = N.frame * move(x, M.length);
          rod(frame: N.frame, axis: x, length: M.length, density: 1 kg/m); }
  tool  {""",
    ),
)
"""A module for links of another length."""
GRID, ALONG = 180, np.linspace(0.0, 1.0, 25)


def world(seed: int) -> tuple[str, tuple[float, float], list[tuple[float, ...]]]:
    """Regions Near and T, two obstacles, and the lengths of two links, all random."""
    rng = np.random.default_rng(seed)
    lengths = tuple(round(float(x), 2) for x in rng.uniform(0.5, 1.6, 2))
    boxes = []
    for size in (0.4, 0.4, 0.9, 0.9):
        low = rng.uniform(-1.8, 1.6, 2)
        width = rng.uniform(size, 1.6 * size, 2)
        boxes.append(tuple(round(float(v), 2) for v in (*low, *(low + width))))
    kinds = ("region Near", "target T", "obstacle O", "obstacle Q")
    lines = [
        f"{kind} box [{b[0]}, {b[2]}] x [{b[1]}, {b[3]}] m;"
        for kind, b in zip(kinds, boxes, strict=True)
    ]
    return " ".join(lines), (lengths[0], lengths[1]), boxes


def inside(points: NDArray[np.float64], box: tuple[float, ...]) -> Flags:
    low, high = np.array(box[:2]), np.array(box[2:])
    return np.asarray(((points >= low) & (points <= high)).all(axis=-1))


def has_way(lengths: tuple[float, float], boxes: list[tuple[float, ...]]) -> bool:
    """Flood fill of a grid of both angles, the whole arm clear of both obstacles."""
    turn = np.radians(np.linspace(-170, 170, GRID))
    first, second = np.meshgrid(turn, turn, indexing="ij")
    elbow = lengths[0] * np.stack([np.cos(first), np.sin(first)], axis=-1)
    both = first + second
    tip = elbow + lengths[1] * np.stack([np.cos(both), np.sin(both)], axis=-1)
    free = np.abs(tip).max(axis=-1) <= 4
    for s in ALONG:
        for obstacle in boxes[2:]:
            free &= ~inside(s * elbow, obstacle) & ~inside(elbow + s * (tip - elbow), obstacle)
    start, goal = free & inside(tip, boxes[0]), free & inside(tip, boxes[1])
    queue, seen = deque(map(tuple, np.argwhere(start))), start.copy()
    while queue:
        i, j = queue.popleft()
        for a, b in ((i + 1, j), (i - 1, j), (i, j + 1), (i, j - 1)):
            if 0 <= a < GRID and 0 <= b < GRID and free[a, b] and not seen[a, b]:
                seen[a, b] = True
                queue.append((a, b))
    return bool((seen & goal).any())


def covered(seed: int) -> tuple[bool, bool]:
    """Whether a covering is found for a random world, and whether there is a way by brute force."""
    regions, lengths, boxes = world(seed)
    clauses = "start in Near; reach T; avoid O, Q with body; modules <= 6;"
    content = spec(clauses, regions, arms=TWO.replace("L eps J eps L", "L eps J eps M"))
    for old, new in (*SECOND_LINK, FREE_TURN[1]):
        assert old in content
        content = content.replace(old, new)
    for module, length in zip("LM", lengths, strict=True):
        old = f"module {module} {{ role link; param length in [0.5, 2] m; }}"
        assert old in content
        content = content.replace(old, old.replace("[0.5, 2]", f"[{length}, {length}]"))
    found = program(content)
    task = found.tasks["P"]
    family = family_of(found, task)
    (derivation,) = structures(family.language, 6)
    model, workspace = family.robot(derivation), found.workspaces[task.workspace]
    graph = robot_graph(model, task.gravity)
    covering = find_covering(motion_conditions(model, workspace, task), graph, EFFORT)
    if covering is not None:
        assert why_not(text(covering.tree), model, workspace, task) is None
    return covering is not None, has_way(lengths, boxes)


def test_random_worlds_against_a_flood_fill() -> None:
    """What is covered has no way; most of what has no way is covered."""
    found = [covered(seed) for seed in range(10)]
    assert (True, True) not in found
    assert (False, True) in found
    assert found.count((True, False)) >= 2 * found.count((False, False))
    assert (True, False) in found


# --- drives ------------------------------------------------------------------------------------

QUARTER = """
region Near box [1.1, 1.3] x [-0.1, 0.1] m; target T box [-0.1, 0.1] x [1.1, 1.3] m;
"""
LENGTH, TIME = 1.2, 4.0
LEAST_EFFORT = 2 * (np.pi / 2 - 2 * np.arcsin(0.1 / LENGTH)) * LENGTH**3 / 3 / TIME**2
"""Turns the rod from rest by the angle between the regions, u T^2 / 2 I."""


def turned(effort: float) -> tuple[tuple[str, str], ...]:
    """A rod of 1 kg/m with so weak a drive."""
    return (
        ("[0.5, 2] m", f"[{LENGTH}, {LENGTH}] m"),
        ("effort <= 1 N*m", f"effort <= {effort} N*m"),
    )


def test_a_drive_that_is_far_too_weak_is_seen_before_motions_are_searched() -> None:
    weak = answer("start in Near; reach T;", QUARTER, ONE, turned(LEAST_EFFORT / 3))
    assert weak.refuted
    assert weak.boxes is not None
    assert "!" in weak.boxes
    assert "has to move by" in weak.reason
    strong = answer("start in Near; reach T;", QUARTER, ONE, turned(LEAST_EFFORT * 1.02))
    assert (strong.refuted, strong.reason) == (False, "poses were found")


@pytest.mark.parametrize(("part", "refuted"), [(0.85, True), (1.02, False)])
def test_a_drive_that_is_too_weak(part: float, *, refuted: bool) -> None:
    found, task, model = robot("start in Near; reach T;", QUARTER, ONE, turned(LEAST_EFFORT * part))
    graph = robot_graph(model, task.gravity)
    shown = drive_refutation(model, graph, found.workspaces["W"], task, AFTER_MOTIONS)
    assert (shown is not None) == refuted
    if shown is not None:
        assert why_not(shown.boxes, model, found.workspaces["W"], task) is None


@pytest.mark.parametrize(("part", "refuted"), [(0.85, True), (1.02, False)])
def test_a_stay_leaves_less_time_to_get_there(part: float, *, refuted: bool) -> None:
    """From rest to rest in 3 s of 4 s takes 4 I / 9 times the angle."""
    effort = part * LEAST_EFFORT * 2 * TIME**2 / 3**2
    found, task, model = robot(
        "start in Near; reach T at rest for 1 s;", QUARTER, ONE, turned(effort)
    )
    graph, workspace = robot_graph(model, task.gravity), found.workspaces["W"]
    shown = drive_refutation(model, graph, workspace, task, AFTER_MOTIONS)
    assert (shown is not None) == refuted
    if shown is not None:
        assert why_not(shown.boxes, model, workspace, task) is None
        _, brief, _ = robot("start in Near; reach T at rest;", QUARTER, ONE, turned(effort))
        refused = why_not(shown.boxes, model, workspace, brief)
        assert refused is not None
        assert "it is not shown that the drives are too weak" in refused
