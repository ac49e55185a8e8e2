r"""Second-order terms in deviations from a path, bounded over the set of the deviations.

Let F(x, a, u) = (b - M a, d), which is zero along solutions with a = (v', s'), and let e and e_a be
how far a solution and its derivative are from the path p with defect rho. By Taylor's theorem

.. math::
    N(p)\,e_a = R(p)\,e + B\,d + \rho + \tfrac12 \bigl(z^T H_i(\xi)\,z\bigr)_i, \qquad z = (e, e_a),

where H_i is the Hessian of F_i somewhere between the path and the solution. Here N and R are taken
along the path alone; they do not depend on the set. The remainder is of second order. A box as its
bound would lose the dependence between the entries of e that feedback causes; so

.. math::
    e(t) \in P(t)\,G\,[-1, 1]^c \pm y, \qquad e_a = A e + N^{-1}(B d + \rho + \dots), \qquad
    z = V r, \quad |r_j| \le 1,

and the form is that of Q = V^T H V, whose diagonal terms each have one sign:

.. math::
    \tfrac12 r^T Q r \in \tfrac14 \sum_j Q_{jj} \pm \Bigl(\tfrac14 \sum_j |Q_{jj}|
        + \tfrac12 \sum_{j \ne k} |Q_{jk}|\Bigr).

The form acts like a disturbance with these forces (``a_priori.py``).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from flint import arb, arb_mat

from compiler.arrays import Array
from compiler.expressions.evaluators.balls import (
    SIGNS,
    absolute,
    beside,
    both_signs,
    column,
    diagonal,
    rows,
    stacked,
)
from solvers.verifier.proofs.a_priori import (
    Deviation,
    LinearPart,
    NearPath,
    input_slopes,
    linear_part,
)
from solvers.verifier.proofs.deviation_flow import Flow, flow
from solvers.verifier.proofs.disturbance_response import LinearSlice, linear_slices, response
from solvers.verifier.proofs.second_derivatives import Hessian, exact_matrix, hessians_about
from solvers.verifier.proofs.vector_field import VectorField
from solvers.verifier.proofs.zonotope import OrderLimits, Zonotope

SLICES = 4
"""The parts of a segment on which forms are bounded."""
ROUNDS = 6
LEAST_GAIN = 0.95
"""Bounds count as final once a round does not reduce them below this factor."""
KEPT = OrderLimits(12, 12, 60, 60)
"""The order of the set over which forms are bounded."""
BITS = 18
"""Forms are summed exactly in integers of this many bits; products of three fit into 64."""
LEAST = 2.0**-300
"""Smaller values are bounded by boxes."""
MOST_ENTRIES = 40
"""The most entries of z: no sum of integers then exceeds 64 bits."""


@dataclass(frozen=True, slots=True)
class Added:
    """What a set gains on a segment: a box, an image of the unit box, and a shift.

    ``reach`` bounds all of it at every instant; ``pull`` bounds the accelerations (n,) caused by
    second-order terms.
    """

    box: list[arb]
    steady: arb_mat | None
    shift: list[arb]
    reach: list[arb]
    pull: Sequence[arb] = ()


def added_by_forms(
    field: VectorField, states: Zonotope, near: NearPath, found: Deviation, degree: int
) -> tuple[Flow, Added] | None:
    """How a set moves on [0, H] if all deviations are within ``found.radii``; None if not known.

    Raises:
        ZeroDivisionError: M may be singular along the path.
        UncertainSignError: an absolute value is not smooth enough for this degree.
    """
    curvature = field.curvature
    if curvature is None or field.size + field.dofs > MOST_ENTRIES:
        return None
    linear = linear_part(field, near, [arb(0)] * field.size, degree)
    half = near.path.length / 2
    transition = flow(field, half, linear)
    slices = linear_slices(linear, half, SLICES)
    slopes = input_slopes(field, near, found.radii) if near.drive.is_disturbed else None
    # First for the box that no deviation leaves, at all times; then for tighter sets, slice by
    # slice.
    pull = (found.linear.rates * column(found.radii) + column(found.push)).entries()
    most = [*found.radii, *(item.upper() for item in pull[field.dofs : 2 * field.dofs])]
    parts = [_Columns.of(_Block.of(diagonal(most)))]
    over = [near.path.over]
    moving: list[_Block] = []
    forms: _Forms | None = None
    added = None
    for _ in range(ROUNDS):
        widths = [part.widths.entries() for part in parts]
        within = [[m.min(w) for m, w in zip(most, each, strict=True)] for each in widths]
        ranges = []
        for about, each, part in zip(over, within, parts, strict=True):
            hessians = hessians_about(field, curvature, near.drive, about, each)
            if hessians is None:
                return None
            ranges.append(_forms(hessians, part))
        closer = _hull(ranges)
        if forms is not None and not _smaller(closer, forms):
            break
        forms = closer
        added = _added(near, transition, linear, slices, slopes, forms)
        if not moving:
            times = [item.since for item in slices]
            over = [near.path.about(half + time.mid(), time.rad()) for time in times]
            small = states.reduced(KEPT).matrix
            for item in slices:
                places = transition.at(half + item.since) * small
                moving.append(_Block.of(stacked(places, _joints(field, item) * places)))
        parts = []
        for item, moved in zip(slices, moving, strict=True):
            own = _own_columns(field, item, near, slopes, forms, added.reach)
            parts.append(_Columns.of(moved, _Block.of(own)))
    return None if added is None else (transition, added)


def _joints(field: VectorField, part: LinearSlice) -> arb_mat:
    """The rows of A for the joints' accelerations."""
    return rows(part.lower, 0, field.dofs)


