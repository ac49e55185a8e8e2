r"""Mass, first and second moment of rigid bodies: these add when bodies are joined rigidly.

.. math:: m = \int dm, \quad h = \int x\,dm, \quad S = \int x x^T dm, \quad J = tr(S) 1 - S

Sources: Wensing, Kim & Slotine 2018 (a body is physical if and only if its S is positive
semidefinite); Jacobi 1846 (principal axes by successive rotations, each of which makes one pair of
entries zero).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from flint import arb, arb_mat, ctx

from compiler.expressions.evaluators.balls import ball
from compiler.rigid_links.ball_pose import Pose, column, doubles, identity, nearest, unit
from compiler.robots.robot import Body, PointBody, RodBody, SolidBody

BLEND = Fraction(1, 100)
"""The isotropic fraction of those moments of a planar link that its motion does not depend on."""
RELATIVE = Fraction(1, 10**14)
"""Moments below this fraction of their sum are too small for eigenvalues in doubles."""


@dataclass(frozen=True, slots=True)
class Inertial:
    """Mass, centre of mass, and the inertia tensor (xx, yy, zz, xy, xz, yz) about it."""

    mass: float
    com: tuple[float, float, float]
    inertia: tuple[float, float, float, float, float, float]


@dataclass(frozen=True, slots=True)
class MassMoments:
    """Mass, first moment (3, 1) and second moment (3, 3) about the origin of a frame."""

    mass: arb
    first: arb_mat
    second: arb_mat

    def __add__(self, other: MassMoments) -> MassMoments:
        return MassMoments(
            self.mass + other.mass, self.first + other.first, self.second + other.second
        )

    def __sub__(self, other: MassMoments) -> MassMoments:
        return MassMoments(
            self.mass - other.mass, self.first - other.first, self.second - other.second
        )

    def times(self, factor: arb) -> MassMoments:
        """The moments after multiplying all densities by ``factor``."""
        return MassMoments(self.mass * factor, self.first * factor, self.second * factor)

    @property
    def massless(self) -> bool:
        """Whether the mass and all moments are zero."""
        rests = [self.mass, *self.first.entries(), *self.second.entries()]
        return all(bool(item == 0) for item in rests)

    @property
    def com(self) -> arb_mat:
        """The centre of mass, shape (3, 1)."""
        return self.first * (1 / self.mass)

    @property
    def central(self) -> arb_mat:
        """The second moment about the centre of mass, shape (3, 3)."""
        return self.second - self.first * self.first.transpose() * (1 / self.mass)


def none() -> MassMoments:
    """The moments of no mass."""
    return MassMoments(arb(0), column([0, 0, 0]), identity() * 0)


def about(mass: arb, com: arb_mat, central: arb_mat) -> MassMoments:
    """The moments of a mass with a given centre and second moment about that centre."""
    return MassMoments(mass, com * mass, central + com * com.transpose() * mass)


def body_moments(body: Body, scalars: Sequence[arb], frame: Pose) -> MassMoments:
    """The mass, first moment (3, 1) and second moment (3, 3) of a body whose frame has this pose.

    A solid in the plane is a thin plate.
    """
    match body:
        case RodBody(_, axis, sign, length, density, _):
            extent, mass = scalars[length], scalars[density] * scalars[length]
            along = frame.rotation * unit(axis, sign)
            central = along * along.transpose() * (mass * extent**2 / 12)
            return about(mass, frame.origin + along * (extent / 2), central)
        case PointBody(_, mass_scalar):
            return about(scalars[mass_scalar], frame.origin, identity() * 0)
        case SolidBody(_, mass_scalar, com, inertia):
            local = _second_moment([scalars[i] for i in inertia])
            central = frame.rotation * local * frame.rotation.transpose()
            centre = frame.point(column([scalars[i] for i in com]))
            return about(scalars[mass_scalar], centre, central)


def _second_moment(inertia: Sequence[arb]) -> arb_mat:
    """S from J: one number in the plane; xx, yy, zz, xy, xz, yz in space."""
    if len(inertia) == 1:
        half = inertia[0] / 2
        return arb_mat([[half, 0, 0], [0, half, 0], [0, 0, 0]])
    xx, yy, zz, xy, xz, yz = inertia
    tensor = arb_mat([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    return identity() * ((xx + yy + zz) / 2) - tensor


def token(least: Fraction, place: arb_mat) -> MassMoments:
    """The moments given to a massless frame where every body must have mass: twice ``least``.

    ``place`` (3, 1) is the position of its centre of mass.
    """
    return about(ball(least), place, identity() * ball(least))


def inertial(moments: MassMoments, dimension: int, least: Fraction) -> Inertial:
    """The numbers of a link as simulators need them: all principal moments at least ``least``.

    A link without mass gets a ``token``; ``legal`` describes all other changes.

    Raises:
        ValueError: no body has these moments, or they have no definite values.
    """
    if moments.massless:
        moments = token(least, column([0, 0, 0]))
    if not moments.mass > 0:
        raise ValueError("a link has a moment of inertia and no mass")
    if not _definite(moments.central + identity() * _margin(moments, least)):
        raise ValueError("no body has such an inertia: the triangle inequality fails")
    return _rounded(legal(moments, dimension, least))


def legal(moments: MassMoments, dimension: int, least: Fraction) -> MassMoments:
    """The moments, changed as little as simulators require.

    Afterwards all principal moments of inertia are at least ``least`` and satisfy the triangle
    inequality, both with a margin of ``RELATIVE`` times their sum. In space only moments that
    violate this are raised. In the plane the moment about z is raised if it is too small; otherwise
    only moments that affect no planar motion are changed.
    """
    central = moments.central
    changed = _plate(central, least) if dimension == 2 else _thickened(central, least)
    return about(moments.mass, moments.com, changed)


def _margin(moments: MassMoments, least: Fraction) -> arb:
    """The amount by which rounding and tokens may have reduced a second moment."""
    relative, absolute = ball(RELATIVE) * _trace(moments.central), ball(least) / 2
    return relative if relative > absolute else absolute


def _plate(central: arb_mat, least: Fraction) -> arb_mat:
    """The moments of a thick plate with the same moment of inertia about z."""
    total = central[0, 0] + central[1, 1]
    if not total > ball(least):
        return identity() * (ball(least) / 2)
    part, keep = ball(BLEND) * total / 2, ball(1 - BLEND)
    thickness = part if part > ball(least) else ball(least)
    xx, yy, xy = keep * central[0, 0] + part, keep * central[1, 1] + part, keep * central[0, 1]
    plate = arb_mat([[xx, xy, 0], [xy, yy, 0], [0, 0, thickness]])
    if not _definite(plate):
        plate = arb_mat([[total / 2, 0, 0], [0, total / 2, 0], [0, 0, thickness]])
    return plate


def _thickened(central: arb_mat, least: Fraction) -> arb_mat:
    """A second moment whose moments of inertia are large enough and satisfy the inequality."""
    trace = _trace(central)
    moments, axes = principal_axes(identity() * trace - central)
    relative, absolute = ball(RELATIVE) * trace * 2, ball(least)
    margin = relative if relative > absolute else absolute
    raised = [_larger(moment, margin) for moment in moments]
    first, second, third = sorted(range(3), key=lambda i: float(raised[i].mid()))
    short = raised[third] - raised[second] + _larger(relative, arb(0)) - raised[first]
    raised[first] = raised[first] + _larger(short, arb(0))
    change = identity() * 0
    for axis, old, new in zip(axes, moments, raised, strict=True):
        change += axis * axis.transpose() * (new - old)
    return central + identity() * (_trace(change) / 2) - change


def _larger(value: arb, other: arb) -> arb:
    """The larger of two numbers, or the first if their order is not certain."""
    return other if other > value else value


def _trace(matrix: arb_mat) -> arb:
    return matrix[0, 0] + matrix[1, 1] + matrix[2, 2]


def _definite(matrix: arb_mat) -> bool:
    """Whether a symmetric matrix is certainly positive definite (Sylvester's criterion)."""
    minor = matrix[0, 0] * matrix[1, 1] - matrix[0, 1] * matrix[1, 0]
    return bool(matrix[0, 0] > 0 and minor > 0 and matrix.det() > 0)


def _rounded(moments: MassMoments) -> Inertial:
    central = moments.central
    tensor = identity() * _trace(central) - central
    xx, yy, zz, xy, xz, yz = (
        nearest(tensor[i, j]) for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
    )
    return Inertial(nearest(moments.mass), doubles(moments.com), (xx, yy, zz, xy, xz, yz))


PAIRS = ((0, 1), (0, 2), (1, 2))
MOST_SWEEPS = 50
"""Convergence is quadratic: far fewer sweeps are needed at any precision."""


def principal_axes(tensor: arb_mat) -> tuple[list[arb], list[arb_mat]]:
    """Three moments and three orthonormal axes (3, 1), both to nearly the working precision.

    ``tensor`` is symmetric, shape (3, 3). Each moment is that of the exact tensor about its axis.
    If the tensor is diagonal, the axes are exactly those of the frame.
    """
    work, turned = _middle(tensor), identity()
    size = sum((abs(item) for item in work.entries()), arb(0))
    small = size * arb(2) ** (-(ctx.prec - 16))
    for _ in range(MOST_SWEEPS):
        left = [(i, j) for i, j in PAIRS if abs(work[i, j]) > small]
        if not left:
            break
        for i, j in left:
            turn = _rotation(work, i, j)
            work = _middle(turn.transpose() * work * turn)
            turned = _middle(turned * turn)
    axes = [arb_mat([[turned[i, k]] for i in range(3)]) for k in range(3)]
    moments = [(axis.transpose() * tensor * axis)[0, 0] for axis in axes]
    return moments, axes


def _rotation(work: arb_mat, i: int, j: int) -> arb_mat:
    """The rotation by the smaller angle that makes the entry (i, j) zero."""
    half = (work[j, j] - work[i, i]) / 2
    size = abs(half) + (half**2 + work[i, j] ** 2).sqrt()
    tangent = work[i, j] / size if half >= 0 else -work[i, j] / size
    cosine = 1 / (1 + tangent**2).sqrt()
    sine = tangent * cosine
    turn = identity()
    turn[i, i], turn[j, j], turn[i, j], turn[j, i] = cosine, cosine, sine, -sine
    return turn


def _middle(matrix: arb_mat) -> arb_mat:
    """The matrix without its radii, which would only grow."""
    return arb_mat([[matrix[i, j].mid() for j in range(3)] for i in range(3)])
