"""What hovers say that rules add to the dynamics, against the compiler's equations of motion.

The masses and moments are read off the hover's text and put in numbers; where the bodies are and
how they turn is written down here by hand for each robot.  Of that the mass matrix is
sum(m Jv^T Jv + Jw^T I Jw), by the hover's own formula, and gravity is the gradient of
sum(-m g . c).  The compiler derives both from the spec, its own way.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from pathlib import Path
from types import SimpleNamespace
from typing import TypeAlias

import numpy as np
import pytest
from numpy.typing import NDArray

import srgc
from srgc.language_server.documents.analysis import Analysis, analyse
from srgc.language_server.hovers.hover import hover

Array: TypeAlias = NDArray[np.floating]
Complex: TypeAlias = NDArray[np.complexfloating]
Values: TypeAlias = Mapping[str, Mapping[str, float]]
Place = Callable[[Complex], Complex]
"""Where the centre of mass of a body is at coordinates q."""
Turning = Callable[[Array], Array]
"""Jw: the angular velocity of a body for each rate, in the frame of its moments (rows x n)."""

GRAMMAR = """
grammar Arm { start N; base: N -> Root; turn: N -> N J; limb: N -> N L; tool: N -> N E; }
"""
TASK = """
task Go { robot Arm; workspace W; start in A at rest; reach A; EFFORT
  horizon 4 steps of 1 s; gravity GRAVITY m/s^2; }
"""
BOTH = "effort <= 10 N*m; effort <= 10 N;"
PLANE = f"""
module Root {{ role base; }}
module J {{ role joint; dof q: revolute z in [-180, 180] deg; }}
module L {{ role link; param length in [20, 150] cm; param rho in [1, 4] kg/m; }}
module E {{ role effector; const grip = 250 g; }}
{GRAMMAR}
semantics Arm {{
  base {{ this.f = world; }}
  turn {{ this.f = N.f * rot(z, J.q); }}
  limb {{ this.f = N.f * move(x, L.length);
    rod(frame: N.f, axis: x, length: L.length, density: 2 * L.rho); }}
  tool {{ this.f = N.f; point(frame: N.f, mass: E.grip); effector(frame: N.f); }}
}}
workspace W {{ plane xy; bounds box [-9, 9] x [-9, 9] m;
  region A box [0, 1] x [0, 1] m; }}
{TASK.replace("GRAVITY", "(0, -9.81)").replace("EFFORT", "effort <= 10 N*m;")}"""
SPACE = f"""
module Root {{ role base; }}
module J {{ role joint; dof pan: revolute z in [-90, 90] deg; dof lift: prismatic z in [0, 1] m; }}
module L {{ role link; param mass in [1, 3] kg; param size in [0.1, 0.4] m;
  dof tilt: revolute y in [-1, 1] rad; }}
module E {{ role effector; }}
{GRAMMAR}
semantics Arm {{
  base {{ this.f = world; this.m = world; }}
  turn {{ this.m = N.f * rot(z, J.pan); this.f = this.m * move(z, J.lift) * move(x, 30 cm);
    point(frame: this.m * move(x, 10 cm), mass: 1.5 kg); }}
  limb {{ this.m = N.f * rot(y, L.tilt); this.f = this.m * move(x, L.size);
    solid(frame: this.m, mass: L.mass, com: (L.size / 2, 0, 0.05),
      inertia: (0.02, L.mass * L.size^2 / 3, 0.07, 0.005, -0.003, 0.001)); }}
  tool {{ this.f = N.f; this.m = N.m; effector(frame: N.f); }}
}}
workspace W {{ space xyz; bounds box [-9, 9] x [-9, 9] x [-9, 9] m;
  region A box [0, 1] x [0, 1] x [0, 1] m; }}
{TASK.replace("GRAVITY", "(0, 0, -9.81)").replace("EFFORT", BOTH)}"""
SLIDE = f"""
module Root {{ role base; }}
module J {{ role joint; dof s: prismatic x in [0, 2] m; const rho = 3 kg/m;
  param stroke in [1, 2] m; }}
