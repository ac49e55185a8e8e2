r"""A controller that is a network of linear layers and ReLUs, and affine enclosures of it.

On an interval :math:`[l, h]` with l < 0 < h, and for any slope s in [0, 1],

.. math:: \max(x, 0) \in s\,x + [0,\ \max(-s\,l,\ (1 - s)\,h)] .

With one such s per neuron, s = h / (h - l), the network is u = K x + c + E r with |r_j| <= 1 on a
zonotope of x: a feedback law with a gain, and errors that are generators.

Source: Singh, Gehr, Mirman, Pueschel & Vechev, *Fast and effective robustness certification*
(2018), the abstract domain DeepZ.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import pairwise
from pathlib import Path

import numpy as np
from flint import arb, arb_mat

from compiler.arrays import Array
from compiler.expressions.evaluators.balls import absolute, ball, column_of_ones
from solvers.verifier.proofs.zonotope import Zonotope


@dataclass(frozen=True, slots=True)
class Layer:
    """x -> W x + b, exactly: the rows of W, and b."""

    weights: tuple[tuple[Fraction, ...], ...]
    offsets: tuple[Fraction, ...]


@dataclass(frozen=True, slots=True)
class AffineEnclosure:
    """u = ``gain`` x + ``offset`` + ``errors`` r, |r_j| <= 1, for all x of a set.

    Shapes (m, n), (m, 1) and (m, c), of balls; ``errors`` is None where there are none.
    """

    gain: arb_mat
    offset: arb_mat
    errors: arb_mat | None


@dataclass(frozen=True)
class ReluNetwork:
    """Layers with a ReLU after each but the last."""

    layers: tuple[Layer, ...]

    @cached_property
    def _floats(self) -> list[tuple[Array, Array]]:
        return [
            (np.array(layer.weights, dtype=float), np.array(layer.offsets, dtype=float))
            for layer in self.layers
        ]

    def __call__(self, x: Array) -> Array:
        """Outputs (m,), or (starts, m), in floats."""
        for number, (weights, offsets) in enumerate(self._floats):
            x = x @ weights.T + offsets
            if number < len(self.layers) - 1:
                x = np.maximum(x, 0.0)
        return x

    def over(self, states: Zonotope) -> AffineEnclosure:
        """An enclosure for all states of a set, of which the network reads the first entries."""
        size = len(self.layers[0].weights[0])
        seen = states.first(size)
        centre = arb_mat([[x] for x in seen.middle])
        found: AffineEnclosure | None = None
        for number, layer in enumerate(self.layers):
            found = _linear(layer, found)
            if number < len(self.layers) - 1:
                found = _relu(found, seen, centre)
        assert found is not None
        return found


def read_network(path: Path) -> ReluNetwork:
    """A network in the text format NNet, without the normalisation of its inputs and outputs.

    After comments a line of counts, one of the layers' sizes, and five about ranges; then the rows
    of W and the entries of b of each layer, a line each.

    Raises:
        ValueError: there are not as many numbers as the sizes say.
    """
    lines = [line for line in path.read_text(encoding="utf-8").splitlines() if line.strip()]
    rows = [_numbers(line) for line in lines if not line.startswith("//")]
    count, rest = int(rows[0][0]), rows[7:]
    sizes = [int(x) for x in rows[1][: count + 1]]
    layers = []
    for before, after in pairwise(sizes):
        weights, offsets, rest = rest[:after], rest[after : 2 * after], rest[2 * after :]
        if len(offsets) < after or any(len(row) != before for row in weights):
            raise ValueError(f"{path} has not the numbers of its layers {sizes}")
        layers.append(Layer(tuple(weights), tuple(row[0] for row in offsets)))
    return ReluNetwork(tuple(layers))


def _numbers(line: str) -> tuple[Fraction, ...]:
    return tuple(Fraction(item.strip()) for item in line.split(",") if item.strip())


def _linear(layer: Layer, before: AffineEnclosure | None) -> AffineEnclosure:
    weights = arb_mat([[ball(x) for x in row] for row in layer.weights])
    offsets = arb_mat([[ball(x)] for x in layer.offsets])
    if before is None:
        return AffineEnclosure(weights, offsets, None)
    errors = None if before.errors is None else weights * before.errors
    return AffineEnclosure(weights * before.gain, weights * before.offset + offsets, errors)


def _relu(found: AffineEnclosure, states: Zonotope, centre: arb_mat) -> AffineEnclosure:
    """The enclosure of max(y, 0) by one of y."""
    middles = (found.gain * centre + found.offset).entries()
    radii = states.radii_under(found.gain)
    if found.errors is not None:
        sums = absolute(found.errors) * column_of_ones(found.errors.ncols())
        radii = [(a + b).upper() for a, b in zip(radii, sums.entries(), strict=True)]
    slopes, shifts = [], []
    for middle, radius in zip(middles, radii, strict=True):
        slope, shift = _relaxed((middle - radius).lower(), (middle + radius).upper())
        slopes.append(slope)
        shifts.append(shift)
    kinks = [i for i, shift in enumerate(shifts) if shift != 0]
    own = [[shifts[i] if i == j else arb(0) for j in kinks] for i in range(len(shifts))]
    offset = _scaled(slopes, found.offset)
    raised = arb_mat([[x + s] for x, s in zip(offset.entries(), shifts, strict=True)])
    errors = None if found.errors is None else _scaled(slopes, found.errors)
    if kinks:
        rows = [[]] * len(own) if errors is None else errors.tolist()
        errors = arb_mat([[*a, *b] for a, b in zip(rows, own, strict=True)])
    return AffineEnclosure(_scaled(slopes, found.gain), raised, errors)


def _relaxed(lower: arb, upper: arb) -> tuple[arb, arb]:
    """An exact slope s and a shift d with max(y, 0) in s y + d +- d for y in an interval."""
    if lower >= 0:
        return arb(1), arb(0)
    if upper <= 0:
        return arb(0), arb(0)
    slope = (upper / (upper - lower)).mid().max(arb(0)).min(arb(1))
    return slope, (((1 - slope) * upper).max(-slope * lower) / 2).upper()


def _scaled(slopes: Sequence[arb], matrix: arb_mat) -> arb_mat:
    pairs = zip(slopes, matrix.tolist(), strict=True)
    return arb_mat([[slope * x for x in row] for slope, row in pairs])
