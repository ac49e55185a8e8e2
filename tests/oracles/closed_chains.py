"""Closed loops of planar chains as their certificates state them, without any code of the project.

The claim is read from the files of a result, the law is applied by hand, and SciPy's method of
order 8 integrates the robot, ``planar_chain``.  A chain has one joint before each of its links.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from math import pi
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from compiler.arrays import Array
from tests.oracles.planar_chain import chain_dynamics

Content = dict[str, Any]
UNITS = {"deg": pi / 180, "rad": 1.0, "deg/s": pi / 180, "rad/s": 1.0}
PIECES = 3
"""How often errors of inputs may change within a step."""
FINE = 5
"""How often a piece is looked at."""
HOPELESS = 10.0
"""A motion ends where so many times the bound of an input is commanded: it grows without end."""


def number(text: str, pattern: str) -> float:
    """The number behind a pattern in a spec; zero where it is not there."""
    found = re.search(rf"{pattern} (-?[\d.e-]+)", text)
    return 0.0 if found is None else float(found[1])


def radii(text: str, of: str) -> tuple[float, float]:
    """Angle and angular rate of ``robust start`` or ``robust measure``, in rad and rad/s."""
    found = re.search(rf"robust {of} ([\d.e-]+) (deg|rad), ([\d.e-]+) (deg/s|rad/s);", text)
    if found is None:
        return 0.0, 0.0
    return float(found[1]) * UNITS[found[2]], float(found[3]) * UNITS[found[4]]


def box(text: str, name: str) -> Array:
    """The rows (a, b) of a x <= b of a box or polytope of that name, shape (r, 3)."""
    found = re.search(rf"{name} box \[(.+?), (.+?)\] x \[(.+?), (.+?)\] m", text)
    if found is not None:
        x0, x1, y0, y1 = map(float, found.groups())
        return np.array([[1, 0, x1], [-1, 0, -x0], [0, 1, y1], [0, -1, -y0]])
    found = re.search(rf"{name} polytope \{{(.+?)\}} m", text)
    assert found is not None, name
    rows = []
    for row in found[1].split(";"):
        if row.strip():
            parts = re.fullmatch(r"(\d)\*x ([+-]) (\d)\*y (<=|>=) (-?[\d.]+)", row.strip())
            assert parts is not None, row
            sign = 1 if parts[4] == "<=" else -1
            y = float(f"{parts[2]}{parts[3]}")
            rows.append([sign * float(parts[1]), sign * y, sign * float(parts[5])])
    return np.array(rows)


def depth(rows: Array, tips: Array) -> Array:
    """How deep points (k, 2) are inside a set: the least distance to a row, below zero outside."""
    lengths = np.linalg.norm(rows[:, :2], axis=1)
    return np.asarray(((rows[:, 2] - tips @ rows[:, :2].T) / lengths).min(axis=1))


@dataclass(frozen=True)
class Corner:
    """One disturbance: per unit of each radius, in -1 .. 1.

    ``start`` (2n,), ``misread`` (k, 2n), ``pushed`` (k, PIECES, m) and the links' ``factors`` (n,).
    """

    start: Array
    misread: Array
    pushed: Array
    factors: Array


@dataclass
class ClosedChain:
    """A claim about a chain of links with the given densities, and the text of its spec."""

    content: Content
    text: str
    lengths: Callable[[Content], list[float]]
    densities: tuple[float, ...]
    links: str
    """The module of each link, a letter each."""

    def __post_init__(self) -> None:
        (law,) = [item for item in self.content["claims"] if item["kind"] == "controller"]
        self.u = np.array(self.content["inputs"], float)
        self.reference = np.array(law["reference"], float)
        self.gains = np.array(law["gains"], float)
        self.begin = np.array(self.content["start"], float)
        self.n, self.dt = len(self.begin) // 2, float(Fraction(self.content["step"]))
        self.bound = number(self.text, "effort <=")
        found = re.findall(r"robust mass ([\d.e-]+) % of (\w)", self.text)
        of = {name: float(part) / 100 for part, name in found}
        every = re.search(r"robust mass ([\d.e-]+) %;", self.text)
        self.all_masses = 0.0 if every is None else float(every[1]) / 100
        self.own_masses = np.array([of.get(name, 0.0) for name in self.links])

    # --- motions --------------------------------------------------------------------------------

    def still(self) -> Corner:
        k, m = self.u.shape
        return Corner(np.zeros(2 * self.n), np.zeros((k, 2 * self.n)), np.zeros((k, PIECES, m)),
                      np.zeros(self.n + 1))  # fmt: skip

    def corners(self, rng: np.random.Generator, count: int) -> Iterator[Corner]:
        """Corners at random; every other one has errors that stay the same all the time."""
        still = self.still()
        for number_ in range(count):
            parts = [
                rng.choice((-1.0, 1.0), part.shape)
                for part in (still.start, still.misread, still.pushed, still.factors)
            ]
            if number_ % 2:
                parts[1][:], parts[2][:] = parts[1][0], parts[2][0, 0]
            yield Corner(*parts)

    def motion(self, corner: Corner, accuracy: float = 1e-11) -> tuple[Array, Array]:
        """States at fine times (t, 2n), and the inputs that are commanded (k, m)."""
        n, lengths = self.n, np.array(self.lengths(self.content))
        angle, rate = radii(self.text, "start")
        noise = np.repeat(radii(self.text, "measure"), n)
        push = number(self.text, "robust effort") / 100 * self.bound
        weights = 1 + self.all_masses * corner.factors[-1]
        densities = np.array(self.densities) * weights
        densities = densities * (1 + self.own_masses * corner.factors[:-1])
        state = self.begin + np.repeat((angle, rate), n) * corner.start
        states, commanded = [state], []
        for k, planned in enumerate(self.u):
            seen = state + noise * corner.misread[k]
            u = planned - self.gains[k] @ (seen - self.reference[k])
            commanded.append(u)
            if np.abs(u).max() > HOPELESS * self.bound:
                return np.array(states), np.array(commanded)
            for piece in range(PIECES):
                torque = u + push * corner.pushed[k, piece]

                def slope(_: float, x: Array, torque: Array = torque) -> Array:
                    mass, turning, _ = chain_dynamics(lengths, densities, x[:n], x[n:], (0, 0))
                    return np.concatenate([x[n:], np.linalg.solve(mass, torque - turning)])

                span = self.dt / PIECES
                found = solve_ivp(
                    slope, (0, span), state, method="DOP853", rtol=accuracy, atol=accuracy / 10,
                    t_eval=np.linspace(0, span, FINE + 1)[1:],
                )  # fmt: skip
                if not found.success:
                    return np.array(states), np.array(commanded)
                states += list(found.y.T)
                state = states[-1]
        return np.array(states), np.array(commanded)

    # --- what the task asks ---------------------------------------------------------------------

    def tips(self, states: Array) -> Array:
        angles = np.cumsum(states[:, : self.n], axis=1)
        lengths = np.array(self.lengths(self.content))
        return np.stack([np.cos(angles) @ lengths, np.sin(angles) @ lengths], axis=1)

    def room(self, states: Array, commanded: Array) -> dict[str, float]:
        """The least margins of all conditions on disturbed motions; below zero: violated."""
        tips, n = self.tips(states), self.n
        most = number(self.text, r"z in \[-[\d.]+,") * pi / 180
        found = {
            "target": float(depth(box(self.text, "target T"), tips[-1:])[0]),
            "obstacle": float((-depth(box(self.text, "obstacle O"), tips)).min()),
            "bounds": float(depth(box(self.text, "bounds"), tips).min()),
            "range": most - float(np.abs(states[:, :n]).max()),
            "effort": self.bound - float(np.abs(commanded).max()),
        }
        fastest = number(self.text, r"rate in \[-[\d.]+,")
        if fastest:
            found["rate"] = fastest - float(np.abs(states[:, n:]).max())
        slow = number(self.text, r"reach T rates <=")
        if slow:
            found["rates at the end"] = slow - float(np.abs(states[-1, n:]).max())
        return found

    def planned_room(self, states: Array) -> dict[str, float]:
        """The margins of what is asked of the planned motion alone."""
        start = depth(box(self.text, "region S"), self.tips(states[:1]))
        return {"start": float(start[0]), "rest": -float(np.abs(self.begin[self.n :]).max())}