module L {{ role link; dof q: revolute z in [-180, 180] deg; param length in [0.2, 1.5] m; }}
module E {{ role effector; param load in {{ 1, 2 }} kg; }}
{GRAMMAR}
semantics Arm {{
  base {{ this.f = world * rot(z, 90 deg); this.m = world; }}
  turn {{ this.f = N.f * move(x, J.s); this.m = N.m;
    rod(frame: this.f, axis: -x, length: J.stroke / 2, density: J.rho); }}
  limb {{ this.m = N.f * rot(z, L.q); this.f = this.m * move(y, L.length);
    solid(frame: this.m, mass: 0.75 kg, com: (0, L.length / 3), inertia: 0.125); }}
  tool {{ this.f = N.f; this.m = N.m; effector(frame: N.f); point(frame: N.f, mass: E.load); }}
}}
workspace W {{ plane xy; bounds box [-9, 9] x [-9, 9] m;
  region A box [0, 1] x [0, 1] m; }}
{TASK.replace("GRAVITY", "(1, -9)").replace("EFFORT", BOTH)}"""

NOTHING_TURNS: Turning = lambda q: np.zeros((0, len(q)))  # noqa: E731


def told(analysis: Analysis, label: str) -> str:
    """The hover over the name of a production."""
    offset = analysis.sources[0].text.index(f"{label}: N ->")
    found = hover(analysis, 0, offset)
    assert found is not None
    return str(found.contents.value)  # type: ignore[union-attr]


def put_in(text: str, values: Values) -> Array:
    """An expression of the hover (or several in parentheses) at numbers."""
    names = {module: SimpleNamespace(**each) for module, each in values.items()}
    found = eval(text.replace("^", "**"), {"__builtins__": {}}, names)
    return np.atleast_1d(np.array(found, dtype=float))


def said_mass(text: str, values: Values) -> float:
    found = re.findall(r"mass m = `([^`]*)` kg", text)
    assert len(found) == 1
    return float(put_in(found[0], values)[0])


def said_inertia(text: str, values: Values) -> Array:
    """The moments, about the centre of mass; none of a point."""
    found = re.findall(r"inertia I = `([^`]*)` kg\*m\^2(?! about its beginning)", text)
    return put_in(found[0], values) if found else np.zeros(0)


def tensor(moments: Array) -> Array:
    """The matrix of none, one or six moments (xx, yy, zz, xy, xz, yz)."""
    if len(moments) < 6:
        return np.diag(moments)
    xx, yy, zz, xy, xz, yz = moments
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def jacobian(place: Place, q: Array) -> Array:
    """By complex steps: exact to rounding."""
    step = 1e-30
    units = np.eye(len(q))
    return np.stack([place(q + 1j * step * unit).imag / step for unit in units], axis=1)


def planar_limb(number: int, lengths: tuple[float, ...], part: float) -> Place:
    """A point of a limb of an arm whose joints turn about z: ``part`` of its length along it."""

    def place(q: Complex) -> Complex:
        angles = np.cumsum(q)
        reach = [*lengths[:number], part * lengths[number]]
        return np.array(
            [
                sum(r * np.cos(angles[k]) for k, r in enumerate(reach)),
                sum(r * np.sin(angles[k]) for k, r in enumerate(reach)),
            ]
        )

    return place


def planar_turn(number: int) -> Turning:
    return lambda q: (np.arange(len(q)) <= number).astype(float)[None, :]


Body = tuple[str, Values, Place, Turning]
Case = tuple[str, str, dict[str, float], tuple[float, ...], tuple[float, ...], list[Body]]


def arm_in_the_plane() -> Case:
    lengths = (0.7, 1.1)
    given = {
        "2.length": 0.7, "2.rho": 1.5, "4.length": 1.1, "4.rho": 3.25,
    }  # fmt: skip
    limbs: list[Values] = [{"L": {"length": 0.7, "rho": 1.5}}, {"L": {"length": 1.1, "rho": 3.25}}]
    bodies: list[Body] = [
        ("limb", limbs[k], planar_limb(k, lengths, 0.5), planar_turn(k)) for k in range(2)
    ]
    bodies.append(("tool", {"E": {"grip": 0.25}}, planar_limb(1, lengths, 1.0), NOTHING_TURNS))
    return PLANE, "Root J L J L E", given, (0.4, -1.3), (0.0, -9.81), bodies


def arm_in_space() -> Case:
    size, mass = 0.35, 2.5

    def motor(q: Complex) -> Complex:
        return np.array([0.1 * np.cos(q[0]), 0.1 * np.sin(q[0]), 0 * q[0]])

    def limb(q: Complex) -> Complex:
        along, up = size / 2, 0.05
        # rot(y, a) carries x to (cos a, 0, -sin a) and z to (sin a, 0, cos a).
        out = 0.3 + along * np.cos(q[2]) + up * np.sin(q[2])
        height = q[1] - along * np.sin(q[2]) + up * np.cos(q[2])
        return np.array([out * np.cos(q[0]), out * np.sin(q[0]), height])

    def turning(q: Array) -> Array:
        # About the body's own axes: the world's z is (-sin a, 0, cos a), its tilt is about y.
        return np.array([[-np.sin(q[2]), 0.0, 0.0], [0.0, 0.0, 1.0], [np.cos(q[2]), 0.0, 0.0]])

    given = {"2.mass": mass, "2.size": size}
    bodies: list[Body] = [
        ("turn", {}, motor, NOTHING_TURNS),
        ("limb", {"L": {"mass": mass, "size": size}}, limb, turning),
    ]
    return SPACE, "Root J L E", given, (0.6, 0.2, -0.7), (0.0, 0.0, -9.81), bodies


def slide_and_turn() -> Case:
    stroke, length = 1.5, 0.9

    def rod(q: Complex) -> Complex:
        return np.array([0 * q[0], q[0] - stroke / 4])

    def out(part: float) -> Place:
        # The slide goes along the world's y; the limb's y then points along the world's -x.
        return lambda q: np.array(
            [-part * length * np.cos(q[1]), q[0] - part * length * np.sin(q[1])]
        )

    given = {"1.stroke": stroke, "2.length": length, "3.load": 2.0}
    bodies: list[Body] = [
        ("turn", {"J": {"rho": 3, "stroke": stroke}}, rod, lambda q: np.array([[0.0, 0.0]])),
        ("limb", {"L": {"length": length}}, out(1 / 3), lambda q: np.array([[0.0, 1.0]])),
        ("tool", {"E": {"load": 2.0}}, out(1.0), NOTHING_TURNS),
    ]
    return SLIDE, "Root J L E", given, (1.2, 0.8), (1.0, -9.0), bodies


@pytest.mark.parametrize("make", [arm_in_the_plane, arm_in_space, slide_and_turn])
def test_what_rules_add_is_what_the_compiler_adds(make: Callable[[], Case], tmp_path: Path) -> None:
    spec, word, given, at, pull, bodies = make()
    path = tmp_path / "arm.srg"
    path.write_text(spec, encoding="utf-8")
    robot = srgc.robot(srgc.load(path), word, given, task="Go")
    analysis = analyse(str(path), spec, {})
    q = np.array(at)
    mass_matrix = np.zeros((len(q), len(q)))
    gravity = np.zeros(len(q))
    for label, values, place, turning in bodies:
        text = told(analysis, label)
        mass, moments = said_mass(text, values), said_inertia(text, values)
        moved, turned = jacobian(place, q), turning(q)
        mass_matrix += mass * moved.T @ moved + turned.T @ tensor(moments) @ turned
        gravity -= mass * moved.T @ np.array(pull)
    np.testing.assert_allclose(mass_matrix, robot.mass_matrix(q), rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(gravity, robot.gravity(q), rtol=1e-12, atol=1e-12)
    nothing = {"base", "turn", "limb", "tool"} - {label for label, *_ in bodies}
    assert all("It adds no mass" in told(analysis, label) for label in nothing)
