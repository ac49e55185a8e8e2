r"""Mass, first and second moment of rigid bodies: what adds when bodies are joined rigidly.

.. math:: m = \int dm, \quad h = \int x\,dm, \quad S = \int x x^T dm, \quad J = tr(S) 1 - S

Source: Wensing, Kim & Slotine 2018 (a body is physical if and only if its S is not negative).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from flint import arb, arb_mat

from compiler.arithmetic.balls import ball
from compiler.rigid_links.ball_pose import Pose, column, doubles, identity, nearest, unit
from compiler.robots.robot import Body, PointBody, RodBody, SolidBody

BLEND = Fraction(1, 100)
"""Of the moments of a planar link that its motion does not depend on, so much is isotropic."""
RELATIVE = Fraction(1, 10**12)
"""Second moments below this part of their sum are too small for eigenvalues in doubles."""


@dataclass(frozen=True, slots=True)
class Inertial:
    """Mass, centre of mass, and (xx, yy, zz, xy, xz, yz) of the inertia tensor about it."""

    mass: float
    com: tuple[float, float, float]
    inertia: tuple[float, float, float, float, float, float]


@dataclass(frozen=True, slots=True)
class MassMoments:
    """Mass, first moment (3, 1) and second moment (3, 3) about the origin of some frame."""

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

    @property
    def massless(self) -> bool:
        """Whether there is nothing at all, neither mass nor moments of it."""
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
    """No mass."""
    return MassMoments(arb(0), column([0, 0, 0]), identity() * 0)


def about(mass: arb, com: arb_mat, central: arb_mat) -> MassMoments:
    """The moments of a mass with a centre and a second moment about it."""
    return MassMoments(mass, com * mass, central + com * com.transpose() * mass)


def body_moments(body: Body, scalars: Sequence[arb], frame: Pose) -> MassMoments:
    """The moments of a body whose frame has this pose; a solid in the plane is a thin plate."""
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
    """What a frame without mass is given where every body must have some: twice ``least``.

    ``place`` (3, 1) is where its centre of mass is.
    """
    return about(ball(least), place, identity() * ball(least))


def physical(moments: MassMoments, dimension: int, least: Fraction) -> bool:
    """Whether mass and moments are large enough to be left as far as motion depends on them."""
    if not moments.mass > ball(least):
        return False
    central = moments.central
    if dimension == 2:
        large = central[0, 0] + central[1, 1] > ball(least)
        return bool(large) and _definite(_plate(central, least))
    return not _thin(central, least)


def inertial(moments: MassMoments, dimension: int, least: Fraction) -> Inertial:
    """The numbers of a link as simulators want them: all principal moments at least ``least``.

    What lacks mass gets a ``token``.  In the plane only the moments that no planar motion
    depends on are changed, unless the one about z is too small.  In space what is too thin is
    thickened by ``least`` in all directions, else nothing changes.

    Raises:
        ValueError: no body has these moments, or they have no definite values.
    """
    if moments.massless:
        moments = token(least, column([0, 0, 0]))
    if not moments.mass > 0:
        raise ValueError("a link has a moment of inertia and no mass")
    central = moments.central
    central = _plate(central, least) if dimension == 2 else _thickened(central, least)
    if not _definite(central):
        raise ValueError("no body has such an inertia: the triangle inequality fails")
    return _rounded(moments.mass, moments.com, central)


def _plate(central: arb_mat, least: Fraction) -> arb_mat:
    """Moments of a thick plate with the same moment of inertia about z."""
    total = central[0, 0] + central[1, 1]
    if not total > ball(least):
        return identity() * (ball(least) / 2)
    part, keep = ball(BLEND) * total / 2, ball(1 - BLEND)
    thickness = part if part > ball(least) else ball(least)
    xx, yy, xy = keep * central[0, 0] + part, keep * central[1, 1] + part, keep * central[0, 1]
    return arb_mat([[xx, xy, 0], [xy, yy, 0], [0, 0, thickness]])


def _thickened(central: arb_mat, least: Fraction) -> arb_mat:
    thin = _thin(central, least)
    return central + identity() * _floor(central, least) if thin else central


def _thin(central: arb_mat, least: Fraction) -> bool:
    return not _definite(central - identity() * _floor(central, least))


def _floor(central: arb_mat, least: Fraction) -> arb:
    """Half the least principal moment of inertia."""
    relative = ball(RELATIVE) * (central[0, 0] + central[1, 1] + central[2, 2])
    absolute = ball(least) / 2
    return relative if relative > absolute else absolute


def _definite(matrix: arb_mat) -> bool:
    """Whether a symmetric matrix is certainly positive definite (Sylvester's criterion)."""
    minor = matrix[0, 0] * matrix[1, 1] - matrix[0, 1] * matrix[1, 0]
    return bool(matrix[0, 0] > 0 and minor > 0 and matrix.det() > 0)


def _rounded(mass: arb, com: arb_mat, central: arb_mat) -> Inertial:
    trace = central[0, 0] + central[1, 1] + central[2, 2]
    tensor = identity() * trace - central
    xx, yy, zz, xy, xz, yz = (
        nearest(tensor[i, j]) for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
    )
    return Inertial(nearest(mass), doubles(com), (xx, yy, zz, xy, xz, yz))
