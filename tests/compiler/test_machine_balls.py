"""Balls of doubles in machine code hold what Arb makes of points in them, at high precision."""

from __future__ import annotations

import ctypes
import platform
import random
import shutil
import subprocess
import sys
import sysconfig
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import inf, pi
from pathlib import Path

import numpy as np
import pytest
from flint import arb, arb_series, ctx

from compiler.expressions.evaluators.balls import (
    BALLS,
    SERIES,
    SMOOTH_BALLS,
    UncertainSignError,
    working_precision,
)
from compiler.expressions.machine.ball_array import BallArray
from compiler.expressions.machine.program import MachineProgram
from compiler.expressions.tape import Node, Tape

BITS = 300
ONE = ("neg", "sq", "twice", "sin", "cos", "tan", "sqrt", "inv", "fabs", "sign")
TWO = ("add", "sub", "mul", "div")
FIRST = 6
"""Inputs of a random program: half of them depend on time."""


@dataclass(frozen=True)
class Case:
    """A random program all of whose values are outputs, with balls of doubles and points in them.

    Attributes:
        tape: the program.
        moving: so many inputs depend on time.
        balls: coefficients of the inputs, (inputs, length).
        points: exact ones within them.
    """

    tape: Tape
    moving: int
    balls: BallArray
    points: list[list[arb]]

    @property
    def length(self) -> int:
        return self.balls.middle.shape[1]

    def exact(self) -> list[arb_series]:
        ctx.cap = self.length
        return self.tape.evaluate([arb_series(row) for row in self.points], SERIES)

    def in_machine(self) -> BallArray:
        return MachineProgram(self.tape, self.moving).evaluate(self.balls)


def case(seed: int, operations: int) -> Case:
    rng = random.Random(seed)
    length, moving = rng.choice((1, 2, 3, 6, 11, 21)), FIRST // 2
    nodes: list[Node] = [("input", (i,)) for i in range(FIRST)]
    nodes.append(("constant", (rng.choice((-3, 0, 1, 2, 7)),)))
    while len(nodes) < FIRST + 1 + operations:
        # Most arguments are recent, so that values are deep; few are huge.
        places = [rng.randrange(max(0, len(nodes) - 12), len(nodes)) for _ in range(2)]
        if rng.random() < 0.35:
            nodes.append((rng.choice(ONE), (places[0],)))
        else:
            nodes.append((rng.choice(TWO), tuple(places)))
    scale = 10.0 ** rng.uniform(-3, 1)
    balls = BallArray.zeros(FIRST, length)
    points = list[list[arb]]()
    for i in range(FIRST):
        row = []
        for k in range(length if i < moving else 1):
            m = rng.choice((0.0, 1.0, rng.gauss(0, scale), rng.gauss(2, 1))) / 2.0**k
            r = rng.choice((0.0, 0.0, 2.0**-60, abs(m) * 1e-6, abs(m) * 0.05))
            balls.middle[i, k], balls.radius[i, k] = m, r
            row.append(arb(m) + arb(r) * rng.choice((-1, 1, rng.uniform(-1, 1))))
        points.append(row)
    return Case(Tape(tuple(nodes), tuple(range(len(nodes)))), moving, balls, points)


def held(seed: int, operations: int) -> int:
    """How many finite coefficients were held against the exact ones."""
    count = 0
    with working_precision(BITS):
        for of in shorter(case(seed, operations)):
            try:
                expected, found = of.exact(), of.in_machine()
            except ValueError:
                # A kink, or a series that Arb does not divide.
                continue
            for row, series in enumerate(expected):
                for k in range(of.length):
                    m, r = found.middle[row, k].item(), found.radius[row, k].item()
                    # The slope of |x| at 0 is any between.
                    known = float(series[k].rad()) <= 1e-50 * (1 + abs(float(series[k].mid())))
                    if not (abs(m) < inf and r < inf and known):
                        continue
                    assert abs(series[k] - m) <= r, (seed, of.tape.nodes[row], k)
                    count += 1
            return count
    return count


