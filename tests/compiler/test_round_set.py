"""Polytopes on either side of balls, capsules and cylinders, held against the sets themselves."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from compiler.workspaces.polytope import polytope_of, refuting_polytope
from grammar_lang import ir

KINDS = ("ball", "capsule", "cylinder")


def drawn(kind: str, dimension: int, seed: int, *, outward: bool) -> ir.Round:
    rng = np.random.default_rng(seed)
    ends = 1 if kind == "ball" else 2
    points = rng.integers(-300, 300, (ends, dimension)).tolist()
    exact = tuple(tuple(Fraction(x, 100) for x in point) for point in points)
    radius = Fraction(int(rng.integers(1, 200)), 100)
    return ir.Round(kind, exact, radius, outward)  # type: ignore[arg-type]


def beyond(shape: ir.Round, place: np.ndarray) -> float:
    """How far a place is outside a round set, by the definition of each; negative inside."""
    ends, radius = np.array(shape.points, float), float(shape.radius)
    if shape.kind == "ball":
        return float(np.linalg.norm(place - ends[0])) - radius
    axis = ends[1] - ends[0]
    share = float((place - ends[0]) @ axis / (axis @ axis))
    if shape.kind == "capsule":
        return float(np.linalg.norm(place - ends[0] - min(1, max(0, share)) * axis)) - radius
    across = float(np.linalg.norm(place - ends[0] - share * axis)) - radius
    length = float(np.linalg.norm(axis))
    return max(across, -share * length, (share - 1) * length)


def boundary(shape: ir.Round, rng: np.random.Generator) -> np.ndarray:
    """A random place of the set, as far out in a random direction as it gets."""
    ends, radius = np.array(shape.points, float), float(shape.radius)
    direction = rng.normal(size=ends.shape[1])
    direction /= np.linalg.norm(direction)
    if shape.kind == "cylinder":
        axis = ends[1] - ends[0]
        axis /= np.linalg.norm(axis)
        direction -= direction @ axis * axis
        direction /= np.linalg.norm(direction)
    weight = rng.uniform() if rng.uniform() < 0.5 else float(rng.integers(0, 2))
    middle = ends[0] if shape.kind == "ball" else ends[0] + weight * (ends[1] - ends[0])
    return np.asarray(middle + radius * direction)


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("kind", KINDS)
def test_one_polytope_holds_the_set_and_the_other_lies_in_it(kind: str, dimension: int) -> None:
    rng = np.random.default_rng(5)
    for seed in range(4):
        outer = drawn(kind, dimension, seed, outward=True)
        holding, inside = (polytope_of(outer, dimension), refuting_polytope(outer, dimension))
        size = float(outer.radius)
        for _ in range(200):
            place = boundary(outer, rng)
            assert np.all(holding.A @ place <= holding.b + 1e-9 * size)
        for corner in inside.vertices:
            assert beyond(outer, np.array(corner, float)) <= 1e-9 * size
        swapped = drawn(kind, dimension, seed, outward=False)
        assert polytope_of(swapped, dimension).rows == inside.rows
        assert refuting_polytope(swapped, dimension).rows == holding.rows


@pytest.mark.parametrize(("dimension", "most"), [(2, 0.02), (3, 0.13)])
@pytest.mark.parametrize("kind", KINDS)
def test_neither_is_far_from_it(kind: str, dimension: int, most: float) -> None:
    for seed in range(4):
        outer = drawn(kind, dimension, seed, outward=True)
        size, rng = float(outer.radius), np.random.default_rng(seed)
        for corner in polytope_of(outer, dimension).vertices:
            assert beyond(outer, np.array(corner, float)) <= most * 1.05 * size
        inner = refuting_polytope(outer, dimension)
        middle = np.array(outer.points, float).mean(axis=0)
        for _ in range(100):
            place = middle + (1 - most) * (boundary(outer, rng) - middle)
            assert np.all(inner.A @ place <= inner.b + 1e-9)
