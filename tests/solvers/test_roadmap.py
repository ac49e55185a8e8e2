"""Ways of a roadmap, checked by GEOS: the body is clear, the effector passes the cells in order."""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest
import shapely

from compiler.arrays import Array
from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.workspaces.polytope import polytope_of
from grammar_lang import ir
from solvers.trajectory.body_clearance import Avoidances, body_clearance
from solvers.trajectory.convex_set import convex_set
from solvers.trajectory.corridor import STRAY, Corridor
from solvers.trajectory.seed_motions import (
    JointPath,
    body_seeds,
    joint_paths,
    roadmap_motions,
    timed,
)
from tests.oracles.arms import ArmBuilder, effector_positions, frames_of
from tests.oracles.planar_bodies import bodies_of, depth
from tests.oracles.planes import box, box_rows, hull, row
from tests.oracles.tasks import task

CELLS = [((1, 2), (-2, 0)), ((0, 2), (0, 1)), ((-1, 1), (1, 2))]
"""From the right, around a tilted obstacle, to above the base."""
OBSTACLE = (("1.5", "0.9"), ("2.4", "1.5"), ("1.2", "2"), ("0.9", "1.5"))


def corridor(
    *lengths: object, obstacle: object = OBSTACLE, cells: object = None, given: bool = False
) -> Corridor:
    built = ArmBuilder()
    for length in lengths:
        built.revolute().link(length)
    numeric = NumericRobot(robot_graph(built.effector().model()))
    regions = (hull("O", "obstacle", *obstacle),)
    workspace = ir.Workspace("W", 2, box("bounds", "bounds", (-4, 4), (-4, 4)), regions)
    avoided = task(ir.Avoid(("O",), "body", Fraction(1, 50)))
    sets = tuple(convex_set(polytope_of(box_rows(*cell), 2)) for cell in cells or CELLS)
    n = len(lengths)
    limits = np.full(n, -np.pi), np.full(n, np.pi)
    clearance = body_clearance(Avoidances(numeric, workspace, avoided))
    return Corridor(numeric, np.zeros(0), 0, sets, clearance, limits, 2e-3, given)


def dense(q: Array) -> Array:
    """Poses a few milliradians apart."""
    parts = [np.linspace(a, b, 200) for a, b in pairwise(q)]
    return np.concatenate(parts)


def is_clear(where: Corridor, q: Array, least: float) -> bool:
    model = where.numeric.graph.model
    corners = [[Fraction(x) for x in corner] for corner in OBSTACLE]
    return all(depth(bodies_of(model, pose, np.zeros(0)), corners) > least for pose in q)


def cells_at(where: Corridor, q: Array, slack: float) -> list[list[int]]:
    """Per pose the cells that the effector is in, up to a distance."""
    shapes = [shapely.box(float(x[0]), float(y[0]), float(x[1]), float(y[1])) for x, y in CELLS]
    tips = [effector_positions(where.numeric.graph.model, pose, np.zeros(0))[0] for pose in q]
    return [
        [i for i, s in enumerate(shapes) if s.distance(shapely.Point(tip)) <= slack] for tip in tips
    ]


@pytest.mark.parametrize("lengths", [("1.3", "1.1"), ("0.9", "0.8", "0.7"), ("0.7",) * 4])
def test_ways_are_clear_and_pass_the_cells(lengths: tuple[str, ...]) -> None:
    where = corridor(*lengths)
    found = joint_paths(where, None, 3, 0)
    assert found
    for path in found:
        assert path.layers[0] == 0
        assert path.layers[-1] == 2
        assert np.all(np.diff(path.layers) >= 0)
        assert is_clear(where, dense(path.q), 0.0)
        visited = cells_at(where, dense(path.q), STRAY * where.extent * 1.5)
        assert all(visited)
        assert 0 in cells_at(where, path.q[:1], 1e-6)[0]
        assert 2 in cells_at(where, path.q[-1:], 1e-6)[0]


def test_the_same_seed_gives_the_same_ways() -> None:
    first, again, other = (
        joint_paths(corridor("0.9", "0.8", "0.7"), None, 2, seed) for seed in (3, 3, 4)
    )
    assert [p.q.tobytes() for p in first] == [p.q.tobytes() for p in again]
    assert [p.q.tobytes() for p in first] != [p.q.tobytes() for p in other]


def test_ways_end_in_different_branches() -> None:
    found = joint_paths(corridor("0.9", "0.8", "0.7"), None, 3, 0)
    ends = [path.q[-1] for path in found]
    assert len(ends) > 1
    for i, end in enumerate(ends):
        for other in ends[:i]:
            assert np.max(np.abs(np.sin((end - other) / 2))) > 0.1


def test_no_way_through_a_wall() -> None:
    """A rod of two metres about the base; the wall begins half a metre from it."""
    wall = (("0.5", "0.5"), ("3", "0.4"), ("3", "0.6"))
    assert joint_paths(corridor("1.1", "1", obstacle=wall), None, 1, 0) == []


def test_a_given_first_pose_is_kept() -> None:
    where = corridor("0.9", "0.8", "0.7", given=True)
    first = np.array([-1.1, 0.6, 0.3])
    assert 0 in cells_at(where, first[None], 0.0)[0]
    found = joint_paths(where, first, 1, 0)
    assert found[0].q[0] == pytest.approx(first)