def shorter(whole: Case) -> Iterator[Case]:
    """The program, and where something has no value, its beginnings."""
    size = len(whole.tape.nodes)
    while size > FIRST:
        nodes = whole.tape.nodes[:size]
        of = Case(Tape(nodes, tuple(range(size))), whole.moving, whole.balls, whole.points)
        try:
            usable = bool(np.isfinite(of.in_machine().radius).any())
        except UncertainSignError:
            usable = False
        if usable:
            yield of
            return
        size = FIRST + (size - FIRST) // 2


def test_random_operations_hold_the_exact_values() -> None:
    assert sum(held(seed, 12) for seed in range(400)) > 20_000


@pytest.mark.slow
@pytest.mark.parametrize("part", range(4))
def test_a_million_random_operations_hold_the_exact_values(part: int) -> None:
    """Some twelve operations each, on up to 21 coefficients."""
    first = 10_000 * (part + 1)
    assert sum(held(seed, 12) for seed in range(first, first + 4_000)) > 250_000


# --- Sine and cosine ------------------------------------------------------------------------------

SINE = Tape((("input", (0,)), ("sin", (0,)), ("cos", (0,))), (1, 2))


def sines(angles: Sequence[float]) -> float:
    """The largest error in units of 2^-53; the stated radii are never exceeded."""
    program, worst = MachineProgram(SINE, 1), 0.0
    with working_precision(120):
        for angle in angles:
            found = program.evaluate(BallArray(np.array([[angle]]), np.zeros((1, 1))))
            exact = arb(angle).sin(), arb(angle).cos()
            for m, r, value in zip(
                found.middle[:, 0].tolist(), found.radius[:, 0].tolist(), exact, strict=True
            ):
                off = abs(value - m)
                assert off <= r, angle
                worst = max(worst, float(off) * 2**53)
    return worst


