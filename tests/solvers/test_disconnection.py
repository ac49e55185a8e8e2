"""Places that are cut off from each other, against a flood of a fine raster and by false claims."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from compiler.workspaces.abstraction import abstract
from solvers.impossibility.disconnection import disconnected, separation_text
from solvers.verifier.claims.certificate import ImpossibleClaim, SeparationClaim, from_text, to_text
from solvers.verifier.refutations.separation_check import misstated_separation
from solvers.verifier.verification import Outcome, verify_directory
from tests.oracles import result_files
from tests.oracles.formulas import TWO_ARMS, program, spec

PLACES = """
region S box [-0.5, 0] x [-0.5, 0] m; target T box [3, 3.5] x [0, 0.5] m;
region A box [3, 3.5] x [2, 3] m; region F box [-1, -0.5] x [2, 3] m;
"""
WALL = PLACES + "obstacle Wall box [1, 2] x [-1, 4] m; obstacle Block box [0, 0.5] x [1, 2] m;"
RING = (
    PLACES
    + """
obstacle West box [2, 2.5] x [-1, 1.5] m; obstacle South box [2, 4] x [-1, -0.5] m;
obstacle North box [2.5, 4] x [1, 1.5] m; obstacle East box [3.8, 4] x [-0.5, 1] m;
"""
)
CORNERS = (
    PLACES
    + """
