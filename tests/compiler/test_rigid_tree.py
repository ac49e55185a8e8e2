"""Links of robots and their moments, against sums over small pieces of matter and by hand."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
import trimesh

import srgc
from compiler.arrays import Array
from compiler.expressions.evaluators.balls import ball, working_precision
from compiler.expressions.scalars import Constant
from compiler.rigid_links.ball_pose import WORLD_POSE, doubles
from compiler.rigid_links.mass_moments import Inertial, inertial, token
from compiler.rigid_links.rigid_tree import PRECISION, RigidTreeError, axis_of, rigid_tree
from compiler.robots.robot import WORLD, RobotModel, SolidBody
from tests.conftest import ROOT
from tests.oracles.robots import Builder, interval

TINY = Fraction(1, 10**9)


def link_inertial(model: RobotModel, number: int, least: Fraction = TINY) -> Inertial:
    with working_precision(PRECISION):
        return inertial(rigid_tree(model, ()).links[number].moments, model.dimension, least)


def tensor(found: Inertial) -> Array:
    xx, yy, zz, xy, xz, yz = found.inertia
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def of_points(masses: Array, points: Array) -> tuple[float, Array, Array]:
    """Mass, com and inertia tensor about the com of point masses."""
    com = masses @ points / masses.sum()
    moment = np.zeros((3, 3))
    for mass, (x, y, z) in zip(masses, points - com, strict=True):
        cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
        moment -= mass * cross @ cross
    return float(masses.sum()), com, moment


def simpson(start: Array, end: Array, mass: float) -> tuple[list[float], list[Array]]:
    """Three point masses with the moments of a rod, up to the second."""
    return [mass / 6, 2 * mass / 3, mass / 6], [start, (start + end) / 2, end]


def test_bodies_on_one_link_are_summed_in_its_frame() -> None:
    builder = Builder(3)
    joint = builder.joint(builder.move(WORLD, "y", builder.number(5)), "x")
    elbow = builder.link(joint, builder.number(2), "-z", density=3)
    builder.rod(elbow, "y", builder.number(1), density=4)
    builder.point(builder.turn(elbow, "x", builder.number(1)), builder.number(7))
    found = link_inertial(builder.build(), 1)
    masses, points = simpson(np.zeros(3), np.array([0, 0, -2]), 6)
    more, others = simpson(np.array([0, 0, -2]), np.array([0, 1, -2]), 4)
    pieces = np.array([*masses, *more, 7]), np.array([*points, *others, [0, 0, -2]])
    mass, com, expected = of_points(*pieces)
    assert found.mass == mass
    np.testing.assert_allclose(found.com, com, rtol=1e-15)
    # All of it lies in the plane yz: the moment about x is the sum of the others, but for rounding.
    np.testing.assert_allclose(tensor(found), expected, rtol=0, atol=1e-12)


def test_a_solid_is_turned_with_its_frame_and_not_changed() -> None:
    builder = Builder(3)
    frame = builder.turn(builder.joint(WORLD), "z", builder.number(Fraction(1, 3)))
    frame = builder.turn(frame, "y", builder.number(-2))
    builder.solid(frame, 2, (1, -1, 3), (4, 5, 6, Fraction(1, 2), Fraction(-1, 3), Fraction(1, 4)))
    found = link_inertial(builder.build(), 1)
    c, s = np.cos(1 / 3), np.sin(1 / 3)
    about_z = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    c, s = np.cos(-2), np.sin(-2)
    turn = about_z @ np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])
    local = np.array([[4, 1 / 2, -1 / 3], [1 / 2, 5, 1 / 4], [-1 / 3, 1 / 4, 6]])
    np.testing.assert_allclose(tensor(found), turn @ local @ turn.T, rtol=0, atol=1e-14)
    np.testing.assert_allclose(found.com, turn @ [1, -1, 3], rtol=0, atol=1e-14)
    assert isinstance(builder.bodies[0], SolidBody)


@pytest.mark.parametrize("dimension", [2, 3])
def test_every_link_has_moments_that_some_body_has(dimension: int) -> None:
    """Single rods and points are the worst: each principal moment is at least the least."""
    builder = Builder(dimension)
    first = builder.joint(WORLD)
    builder.rod(builder.turn(first, "z", builder.number(Fraction(1, 3))), "x", builder.number(3))
    second = builder.joint(builder.move(first, "x", builder.number(1)))
    builder.point(second, builder.number(2))
    third = builder.joint(second, "x", "prismatic")
    builder.rod(third, "y", builder.number(Fraction(1, 1000)), Fraction(1, 1000))
    builder.joint(third, "y", "prismatic")
    for number in range(5):
        found = link_inertial(builder.build(), number)
        a, b, c = np.linalg.eigvalsh(tensor(found))
        assert found.mass >= 1e-9
        assert a >= 1e-9 * (1 - 1e-6)
        assert a + b > c
        if number == 1:
            assert found.inertia[2] == pytest.approx(27 / 12, rel=1e-15)


@pytest.mark.parametrize("least", [TINY, Fraction(1, 10**12)])
def test_of_a_thin_rod_only_the_moment_about_itself_is_raised(least: Fraction) -> None:
    """0.5 g, 1 cm long: m l^2 / 12 across."""
    builder = Builder(3)
    frame = builder.turn(builder.joint(WORLD), "z", builder.number(Fraction(1, 3)))
    frame = builder.turn(frame, "y", builder.number(-2))
    builder.rod(frame, "x", builder.number(Fraction(1, 100)), Fraction(1, 20))
    found = tensor(link_inertial(builder.build(), 1, least))
    across = 5e-4 * 1e-4 / 12
    along = np.array([np.cos(-2) * np.cos(1 / 3), np.cos(-2) * np.sin(1 / 3), -np.sin(-2)])
    expected = across * (np.eye(3) - np.outer(along, along)) + float(least) * np.outer(along, along)
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-13 * across)


@pytest.mark.parametrize(
    ("moments", "expected"),
    [
        ((3, 4, 5), (3, 4, 5)),
        ((2, 1, 3), (2, 1, 3)),  # a lamina
        ((0.5, 4, 4), (1, 4, 4)),
        ((0.25, 4, 4.25), (1, 4, 4.25)),
        ((0.5, 0.75, 1.25), (1, 1, 1.25)),
        ((0.5, 0.5, 0.5), (1, 1, 1)),
    ],
)
def test_only_principal_moments_below_the_least_are_raised(
    moments: tuple[float, ...], expected: tuple[float, ...]
) -> None:
    """In units of the least, about axes of a frame that is turned about two others."""
    turn = np.linalg.qr(np.array([[1, 2, 3], [-2, 1, 1], [0, 1, -4]]))[0]
    given = turn @ np.diag(moments) @ turn.T
    places = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
    builder = Builder(3)
    # Doubles are rounded; half an ulp more about each axis keeps the triangle inequality.
    entries = [Fraction(float(given[place])) for place in places]
    entries[:3] = [entry + Fraction(1, 10**15) for entry in entries[:3]]
    builder.solid(builder.joint(WORLD), 2, (1, 2, 3), [entry * TINY for entry in entries])
    found = tensor(link_inertial(builder.build(), 1)) / float(TINY)
    np.testing.assert_allclose(found, turn @ np.diag(expected) @ turn.T, rtol=0, atol=1e-12)


def test_an_inertia_against_the_triangle_inequality_is_refused() -> None:
    builder = Builder(3)
    builder.solid(builder.joint(WORLD), 1, (0, 0, 0), (1, 1, 3, 0, 0, 0))
    with pytest.raises(ValueError, match="triangle inequality"):
        link_inertial(builder.build(), 1)


def test_an_inertia_without_mass_is_refused_and_nothing_has_no_shape() -> None:
    builder = Builder(2)
    builder.solid(builder.joint(WORLD), 0, (0, 0, 0), [1])
    builder.point(builder.joint(WORLD), builder.number(0))
    builder.rod(builder.joint(WORLD), "x", builder.number(0))
    model = builder.build()
    assert [(each.looks, each.collisions) for each in rigid_tree(model, ()).links] == [((), ())] * 4
    with pytest.raises(ValueError, match="no mass"):
        link_inertial(model, 1)
    for number in (2, 3):
        assert link_inertial(model, number).mass == 1e-9


def test_a_token_is_left_as_it_is() -> None:
    with working_precision(PRECISION):
        for dimension in (2, 3):
            found = inertial(token(TINY, WORLD_POSE.origin), dimension, TINY)
            assert found == Inertial(1e-9, (0, 0, 0), (2e-9, 2e-9, 2e-9, 0, 0, 0))


def test_joints_and_effectors_are_placed_in_their_links() -> None:
    builder = Builder(3)
    base = builder.move(WORLD, "z", builder.number(1))
    first = builder.joint(base, "-y", range_=interval(-1, 2), rate=interval(-3, 4))
    builder.effector(builder.move(first, "x", builder.number(Fraction(1, 4))))
    branch = builder.turn(builder.move(first, "x", builder.number(2)), "y", builder.number(1))
    builder.joint(branch, "z", "prismatic")
    builder.joint(builder.move(base, "y", builder.number(3)), "x")
    builder.effector(WORLD)
    tree = rigid_tree(builder.build(), ())
    joints = [joint for _, joint in tree.carried()]
    assert [joint.parent for joint in joints] == [0, 1, 0]
    assert tree.children() == [[1, 3], [2], [], []]
    assert [joint.kind for joint in joints] == ["revolute", "prismatic", "revolute"]
    assert [axis_of(joint) for joint in joints] == [(0, -1, 0), (0, 0, 1), (1, 0, 0)]
    with working_precision(PRECISION):
        origins = [doubles(joint.origin.origin) for joint in joints]
        assert origins == [(0, 0, 1), (2, 0, 0), (0, 3, 1)]
        assert joints[1].origin.roll_pitch_yaw() == (0, 1, 0)
        assert doubles(tree.effectors[0].pose.origin) == (0.25, 0, 0)
    assert [frame.link for frame in tree.effectors] == [1, 0]
    assert (joints[0].range, joints[0].rate) == ((-1, 2), (-3, 4))
    assert (joints[1].range, joints[1].rate) == (None, None)


def test_parameters_are_read_exactly() -> None:
    builder = Builder()
    length = builder.parameter()
    builder.rod(builder.joint(WORLD), "x", length, density=Fraction(1, 3))
    tree = rigid_tree(builder.build(), (Fraction(3, 10),))
    with working_precision(PRECISION):
        exact = tree.links[1].moments.mass - ball(Fraction(1, 10))
        assert exact.contains(0)
        assert exact.rad() < 1e-70


def test_a_coordinate_that_moves_two_frames_has_two_links() -> None:
    """An elbow that turns as the shoulder does, and another joint at the elbow."""
    builder = Builder()
    first = builder.joint(WORLD)
    tip = builder.link(first, builder.number(2))
    other = builder.joint(tip)
    builder.point(other, builder.number(5))
    builder.frames.append(type(builder.frames[first])(tip, builder.frames[first].step))
    builder.point(len(builder.frames) - 1, builder.number(3))
    tree = rigid_tree(builder.build(), ())
    assert tree.coupled == 0
    carried = [(link, joint.dof, joint.parent) for link, joint in tree.carried()]
    assert carried == [(1, 0, 0), (3, 0, 1), (2, 1, 1)]
    with working_precision(PRECISION):
        assert [link.moments.mass for link in tree.links] == [0, 2, 5, 3]
        assert [doubles(joint.origin.origin) for _, joint in tree.carried()] == [
            (0, 0, 0), (2, 0, 0), (2, 0, 0),
        ]  # fmt: skip


def test_a_frame_that_is_given_twice_is_one_link() -> None:
    builder = Builder()
    first = builder.joint(WORLD)
    builder.point(first, builder.number(5))
    builder.frames.append(builder.frames[first])
    builder.point(first + 1, builder.number(3))
    tree = rigid_tree(builder.build(), ())
    assert tree.coupled is None
    with working_precision(PRECISION):
        assert [link.moments.mass for link in tree.links] == [0, 8]


def test_a_coordinate_of_no_joint_is_refused() -> None:
    builder = Builder()
    builder.joint(WORLD)
    del builder.frames[1:]
    with pytest.raises(RigidTreeError, match="freedom 1 moves nothing"):
        rigid_tree(builder.build(), ())


def test_a_length_without_a_value_is_refused() -> None:
    builder = Builder()
    root = builder.table.unary("sqrt", builder.table.constant(Fraction(-1)))
    assert builder.table.nodes[root] != Constant(Fraction(1))
    builder.rod(builder.joint(WORLD), "x", root)
    with pytest.raises(RigidTreeError, match="no value"):
        rigid_tree(builder.build(), ())


def test_the_quill_and_the_flange_of_the_scara_are_cylinders() -> None:
    """The tensor of a cylinder of so long an axis, from the mesh library trimesh."""
    program = srgc.load(ROOT / "specs" / "scara_place.srg")
    (word,) = srgc.words(program, limit=2)
    model = srgc.robot(program, word).chosen.model
    last = len(rigid_tree(model, ()).links) - 1
    for number, mass, radius, length in ((last - 1, 1, 0.01, 0.266), (last, 0.5, 0.025, 0.03)):
        solid = trimesh.primitives.Cylinder(radius, length)
        due = mass / solid.volume * solid.moment_inertia
        np.testing.assert_allclose(tensor(link_inertial(model, number)), due, atol=1e-8)
