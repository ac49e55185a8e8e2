"""Joints that dry friction holds by little, until another one makes them break away in a step."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from compiler.expressions.evaluators.balls import ball, working_precision
from solvers.verifier.proofs.enclosure import EnclosureFailure, tube
from tests.oracles.rubbing_chain import RubbingChain
from tests.soundness.test_dry_friction import ACCURACY, box_at, field_of, rubbing_graph

F = Fraction
STEP, PULL = F(1, 4), (F(0), F(-3))


def breaking_away(seed: int, links: int) -> tuple[list[Fraction], ...]:
    """Lengths, coordinates, inputs of two steps, and friction of a chain at rest.

    Friction holds every joint but the first by little: what that one does makes them break away.
    """
    rng = np.random.default_rng(seed)
    lengths = [F(int(x), 10) for x in rng.integers(6, 14, links)]
    q = [F(int(x), 10) for x in rng.integers(-12, 12, links)]
    first, second = ([F(int(x), 100) for x in rng.integers(-300, 300, links)] for _ in range(2))
    friction = [F(int(x), 100) for x in rng.integers(5, 20, links)]
    firm = np.array([float(friction[0]), *[1e3] * (links - 1)])
    chain = RubbingChain(np.array(lengths, float), [float(x) for x in PULL], firm)
    x, u = np.array([*map(float, q), *[0.0] * links]), np.array([float(v) for v in first])
    held = chain.accelerations(x, u, chain.signs(x, u))[1]
    for joint in range(1, links):
        share = float(rng.uniform(1.01, 1.2))
        friction[joint] = F(round(abs(held[joint]) * share * 1000) + 1, 1000)
    return lengths, q, first, second, friction


def followed(seed: int, links: int) -> tuple[float, bool]:
    """How wide a tube is that holds the motion of the oracle, and whether joints break away."""
    lengths, q, *inputs, friction = breaking_away(seed, links)
    chain = RubbingChain(
        np.array(lengths, float), [float(x) for x in PULL], np.array(friction, float)
    )
    x, freed = np.array([*map(float, q), *[0.0] * links]), False
    widest = np.inf
    try:
        with working_precision(ACCURACY.bits):
            field = field_of(rubbing_graph(friction, PULL), lengths, friction)
            rows = [[ball(v) for v in row] for row in inputs]
            initial = box_at([*q, *[F(0)] * links])
            for segment in tube(field, initial, rows, ball(STEP), ACCURACY):
                first, last = segment.steps
                u = np.array([float(v) for v in inputs[int(first)]])
                x = chain.moved(x, u, float((last - first) * STEP))
                freed |= bool(np.any(np.abs(x[links + 1 :]) > 1e-3))
                off = [
                    abs(value - float(end.mid())) - float(end.rad())
                    for value, end in zip(x, segment.end, strict=True)
                ]
                assert max(off) < 1e-9
        widest = max(float(end.rad()) for end in segment.end)
    except EnclosureFailure:
        pass
    return widest, freed


@pytest.mark.parametrize("seed", [1, 8, 9])
def test_a_joint_that_breaks_away_is_known_to(seed: int) -> None:
    """Of these chains no tube came to an end, or it was 4 cm wide."""
    widest, freed = followed(seed, 2)
    assert freed
    assert widest < 1e-6


@pytest.mark.slow
@pytest.mark.parametrize(("links", "due"), [(2, 0.9), (3, 0.75)])
def test_sixty_chains_that_break_away(links: int, due: float) -> None:
    found = [followed(seed, links) for seed in range(60)]
    assert sum(widest < 1e-4 for widest, _ in found) >= due * 60
    assert sum(freed for _, freed in found) >= 20
