"""A warning about solids that collide as points."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from compiler.checks.smallest_robots import smallest_robots
from compiler.robots.links import links_of
from compiler.robots.robot import RobotModel, RodBody, SolidBody
from compiler.words.derivation import Derivation, emission_order
from grammar_lang import ir
from grammar_lang.diagnostics.diagnostic import Code, Sink


def shape_diagnostics(program: ir.Program, sink: Sink) -> None:
    """Warn of solids whose links have neither a shape nor a rod in some of the smallest robots.

    Only tasks that avoid something with the body are checked; each solid is reported once.
    """
    reported = set[ir.Solid]()
    for task in program.tasks.values():
        semantics = program.grammars[task.grammar].semantics
        if not semantics or not collides(task):
            continue
        for derivation, model in smallest_robots(program, task):
            for solid in _bare_solids(derivation, model, semantics):
                if solid in reported:
                    continue
                reported.add(solid)
                sink.warning(
                    Code.SOLID_WITHOUT_SHAPE,
                    "this solid collides as a point, its centre of mass: its link has no shape",
                    solid.span,
                    "add `box(frame: …, size: …);`, or a sphere, a capsule, a cylinder",
                )


def collides(task: ir.Task) -> bool:
    """Whether a task constrains the body of a robot."""
    with_body = any(avoid.subject == "body" for avoid in task.avoid)
    return with_body or task.avoid_self is not None or task.bounds_body


def _bare_solids(
    derivation: Derivation, model: RobotModel, semantics: Mapping[str, ir.SemanticBlock]
) -> Iterator[ir.Solid]:
    links = links_of(model.frames)
    own = model.bodies[: len(model.bodies) - len(model.payloads)]
    rods = {links.of[body.frame] for body in own if isinstance(body, RodBody)}
    emitted = (
        emission
        for node in emission_order(derivation)
        for emission in semantics[derivation.nodes[node].production.label].emissions
        if not isinstance(emission, ir.Effector | ir.Shape)
    )
    for number, (body, emission) in enumerate(zip(own, emitted, strict=True)):
        bare = number not in model.covered and links.of[body.frame] not in rods
        if isinstance(body, SolidBody) and isinstance(emission, ir.Solid) and bare:
            yield emission