def _own_columns(
    field: VectorField,
    part: LinearSlice,
    near: NearPath,
    slopes: arb_mat | None,
    forms: _Forms,
    box: Sequence[arb],
) -> arb_mat:
    """The columns of V that are not images of the set's: a box of e, and the range of e_a - A e.

    The latter is the effect of disturbances and forces, as columns: an uncertain mass times
    accelerations is a part of the forces.
    """
    most = [abs(c) + r for c, r in zip(forms.centre, forms.radii, strict=True)]
    pushed = diagonal([(a + b).upper() for a, b in zip(most, near.defect, strict=True)])
    if slopes is not None:
        pushed = beside(pushed, slopes * diagonal(near.drive.disturbance))
    rest = rows(part.inertia.solve(pushed), 0, field.dofs)
    places = diagonal(box)
    none = arb_mat(field.size, rest.ncols(), [arb(0)] * (field.size * rest.ncols()))
    return stacked(beside(places, none), beside(_joints(field, part) * places, rest))


def _added(
    near: NearPath,
    transition: Flow,
    linear: LinearPart,
    slices: Sequence[LinearSlice],
    slopes: arb_mat | None,
    forms: _Forms,
) -> Added:
    """What a set gains by disturbances, by the path's defect, and by the forms."""
    height = len(forms.radii)
    residue = absolute(linear.inertia.solve(both_signs(column(near.defect))))
    bounds = [] if slopes is None else list(near.drive.disturbance)
    columns = [] if slopes is None else slopes.transpose().tolist()
    for i, radius in enumerate(forms.radii):
        if radius > 0:
            bounds.append(radius)
            columns.append([arb(int(i == j)) for j in range(height)])
    # The centre of the forms acts all the time, so it causes a shift.
    length, own = near.path.length, None
    centre = arb_mat([list(forms.centre)]).transpose()
    shift = response(centre, [arb(1)], length, linear, slices, residue)
    pushed, reach = shift.rest, shift.reach
    if columns:
        found = response(arb_mat(columns).transpose(), bounds, length, linear, slices, 0 * residue)
        own = found.columns
        pushed = [a + b for a, b in zip(pushed, found.rest, strict=True)]
        reach = [a + b for a, b in zip(reach, found.reach, strict=True)]
    box = transition.added(near.start, pushed)
    total = [(b + r).upper() for b, r in zip(box, reach, strict=True)]
    pull = absolute(linear.inertia.solve(both_signs(column(forms.radii)))).entries()
    dofs = len(box) - len(pull)
    return Added(box, own, shift.constant.entries(), total, pull[:dofs])


# --- The range of the forms -----------------------------------------------------------------------
#
# The variation of H is of third order and bounded by a box; for the midpoints, the sum of all
# |Q_jk| is computed in integers, to which V and H are rounded.


@dataclass(frozen=True, slots=True)
class _Block:
    """Columns of V: floats near them (N, c), and bounds of |V - near| 1, an entry per row."""

    near: Array
    slack: list[arb]

    @staticmethod
    def of(columns: arb_mat) -> _Block:
        """The midpoints, rounded to floats."""
        shape = columns.nrows(), columns.ncols()
        near = np.array([float(item) for item in columns.mid().entries()]).reshape(shape)
        # For factors in [-1, 1], a product's radius is the sum of the absolute values of its terms.
        spread = (columns - exact_matrix(near)) * column([SIGNS] * shape[1])
        return _Block(near, [item.abs_upper() for item in spread.entries()])


