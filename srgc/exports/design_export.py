"""The robot of a design as it is exported: its tree of links with names, motors and remarks."""

from __future__ import annotations

from fractions import Fraction
from importlib.metadata import version

from compiler.graphs.labelled_graph import labelled_graph
from compiler.rigid_links.effector_modules import effector_modules
from compiler.rigid_links.part_names import part_names
from compiler.rigid_links.rigid_tree import rigid_tree
from compiler.rigid_links.viscous_friction import viscous_friction
from compiler.robots.robot import RobotModel
from compiler.robots.state_and_input import robot_inputs
from grammar_lang import ir
from srgc.exports.exported_robot import ExportedRobot
from srgc.exports.mjcf import mjcf_text
from srgc.exports.urdf import urdf_text
from srgc.results.found_design import FoundDesign
from srgc.session import UsageFault

WRITERS = {"urdf": urdf_text, "mjcf": mjcf_text}


def export_text(design: FoundDesign, form: str) -> str:
    """The robot of a design as ``urdf`` or ``mjcf``.

    Raises:
        UsageFault: it is no tree of rigid links, or a link has an inertia that no body has.
    """
    try:
        return WRITERS[form](exported_robot(design))
    except ValueError as error:
        raise UsageFault(f"the robot cannot be exported: {error}") from None


def exported_robot(design: FoundDesign) -> ExportedRobot:
    """What the export of a design is made of.

    Raises:
        RigidTreeError: the robot is no tree of rigid links with a joint per degree of freedom.
    """
    model, task = design.model, design.task
    tree = rigid_tree(model, design.theta)
    grammar = design.program.grammars[task.grammar]
    modules = design.program.modules
    graph = labelled_graph(design.program, grammar, design.derivation)
    tools = effector_modules(design.derivation, grammar.semantics or {}, modules)
    gravity = [float(value) for value in task.gravity] + [0.0] * 3
    coordinates = design.start[: 2 * len(model.dofs)]
    return ExportedRobot(
        task.name,
        tree,
        part_names(model, tree, graph, modules, tools),
        tuple(motor_bound(model, task, dof) for dof in range(len(model.dofs))),
        _dampings(design),
        (gravity[0], gravity[1], gravity[2]),
        task.step,
        tuple(float(value) for value in coordinates),
        (*_origin(design), *left_out(design)),
    )


def motor_bound(model: RobotModel, task: ir.Task, dof: int) -> float | None:
    """The least bound of the task on the free input of a degree of freedom (N m or N)."""
    if all(item.dof != dof for item in robot_inputs(model)):
        return None
    kind = model.dofs[dof].kind
    bounds: list[Fraction] = [item.bound for item in task.effort if item.kind == kind]
    return float(min(bounds)) if bounds else None


def _dampings(design: FoundDesign) -> tuple[float, ...]:
    """The viscous friction of every degree of freedom that has no other dynamics of its own."""
    found = [0.0] * len(design.model.dofs)
    for own in design.model.own:
        for dof, damping in (viscous_friction(own, design.theta) or {}).items():
            found[dof] = float(damping)
    return tuple(found)


def left_out(design: FoundDesign) -> tuple[str, ...]:
    """What of a robot an export does not hold."""
    others = [own for own in design.model.own if viscous_friction(own, design.theta) is None]
    modules = sorted({(own.symbol, own.module) for own in others})
    if not modules:
        return ()
    names = ", ".join(f"{module} (symbol {symbol})" for symbol, module in modules)
    remark = f"the dynamics of their own of {names} are left out; every joint has a plain motor"
    return (remark,)


def _origin(design: FoundDesign) -> tuple[str, ...]:
    claim = design.claim
    flat = "in the plane xy, where only moments of inertia about z act on the motion"
    plane = (flat,) if design.model.dimension == 2 else ()
    return (
        f"robot: {' '.join(claim.word)}",
        f"of {claim.spec}, task {claim.task}, spec_sha256 {claim.spec_sha256}",
        f"exported by srgc {version('srgc')}; SI units",
        *plane,
    )
