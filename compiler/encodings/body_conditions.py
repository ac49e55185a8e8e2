"""What a task asks of the whole body of a robot at any instant, in the plane."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from compiler.encodings.region_terms import PolygonTerms, polygon_terms
from compiler.workspaces.polytope import Polytope, polytope_of
from grammar_lang import ir

MOST = 24
"""Of more obstacles, those farthest from the middle of the bounds are left out of a script."""


@dataclass(frozen=True, slots=True)
class BodyConditions:
    """Obstacles that bodies and effectors stay out of; ``bounds_body``: bodies keep the bounds.

    Margins and the radii of rods are left out, which can only add poses.
    """

    bodies: tuple[PolygonTerms, ...]
    effectors: tuple[PolygonTerms, ...]
    bounds_body: bool


def body_conditions(workspace: ir.Workspace, task: ir.Task) -> BodyConditions | None:
    """The demands of a task; None where it asks nothing of bodies, and in space."""
    bodies = _avoided(task, "body")
    if workspace.dimension != 2 or not (bodies or task.bounds_body):
        return None
    return BodyConditions(
        _polygons(workspace, bodies),
        _polygons(workspace, _avoided(task, "effector")),
        task.bounds_body,
    )


def _avoided(task: ir.Task, subject: str) -> tuple[str, ...]:
    """The regions that an ``avoid`` of that subject names, each once, as they are named."""
    names = (name for item in task.avoid if item.subject == subject for name in item.regions)
    return tuple(dict.fromkeys(names))


def _polygons(workspace: ir.Workspace, names: tuple[str, ...]) -> tuple[PolygonTerms, ...]:
    shapes = (polytope_of(workspace.region(name).shape, workspace.dimension) for name in names)
    terms = [found for found in map(polygon_terms, shapes) if found is not None]
    middle = polytope_of(workspace.bounds.shape, workspace.dimension)
    if len(terms) > MOST:
        terms.sort(key=lambda polygon: _distance(polygon, middle))
    return tuple(terms[:MOST])


def _distance(polygon: PolygonTerms, bounds: Polytope) -> Fraction:
    """The squared distance between the means of the vertices, m^2."""
    centre = [sum(column, Fraction(0)) / len(polygon.vertices)
              for column in zip(*polygon.vertices, strict=True)]  # fmt: skip
    return sum(((x - y) ** 2 for x, y in zip(centre, bounds.centre, strict=True)), Fraction(0))
