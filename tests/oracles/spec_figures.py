"""What a spec says of its workspace and its task, read from its text by regular expressions.

No code of the project: the forms that the tests' specs use, one task and one workspace per file.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import combinations

import numpy as np
import shapely
from scipy.spatial import ConvexHull

from compiler.arrays import Array

SCALE = {"m": Fraction(1), "cm": Fraction(1, 100), "mm": Fraction(1, 1000), "": Fraction(1)}
NUMBER = r"-?[0-9]+(?:\.[0-9]+)?"
SHAPE = re.compile(
    r"(bounds|(?:region|obstacle|target) \w+)\s+"
    r"(box ([^;{}]*?\])|polytope \{([^}]*)\}|hull ([^;]*\)))\s*(cm|mm|m|)\s*;"
)
AVOID = re.compile(rf"avoid ([\w, ]+?) with (effector|body)(?: margin ({NUMBER}) (cm|mm|m))?;")


@dataclass(frozen=True)
class Area:
    """Unit normals (m, d), offsets (m,) and corners (k, d) of a convex set, in metres."""

    normals: Array
    offsets: Array
    corners: Array

    def slack(self, points: Array) -> Array:
        """The distance to the nearest facet from inside, for points (..., d or 3)."""
        d = self.normals.shape[1]
        found: Array = np.min(self.offsets - points[..., :d] @ self.normals.T, axis=-1)
        return found

    def distance(self, ends: Array) -> Array:
        """How far segments (n, 2, 3) are from the set; minus a depth where they meet it.

        The depth is a lower bound. In space the ends must be the same and the set a box.
        """
        if self.normals.shape[1] == 3:
            points = ends[:, 0]
            low, high = self.corners.min(axis=0), self.corners.max(axis=0)
            beyond = np.maximum(np.maximum(low - points, points - high), 0)
            away = np.linalg.norm(beyond, axis=1)
            return np.where(away > 0, away, -self.slack(points))
        area = shapely.convex_hull(shapely.multipoints(self.corners))
        shapes = shapely.linestrings(ends[:, :, :2])
        away = shapely.distance(shapes, area)
        middles = shapely.get_coordinates(
            shapely.line_interpolate_point(shapely.intersection(shapes, area), 0.5, normalized=True)
        )
        if len(middles) != len(ends):
            middles = np.array([_middle(shape, area) for shape in shapes])
        depth = np.maximum(self.slack(middles), self.slack(ends).max(axis=1))
        found: Array = np.where(away > 0, away, -np.maximum(depth, 0))
        return found


def _middle(shape: shapely.Geometry, area: shapely.Geometry) -> tuple[float, float]:
    part = shapely.intersection(shape, area)
    where = shapely.centroid(part if not part.is_empty else shape)
    return float(where.x), float(where.y)


def area_of(normals: Sequence[Sequence[float]], offsets: Sequence[float]) -> Area:
    """The bounded set of a x <= b; ValueError where it has no interior."""
    a, b = np.array(normals, dtype=float), np.array(offsets, dtype=float)
    length = np.linalg.norm(a, axis=1)
    a, b = a / length[:, None], b / length
    found = _corners(a, b)
    if _dimension(found) < a.shape[1]:
        raise ValueError("no interior")
    return Area(a, b, found)


def _corners(a: Array, b: Array) -> Array:
    found = []
    for chosen in combinations(range(len(b)), a.shape[1]):
        rows = list(chosen)
        if abs(np.linalg.det(a[rows])) > 1e-9:
            point = np.linalg.solve(a[rows], b[rows])
            if np.all(a @ point <= b + 1e-9):
                found.append(point)
    return np.array(found)


def _dimension(points: Array) -> int:
    return int(np.linalg.matrix_rank(points - points[0], tol=1e-7)) if len(points) else -1


def cell_of(rows: Sequence[str], dimension: int) -> Area:
    """A cell of ``design.json``: lines like ``-x + 3*y <= 11/10``."""
    normals, offsets = [], []
    for row in rows:
        left, right = row.split("<=")
        normal = np.zeros(dimension)
        for sign, factor, axis in re.findall(r"([+-]?) *(?:([0-9/]+)\*)?([xyz])", left):
            normal["xyz".index(axis)] = float(Fraction(f"{sign}{factor or 1}"))
        normals.append(normal)
        offsets.append(float(Fraction(right.strip())))
    return area_of(normals, offsets)


def _box(text: str, scale: Fraction) -> Area:
    sides = re.findall(rf"\[\s*({NUMBER})\s*,\s*({NUMBER})\s*\]", text)
    eye = np.eye(len(sides))
    low, high = ([float(Fraction(side[i]) * scale) for side in sides] for i in (0, 1))
    return area_of([*eye, *(-eye)], [*high, *(-x for x in low)])


def _polytope(text: str, scale: Fraction) -> Area:
    normals, offsets = [], []
    for row in filter(str.strip, text.split(";")):
        left, sign, right = re.split(r"(<=|>=)", row)
        normal = np.zeros(2)
        for mark, axis in re.findall(r"([+-]?)\s*([xy])", left):
            normal["xy".index(axis)] += -1 if mark == "-" else 1
        turn = 1 if sign == "<=" else -1
        normals.append(turn * normal)
        offsets.append(turn * float(Fraction(right.strip()) * scale))
    return area_of(normals, offsets)


def _hull(text: str, scale: Fraction) -> Area:
    pairs = re.findall(rf"\(\s*({NUMBER})\s*,\s*({NUMBER})\s*\)", text)
    points = np.array([[float(Fraction(x) * scale) for x in pair] for pair in pairs])
    rows = ConvexHull(points).equations
    return area_of(rows[:, :-1], -rows[:, -1])


def _shapes(text: str) -> dict[str, Area]:
    found = {}
    for head, _, box, polytope, hull, unit in SHAPE.findall(text):
        kind, inner = (_box, box) if box else (_polytope, polytope) if polytope else (_hull, hull)
        found[head.split()[-1]] = kind(inner, SCALE[unit])
    return found


@dataclass(frozen=True)
class Figures:
    """The numbers of a workspace and a task."""

    areas: dict[str, Area]
    start: str
    start_by: int | None
    reach: str | None
    reach_by: int | None
    rest: bool
    avoids: tuple[tuple[str, str, float], ...]
    efforts: dict[str, Fraction]
    steps: int
    dt: Fraction
    gravity: tuple[float, ...]
    modules: int | None
    task: str

    @property
    def bounds(self) -> Area:
        return self.areas["bounds"]


def figures_of(text: str) -> Figures:
    """Read a spec; ValueError where a set has no interior or a clause another form."""
    bare = re.sub(r"//[^\n]*", "", text)
    start = re.search(r"start in (\w+)(?: by effector (\d+))?( at rest)?;", bare)
    horizon = re.search(rf"horizon (\d+) steps of ({NUMBER}) s;", bare)
    task = re.search(r"task (\w+)", bare)
    if not (start and horizon and task):
        raise ValueError("no start, horizon or task")
    reach = re.search(r"reach (\w+)(?: by effector (\d+))?( at rest)?;", bare)
    pull = re.search(r"gravity \(([^)]*)\)", bare)
    modules = re.search(r"modules <= (\d+);", bare)
    avoids = [
        (name.strip(), subject, float(Fraction(margin or 0) * SCALE[unit]))
        for names, subject, margin, unit in AVOID.findall(bare)
        for name in names.split(",")
    ]
    efforts = re.findall(rf"effort <= ({NUMBER}) (N\*m|N);", bare)
    return Figures(
        _shapes(bare),
        start[1],
        _number(start[2]),
        reach and reach[1],
        _number(reach and reach[2]),
        bool(reach and reach[3]),
        tuple(avoids),
        {unit: Fraction(bound) for bound, unit in efforts},
        int(horizon[1]),
        Fraction(horizon[2]),
        tuple(float(x) for x in pull[1].split(",")) if pull else (),
        int(modules[1]) if modules else None,
        task[1],
    )


def _number(text: str | None) -> int | None:
    return int(text) if text else None