@dataclass(frozen=True, slots=True)
class _Columns:
    """V = S W + d: S = diag(``scales``), W = ``whole`` / 2^BITS in integers, |d| 1 <= ``rest``.

    ``widths`` are bounds of |V| 1, at most the scales, which are powers of two.
    """

    whole: Array
    scales: Array
    rest: arb_mat
    widths: arb_mat

    @staticmethod
    def of(*blocks: _Block) -> _Columns:
        """V, with its blocks side by side, as integers and the remainder."""
        middle = np.concatenate([block.near for block in blocks], axis=1)
        slack = [sum(each, arb(0)) for each in zip(*(b.slack for b in blocks), strict=True)]
        sums = np.abs(middle).sum(axis=1) + np.array([float(item) for item in slack])
        if not np.isfinite(sums).all():
            raise ZeroDivisionError("the set has no bounds")
        # Larger powers of two make all further computations exact.
        scales = 2.0 ** (np.ceil(np.log2(np.maximum(sums, LEAST))) + 1)
        whole = np.rint(middle / scales[:, None] * 2.0**BITS).astype(np.int64)
        units = [arb(scale) / 2**BITS for scale in scales.tolist()]
        half = arb(middle.shape[1]) / 2
        rest = [(s + unit * half).upper() for s, unit in zip(slack, units, strict=True)]
        most = np.abs(whole).sum(axis=1).tolist()
        widths = [unit * m + r for unit, m, r in zip(units, most, rest, strict=True)]
        return _Columns(whole, scales, column(rest), column([w.upper() for w in widths]))


@dataclass(frozen=True, slots=True)
class _Forms:
    """Balls c_i +- r_i of the forms, in the units of F."""

    centre: list[arb]
    radii: list[arb]


def _forms(hessians: Sequence[Hessian], part: _Columns) -> _Forms:
    """The range of half the forms of V r, |r_j| <= 1."""
    centre, radii = [], []
    across, widths = part.widths.transpose(), part.widths
    ratios = [w / arb(s) for w, s in zip(widths.entries(), part.scales.tolist(), strict=True)]
    share = sum(ratios, arb(0)).upper()
    for hessian in hessians:
        scaled = hessian.middle * part.scales[:, None] * part.scales[None, :]
        largest = float(np.abs(scaled).max(initial=0.0))
        size = exact_matrix(np.abs(hessian.middle))
        thick = (across * hessian.radii * widths)[0, 0] / 2
        if not LEAST < largest < 1 / LEAST:
            centre.append(arb(0))
            radii.append((thick + (across * size * widths)[0, 0] / 2).upper())
            continue
        scale = 2.0 ** (np.ceil(np.log2(largest)) + 1)
        whole = np.rint(scaled / scale * 2.0**BITS).astype(np.int64)
        product = part.whole.T @ (whole @ part.whole)
        diagonal = np.diagonal(product)
        total, own = int(np.abs(product).sum()), int(np.abs(diagonal).sum())
        unit = arb(scale) / 2 ** (3 * BITS)
        # H is off by at most half an integer, V r by at most ``rest``.
        off = arb(scale) / 2 ** (BITS + 2) * share**2 + (across * size * part.rest)[0, 0]
        centre.append(unit * int(diagonal.sum()) / 4)
        radii.append((unit * (2 * total - own) / 4 + thick + off).upper())
    return _Forms(centre, radii)


def range_of_forms(hessians: Sequence[arb_mat], columns: arb_mat) -> list[tuple[arb, arb]]:
    """Centres and radii of z^T H z / 2 for z = V r, |r_j| <= 1.

    Args:
        hessians: symmetric interval matrices H (N, N).
        columns: V (N, c), balls.
    """
    found = _forms([Hessian.of(hessian) for hessian in hessians], _Columns.of(_Block.of(columns)))
    return list(zip(found.centre, found.radii, strict=True))


def _smaller(forms: _Forms, than: _Forms) -> bool:
    pairs = list(zip(forms.radii, than.radii, strict=True))
    return all(bool(a <= b) for a, b in pairs) and any(bool(a < LEAST_GAIN * b) for a, b in pairs)


def _hull(parts: Sequence[_Forms]) -> _Forms:
    """Bounds that hold on all parts."""
    centre, radii = [], []
    for i in range(len(parts[0].centre)):
        balls = [part.centre[i] + SIGNS * part.radii[i] for part in parts]
        hull = balls[0]
        for other in balls[1:]:
            hull = hull.union(other)
        centre.append(hull.mid())
        radii.append(hull.rad().upper())
    return _Forms(centre, radii)