def test_timed_motions_enter_the_cells_when_they_should() -> None:
    where, steps, entries = corridor("0.9", "0.8", "0.7"), 60, (0, 25, 40)
    (path,) = joint_paths(where, None, 1, 0)
    q = timed(where, path, entries, steps)
    assert q.shape == (steps + 1, 3)
    assert q[0] == pytest.approx(path.q[0])
    assert q[-1] == pytest.approx(path.q[-1])
    assert is_clear(where, q, 0.0)
    visited = cells_at(where, q, STRAY * where.extent)
    for cell, first, last in ((0, 0, 22), (1, 27, 37), (2, 42, 60)):
        assert all(cell in visited[sample] for sample in range(first, last + 1))
    # From rest to rest: the first and the last steps are short ones.
    steps_taken = np.linalg.norm(np.diff(q, axis=0), axis=1)
    assert max(steps_taken[0], steps_taken[-1]) < 0.4 * steps_taken.max()


def test_a_way_of_one_pose_stands_still() -> None:
    where = corridor("0.9", "0.8", "0.7")
    pose = np.array([[-1.1, 0.6, 0.3]])
    still = timed(where, JointPath(pose, np.zeros(1, dtype=np.int64)), (0, 2, 3), 5)
    assert still == pytest.approx(np.tile(pose, (6, 1)))


def test_an_arm_in_space() -> None:
    """About z and then twice about y; points of its links against the rows of a tilted block."""
    built = ArmBuilder(3).revolute().revolute(axis=1).link(1).revolute(axis=1).link("0.8")
    numeric = NumericRobot(robot_graph(built.effector().model()))
    rows = (
        row(1, 1, 1, "1.6"), row(-1, -1, -1, "-0.8"), row(1, -1, 0, "0.5"), row(-1, 1, 0, "0.7"),
        row(1, 1, -2, "1"), row(-1, -1, 2, "1.5"),
    )  # fmt: skip
    block = ir.Region("O", "obstacle", ir.Inequalities(rows))
    bounds = box("bounds", "bounds", (-3, 3), (-3, 3), (-3, 3))
    workspace = ir.Workspace("W", 3, bounds, (block,))
    avoided = task(ir.Avoid(("O",), "body", Fraction(0)))
    clearance = body_clearance(Avoidances(numeric, workspace, avoided))
    sides = [((1, 2), (-1, 0), (0, 1)), ((-1, 2), (-1, 2), (1, 2)), ((-1, 0), (1, 2), (0, 1))]
    cells = tuple(convex_set(polytope_of(box_rows(*side), 3)) for side in sides)
    limits = np.full(3, -np.pi), np.full(3, np.pi)
    where = Corridor(numeric, np.zeros(0), 0, cells, clearance, limits, 0.01)
    free = where.clear(where.drawn(np.random.default_rng(0)).q)
    assert 0.3 < free.mean() < 0.95  # the block is in the way
    found = joint_paths(where, None, 2, 0)
    assert found
    normals = np.array([[float(a) for a in one.normal] for one in rows])
    offsets = np.array([float(one.offset) for one in rows])
    model = numeric.graph.model
    for path in found:
        for pose in dense(path.q)[::4]:
            frames = frames_of(model, pose, np.zeros(0))
            ends = [frames[body.frame][1] for body in model.bodies] + [frames[-1][1]]
            points = np.concatenate([np.linspace(a, b, 50) for a, b in pairwise(ends)])
            assert np.all(np.max(points @ normals.T - offsets, axis=1) > 0)


# --- seeds --------------------------------------------------------------------------------------


def test_clear_motions_come_first_and_colliding_ones_are_left_out() -> None:
    where, entries, steps = corridor("1.3", "1.1"), (0, 25, 40), 60
    good = roadmap_motions(where, np.zeros((steps + 1, 2)), entries, 1, 0)[0]
    assert is_clear(where, good, 0.0)
    through = np.linspace(good[0], good[-1], steps + 1)
    through[steps // 2] = (np.pi / 4, 0.0)  # straight through the obstacle
    assert not is_clear(where, through, 0.0)
    astray = np.tile(good[0], (steps + 1, 1))  # clear, but it never gets to the last cell
    seeds = body_seeds(where, [through, astray, good], entries, 4, 0)
    assert [seed.tobytes() for seed in seeds] == [good.tobytes()]


def test_where_all_collide_a_roadmap_is_searched() -> None:
    where, entries, steps = corridor("1.3", "1.1"), (0, 25, 40), 60
    through = np.tile((np.pi / 4, 0.0), (steps + 1, 1))
    seeds = body_seeds(where, [through], entries, 4, 0)
    assert all(is_clear(where, seed, 0.0) for seed in seeds)


def test_where_nothing_is_found_the_least_colliding_motions_are_kept() -> None:
    """The arm is stretched, below a wall or into it, and never in the last cell."""
    wall = (("0.5", "0.5"), ("3", "0.4"), ("3", "0.6"))
    where = corridor("1.1", "1", obstacle=wall)
    moves = [np.tile((angle, 0.0), (5, 1)) for angle in (0.25, 0.05, 0.18)]
    seeds = body_seeds(where, moves, (0, 2, 3), 4, 0)
    assert [seed[0, 0] for seed in seeds] == [0.05, 0.18]


def test_redundant_arms_get_motions_of_the_roadmap_as_well() -> None:
    where, entries, steps = corridor("0.9", "0.8", "0.7"), (0, 25, 40), 60
    good = roadmap_motions(where, np.zeros((steps + 1, 3)), entries, 1, 5)[0]
    seeds = body_seeds(where, [good], entries, 4, 0)
    assert len(seeds) > 1
    assert seeds[0] is good