obstacle One box [1, 2] x [-1, 1] m; obstacle Two box [2, 3] x [1, 4] m;
"""
)
"""Two obstacles that touch at a corner: the other two cells there touch, too."""

Decided = tuple[str, str, tuple[str, ...]] | None


def decided(clauses: str, regions: str, **other: str) -> Decided:
    """The two places that are cut off, and what is in the way; checked as a claim, too."""
    found = program(spec(clauses, regions, **other))
    task, cells = found.tasks["P"], abstract(found.workspaces["W"])
    claim = disconnected(found, task, cells)
    if claim is None:
        return None
    assert misstated_separation(found, task, cells, claim) is None
    return claim.source, claim.target, claim.avoided


AVOID = "avoid Wall, Block with effector;"


@pytest.mark.parametrize(
    ("clauses", "regions", "cut"),
    [
        (f"start in S; reach T; {AVOID}", WALL, ("S", "T", ("Wall",))),
        (f"start in S by effector 1; reach T; {AVOID}", WALL, ("S", "T", ("Wall",))),
        (f"start in S; reach F; {AVOID}", WALL, None),
        ("start in S; reach T; avoid Block with effector;", WALL, None),
        ("start in S; reach T; avoid Wall with body;", WALL, ("S", "T", ("Wall",))),  # on a rod
        ("start in S; reach T; avoid Wall with body, margin 5 cm; avoid Block with effector;", WALL,
         ("S", "T", ("Wall",))),
        ("start in S; reach T; avoid Wall with effector, margin 5 cm;", WALL,
         ("S", "T", ("Wall",))),
        ("start in S; reach T; satisfy always not Wall;", WALL, ("S", "T", ("Wall",))),
        ("start in S; satisfy not Wall until T;", WALL, None),  # in T it may have crossed it
        (f"start in S; {AVOID} satisfy eventually T;", WALL, ("S", "T", ("Wall",))),
        (f"start in S; {AVOID} satisfy eventually (T or A);", WALL, None),  # of no use, but sound
        (f"start in S; reach F; {AVOID} satisfy eventually A;", WALL, ("S", "A", ("Wall",))),
        (f"start at (0); {AVOID} satisfy eventually F and eventually A;", WALL,
         ("A", "F", ("Wall",))),
        (f"start at (0); reach T; {AVOID}", WALL, None),
        ("start in S; reach T; avoid West, North, South, East with effector;", RING,
         ("S", "T", ("North", "West"))),
        ("start in S; reach T; avoid West, South with effector;", RING, None),
        ("start in S; reach T; avoid One, Two with effector;", CORNERS, None),
    ],
)  # fmt: skip
def test_what_is_cut_off(clauses: str, regions: str, cut: Decided) -> None:
    assert decided(clauses, regions) == cut


ROD = "rod(frame: N.frame, axis: x, length: L.length, density: 1 kg/m);"


@pytest.mark.parametrize(
    ("emitted", "cut"),
    [
        ("point(frame: N.frame, mass: 1 kg);", False),
        ("point(frame: this.frame, mass: 1 kg);", True),
        ("point(frame: this.frame, mass: 1 kg); sphere(frame: N.frame, radius: 1 cm);", False),
        ("rod(frame: N.frame, axis: x, length: 0.9 * L.length, density: 1 kg/m);", False),
    ],
)
def test_what_bodies_avoid_binds_effectors_on_bodies(emitted: str, cut: bool) -> None:
    """A tip that no body reaches may pass through what only bodies avoid, and a claim may not."""
    text = spec("start in S; reach T; avoid Wall with body;", WALL)
    assert ROD in text
    on_rod = program(text)
    claim = disconnected(on_rod, on_rod.tasks["P"], abstract(on_rod.workspaces["W"]))
    assert claim is not None
    found = program(text.replace(ROD, emitted))
    task, cells = found.tasks["P"], abstract(found.workspaces["W"])
    assert (disconnected(found, task, cells) is not None) is cut
    reason = misstated_separation(found, task, cells, claim)
    assert reason == (None if cut else "the separation names a region that the task does not avoid")


@pytest.mark.parametrize(
    ("clauses", "cut"),
    [
        ("start in S; reach T;", True),  # one effector does both, whichever it is
        ("start in S by effector 2; reach T by effector 2;", True),
        ("start in S; reach T by effector 2;", True),  # then it is the second that starts
        ("start in S by effector 2; reach T;", False),  # the first may reach
        ("start in S by effector 1; reach T by effector 2;", False),
        ("start in S by effector 1; satisfy eventually A by effector 2;", False),
        ("start in S; satisfy eventually A by effector 2;", False),
        ("start in S by effector 2; satisfy eventually A by effector 2;", True),
        (("start in S by effector 1; satisfy eventually (F by effector 2 and "
         "eventually A by effector 2);"), True),
    ],
)  # fmt: skip
def test_it_is_one_effector_that_cannot_pass(clauses: str, cut: bool) -> None:
    assert (decided(f"{clauses} {AVOID}", WALL, arms=TWO_ARMS) is not None) is cut


def test_a_formula_binds_its_own_effector() -> None:
    never = "satisfy always not Wall by effector 2;"
    two = "start in S by effector 2; reach T by effector 2;"
    assert decided(f"{two} {never}", WALL, arms=TWO_ARMS) == ("S", "T", ("Wall",))
    assert decided(f"{two.replace('2', '1')} {never}", WALL, arms=TWO_ARMS) is None
    assert decided(f"start in S; reach T; {never}", WALL, arms=TWO_ARMS) is None


def test_a_place_that_touches_the_other_side() -> None:
    """Closed sets: a flat wall is none, and what touches both sides is on both."""
    # S reaches over the wall's corner to a cell of the other side, which it only touches.
    beside = PLACES.replace("[-0.5, 0] x [-0.5, 0]", "[0.5, 2] x [-0.5, 0]") + (
        "obstacle Wall box [1, 2] x [-1, 4] m;"
    )
    assert decided("start in S; reach T; avoid Wall with effector;", beside) is None
    inside = beside.replace("x [-0.5, 0]", "x [-0.5, 0]").replace("[0.5, 2]", "[0.5, 1.9]")
    assert decided("start in S; reach T; avoid Wall with effector;", inside) is not None


def test_the_reason_in_words() -> None:
    found = program(spec(f"start in S; reach T; {AVOID}", WALL))
    claim = disconnected(found, found.tasks["P"], abstract(found.workspaces["W"]))
    assert claim is not None
    assert separation_text(found, found.tasks["P"], claim) == (
        "start `S` and target `T` are cut off from each other: every way between them leads "
        "through `Wall`, never entered; this holds for every robot, whatever its size"
    )


# --- random worlds -------------------------------------------------------------------------------

SIZE = 7


def square(i: int, j: int) -> str:
    """A box strictly inside a unit square."""
    return f"box [{i}.25, {i}.75] x [{j}.25, {j}.75] m"


def flooded(free: np.ndarray[Any, Any], first: tuple[int, int], last: tuple[int, int]) -> bool:
    """Whether free unit squares lead from one to another; those that share a corner touch."""
    reached, pending = {first}, [first]
    while pending:
        i, j = pending.pop()
        for near in ((a, b) for a in (i - 1, i, i + 1) for b in (j - 1, j, j + 1)):
            inside = min(near) >= 0 and max(near) < SIZE
            if inside and near not in reached and free[near]:
                reached.add(near)
                pending.append(near)
    return last in reached


@pytest.mark.parametrize("seed", range(40))
def test_random_worlds(seed: int) -> None:
    rng = np.random.default_rng(seed)
    free = np.ones((SIZE, SIZE), dtype=bool)
    regions, names = list[str](), list[str]()
    for number in range(int(rng.integers(4, 11))):
        (left, low), (width, height) = rng.integers(0, SIZE - 1, 2), rng.integers(1, 5, 2)
        right, high = min(SIZE, left + width), min(SIZE, low + height)
        free[left:right, low:high] = False
        regions.append(f"obstacle O{number} box [{left}, {right}] x [{low}, {high}] m;")
        names.append(f"O{number}")
    choices = np.argwhere(free)
    (i, j), (k, n) = choices[rng.choice(len(choices), 2, replace=False)]
    regions += [f"region S {square(i, j)}; target T {square(k, n)};"]
    text = spec(f"start in S; reach T; avoid {', '.join(names)} with effector;", "".join(regions))
    bounds = f"bounds box [0, {SIZE}] x [0, {SIZE}] m;"
    found = program(text.replace("bounds box [-1, 4] x [-1, 4] m;", bounds))
    task, cells = found.tasks["P"], abstract(found.workspaces["W"])
    claim = disconnected(found, task, cells)
    assert (claim is None) is flooded(free, (i, j), (k, n))
    if claim is not None:
        assert misstated_separation(found, task, cells, claim) is None
        for name in claim.avoided:  # none can be spared
            fewer = replace(task.avoid[0], regions=tuple(set(claim.avoided) - {name}))
            assert disconnected(found, replace(task, avoid=(fewer,)), cells) is None


def test_both_answers_occur() -> None:
    """The random worlds would say nothing if all of them were connected."""
    free = np.ones((SIZE, SIZE), dtype=bool)
    free[3] = False
    assert not flooded(free, (0, 0), (6, 6))
    free[3, 2] = True
    assert flooded(free, (0, 0), (6, 6))


# --- claims --------------------------------------------------------------------------------------


@pytest.fixture
def claimed(tmp_path: Path) -> Path:
    """A folder that claims that S and T are cut off, written without a search."""
    text = spec(f"start in S; reach T; {AVOID}", WALL)
    (tmp_path / "spec").mkdir()
    (tmp_path / "spec" / "wall.srg").write_text(text, encoding="utf-8")
    found = program(text)
    separation = disconnected(found, found.tasks["P"], abstract(found.workspaces["W"]))
    digest = result_files.spec_digest({"wall.srg": text.encode()})
    claim = ImpossibleClaim("P", "wall.srg", digest, None, (), separation)
    assert from_text(to_text(claim)) == claim
    (tmp_path / "certificate.json").write_text(to_text(claim), encoding="utf-8")
    return tmp_path


def test_a_true_claim_needs_no_solver(claimed: Path) -> None:
    report = verify_directory(claimed)
    assert (report.outcome, report.verdict) == (Outcome.VALID, "impossible")
    assert report.level == "validated"


def altered(**changes: object) -> Callable[[dict[str, Any]], None]:
    return lambda content: content["separation"].update(changes)


def without(cell: str) -> Callable[[dict[str, Any]], None]:
    return lambda content: content["separation"]["cells"].remove(cell)


FALSE: Mapping[str, tuple[Callable[[dict[str, Any]], None], str]] = {
    "no start": (altered(source="A"), "one effector into both regions"),
    "no target": (altered(target="F"), "one effector into both regions"),
    "of another effector": (altered(effector=2), "one effector into both regions"),
    "of no certain effector": (altered(effector=None), "one effector into both regions"),
    "what is not avoided": (altered(avoided=["Wall", "A"]), "does not avoid"),
    "another wall": (altered(avoided=["Block"]), "has an avoided cell"),
    "nothing avoided": (altered(avoided=[]), "touches one of the separation"),
    "the place to start": (without("S"), "meets `S` is missing"),
    "the place to end": (lambda c: c["separation"]["cells"].append("T"), "meets `T`"),
    "an avoided cell": (lambda c: c["separation"]["cells"].append("Wall"), "has an avoided cell"),
    "an unknown cell": (lambda c: c["separation"]["cells"].append("X"), "an unknown cell"),
    "one cell less": (without("F"), "is missing"),
    "no cells": (altered(cells=[]), "meets `S` is missing"),
    "a bound besides": (lambda c: c.update(modules=4), "about all robots"),
    "no separation": (lambda c: c.update(separation=None), "has no bound"),
}


@pytest.mark.parametrize("name", FALSE)
def test_a_false_claim(claimed: Path, name: str) -> None:
    change, reason = FALSE[name]
    result_files.alter(claimed, change, sign=True)
    report = verify_directory(claimed)
    assert report.outcome is Outcome.REFUTED
    assert reason in str(report.reason)


def test_a_wall_with_a_door_is_no_wall(claimed: Path) -> None:
    """The cells of the certificate are not believed, nor that they are cells of this spec."""
    result_files.alter_spec(
        claimed, "box [1, 2] x [-1, 4] m", "box [1, 2] x [-0.9, 4] m", sign=True
    )
    report = verify_directory(claimed)
    assert report.outcome is Outcome.REFUTED


def test_every_cell_counts(claimed: Path) -> None:
    content = json.loads((claimed / "certificate.json").read_text(encoding="utf-8"))
    found = program((claimed / "spec" / "wall.srg").read_text(encoding="utf-8"))
    task, cells = found.tasks["P"], abstract(found.workspaces["W"])
    separation = from_text(json.dumps(content))
    assert isinstance(separation, ImpossibleClaim)
    claim = separation.separation
    assert isinstance(claim, SeparationClaim)
    for name in claim.cells:
        fewer = replace(claim, cells=tuple(cell for cell in claim.cells if cell != name))
        assert misstated_separation(found, task, cells, fewer) is not None