def angles(rng: random.Random, count: int) -> list[float]:
    """Some of any size, some near multiples of a quarter of a turn, where digits cancel."""
    found = [rng.uniform(-8, 8) for _ in range(count // 4)]
    found += [rng.uniform(-1e5, 1e5) for _ in range(count // 4)]
    found += [rng.choice((-1, 1)) * 10 ** rng.uniform(-320, 5) for _ in range(count // 4)]
    near = [rng.randrange(-60_000, 60_000) * pi / 2 for _ in range(count // 4)]
    return found + [x * (1 + rng.choice((0, 1, -1)) * 2.0**-52) for x in near]


def test_sine_and_cosine_are_as_close_as_is_proved() -> None:
    """What is stated is 2^-49, or 16 units; the derivation comes to 7."""
    assert sines([0.0, -0.0, 1e5, -1e5, *angles(random.Random(1), 4_000)]) < 7


@pytest.mark.slow
@pytest.mark.parametrize("part", range(4))
def test_sine_and_cosine_of_a_million_angles(part: int) -> None:
    assert sines(angles(random.Random(100 + part), 250_000)) < 7


@pytest.mark.parametrize("angle", [1.1e5, -1e300, inf, float("nan")])
def test_nothing_is_said_of_the_sine_of_what_is_too_large(angle: float) -> None:
    found = MachineProgram(SINE, 1).evaluate(BallArray(np.array([[angle]]), np.zeros((1, 1))))
    assert (found.radius >= 1).all()
    assert (np.abs(found.middle) + 1 <= found.radius).all()


# --- What has no value, and kinks -----------------------------------------------------------------


def program(*names: str, inputs: int = 1) -> Tape:
    """One operation after another, each on the first inputs or the last value."""
    nodes: list[Node] = [("input", (i,)) for i in range(inputs)]
    for name in names:
        last = len(nodes) - 1
        nodes.append((name, (0, last) if name in TWO else (last,)))
    return Tape(tuple(nodes), (len(nodes) - 1,))


def on(tape: Tape, rows: Sequence[Sequence[tuple[float, float]]], *, smooth: bool = False):
    array = np.array(rows, float)
    balls = BallArray(array[:, :, 0].copy(), array[:, :, 1].copy())
    return MachineProgram(tape, len(rows)).evaluate(balls, smooth=smooth)


@pytest.mark.parametrize(
    ("tape", "ball"),
    [
        (program("inv"), (0.5, 0.5)),
        (program("inv"), (0.0, 0.0)),
        (program("inv"), (1e-310, 0.0)),
        (program("sqrt"), (1.0, 1.5)),
        (program("sqrt"), (-1.0, 0.1)),
        (program("tan"), (1.5707963267948966, 1e-9)),
        (program("sq"), (1e200, 0.0)),
        (program("twice"), (1.7e308, 0.0)),
        (program("mul", inputs=2), (1e200, 1e200)),
        (program("add"), (float("nan"), 0.0)),
        (program("sin", "inv"), (inf, 0.0)),
    ],
)
def test_what_has_no_value_is_not_finite(tape: Tape, ball: tuple[float, float]) -> None:
    inputs = len({number for name, (number, *_) in tape.nodes if name == "input"})
    found = on(tape, [[ball]] * inputs)
    finite = np.isfinite(found.middle) & np.isfinite(found.radius)
    assert not finite.all()
    assert not all(item.is_finite() for item in found.balls())


DOWNWARD, UPWARD, TOWARDS_ZERO = 0x400, 0x800, 0xC00
"""As the C library has them on x86."""


@pytest.mark.skipif(platform.machine() not in ("x86_64", "AMD64"), reason="other numbers")
@pytest.mark.skipif(sys.platform != "linux", reason="another C library")
@pytest.mark.parametrize("way", [DOWNWARD, UPWARD, TOWARDS_ZERO])
def test_where_rounding_is_not_to_nearest_nothing_has_a_value(way: int) -> None:
    run = MachineProgram(program("sq"), 1).started(BallArray(np.ones((1, 1)), np.zeros((1, 1))))
    library = ctypes.CDLL("libm.so.6")
    before = library.fegetround()
    assert library.fesetround(way) == 0
    try:
        found = run.advanced(0, 1)
    finally:
        assert library.fesetround(before) == 0
    assert not np.isfinite(found.radius).any()
    assert run.advanced(0, 1).balls()[0].contains(arb(1))


def test_a_root_of_zero_is_zero_and_its_slope_has_no_value() -> None:
    assert on(program("sqrt"), [[(0.0, 0.0)]]).balls() == [arb(0)]
    assert not np.isfinite(on(program("sqrt"), [[(0.0, 0.0), (1.0, 0.0)]]).radius).all()


@pytest.mark.parametrize("name", ["fabs", "sign"])
@pytest.mark.parametrize("length", [1, 2, 3])
@pytest.mark.parametrize("smooth", [False, True])
@pytest.mark.parametrize("ball", [(1.0, 0.5), (-1.0, 0.5), (0.2, 0.5), (-0.2, 0.5), (0.0, 0.0)])
def test_kinks_are_those_of_arb(
    name: str, length: int, smooth: bool, ball: tuple[float, float]
) -> None:
    tape, rows = program(name), [[ball, (0.7, 0.1), (0.3, 0.0)][:length]]
    inputs = [arb(*each) for each in rows[0]]
    with working_precision(BITS):
        ctx.cap = length
        try:
            if smooth or length == 1:
                evaluator = SMOOTH_BALLS if smooth else BALLS
                expected = [tape.evaluate([inputs[0]], evaluator)[0]]
            else:
                series = tape.evaluate([arb_series(inputs)], SERIES)[0]
                expected = [series[k] for k in range(length)]
        except UncertainSignError:
            with pytest.raises(UncertainSignError):
                on(tape, rows, smooth=smooth)
            return
        found = on(tape, rows, smooth=smooth).balls()
        slopes = [s for s in (1, -1) if s * ball[0] + ball[1] >= 0]
        for k, (near, exact) in enumerate(zip(found, expected, strict=False)):
            ends = [rows[0][k][0] + s * rows[0][k][1] for s in (1, -1)]
            values = [abs(x) for x in ends] if k == 0 else [s * x for s in slopes for x in ends]
            if name == "sign":
                values = [0.0 if k else float(s) for s in slopes]
            assert all(near.contains(arb(x)) for x in values)
            assert float(near.rad()) <= float(exact.rad()) * (1 + 1e-9) + 1e-300


def test_a_program_is_run_coefficient_by_coefficient_as_at_once() -> None:
    with working_precision(BITS):
        of = next(shorter(case(7, 12)))
        whole = MachineProgram(of.tape, of.moving)
        once, run = whole.evaluate(of.balls), whole.started(of.balls)
        parts = [run.advanced(k, k + 1) for k in range(of.length)]
    assert np.array_equal(once.middle, np.concatenate([p.middle for p in parts], axis=1))
    assert np.array_equal(once.radius, np.concatenate([p.radius for p in parts], axis=1))


# --- Arrays ---------------------------------------------------------------------------------------


def test_doubles_hold_the_balls_that_they_are_made_of() -> None:
    rng = random.Random(4)
    with working_precision(200):
        third = arb(1) / 3
        balls = [third, -third * 10**30, arb(1, 2), arb(0), arb("1e-400"), arb("1e400"), arb("nan")]
        balls += [arb(rng.gauss(0, 1)) / 7 + arb(0, rng.random()) for _ in range(200)]
        found = BallArray.of(balls).balls()
        for near, exact in zip(found, balls, strict=True):
            assert not near.is_finite() or near.contains(exact)
        assert all(near.is_finite() for near in found[:5])
        assert not any(near.is_finite() for near in found[5:7])


def test_arrays_that_do_not_fit_are_refused() -> None:
    from compiler.expressions.machine import ball_kernel

    code = np.array([[2, 0, 1, 2]], np.int32)
    mid, rad, fixed = np.zeros((3, 2)), np.zeros((3, 2)), np.zeros(3, np.bool_)
    assert ball_kernel.coefficients(code, mid, rad, fixed, 0, 2, 0) == 0
    wrong = (
        (code, mid, rad, fixed, 0, 3, 0),
        (code, mid, rad, fixed, -1, 2, 0),
        (code, mid[:2].copy(), rad, fixed, 0, 2, 0),
        (code, mid, rad, fixed[:2].copy(), 0, 2, 0),
        (np.array([[2, 0, 1, 3]], np.int32), mid, rad, fixed, 0, 2, 0),
        (np.array([[2, 0, 2, 2]], np.int32), mid, rad, fixed, 0, 2, 0),
        (np.array([[2, -1, 1, 2]], np.int32), mid, rad, fixed, 0, 2, 0),
        (np.array([[10, 0, 1, 2]], np.int32), mid, rad, fixed, 0, 2, 0),
        (np.array([[7, 0, 0, 2]], np.int32), mid, rad, fixed, 0, 2, 0),
    )
    for arguments in wrong:
        with pytest.raises(ValueError, match="do not fit together"):
            ball_kernel.coefficients(*arguments)


@pytest.mark.parametrize("compiler", ["gcc", "clang"])
def test_the_kernel_compiles_without_a_warning(compiler: str) -> None:
    if shutil.which(compiler) is None:
        pytest.skip(f"{compiler} is not installed")
    source = Path(__file__).parents[2] / "compiler" / "expressions" / "machine" / "ball_kernel.c"
    include = sysconfig.get_path("include")
    if not (Path(include) / "Python.h").exists():
        pytest.skip("Python has no headers")
    command = [compiler, "-std=c99", "-O2", "-Wall", "-Wextra", "-Wshadow", "-Wconversion"]
    command += ["-Wno-sign-conversion", "-pedantic", "-Werror", "-fsyntax-only", f"-I{include}"]
    ran = subprocess.run([*command, source], capture_output=True, text=True, check=False)
    assert (ran.returncode, ran.stderr) == (0, "")
    fast = subprocess.run([*command, "-ffast-math", source], capture_output=True, check=False)
    assert fast.returncode != 0
