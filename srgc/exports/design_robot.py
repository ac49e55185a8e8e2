"""The robot of a design as it is exported: its tree of links with names, motors and remarks."""

from __future__ import annotations

from fractions import Fraction

from compiler.rigid_links.rigid_tree import rigid_tree
from compiler.robots.robot import RobotModel
from compiler.robots.state_and_input import robot_inputs
from grammar_lang import ir
from srgc.exports.design_names import design_names
from srgc.exports.exported_robot import ExportedRobot
from srgc.exports.friction import dampings, left_out
from srgc.results.found_design import FoundDesign
from srgc.version import VERSION


def exported_robot(design: FoundDesign) -> ExportedRobot:
    """What the export of a design is made of.

    Raises:
        RigidTreeError: the robot is no tree of rigid links with a joint per degree of freedom.
    """
    model, task = design.model, design.task
    tree = rigid_tree(model, design.stated)
    gravity = [float(value) for value in task.gravity] + [0.0] * 3
    coordinates = design.start[: 2 * len(model.dofs)]
    flat = "in the plane xy, where only moments of inertia about z act on the motion"
    plane = (flat,) if model.dimension == 2 else ()
    return ExportedRobot(
        task.name,
        tree,
        design_names(design, tree),
        tuple(motor_bound(model, task, dof) for dof in range(len(model.dofs))),
        dampings(design),
        (gravity[0], gravity[1], gravity[2]),
        task.step,
        tuple(float(value) for value in coordinates),
        (*origin(design), *plane, *remarks(design)),
    )


def motor_bound(model: RobotModel, task: ir.Task, dof: int) -> float | None:
    """The least bound of the task on the free input of a degree of freedom (N m or N)."""
    if all(item.dof != dof for item in robot_inputs(model)):
        return None
    kind = model.dofs[dof].kind
    bounds: list[Fraction] = [item.bound for item in task.effort if item.kind == kind]
    return float(min(bounds)) if bounds else None


def remarks(design: FoundDesign) -> tuple[str, ...]:
    """What of a robot an export does not hold."""
    others = left_out(design)
    return (f"{others} are left out; every joint has a plain motor",) if others else ()


def origin(design: FoundDesign) -> tuple[str, ...]:
    """Lines that say what a file is made from."""
    claim = design.claim
    return (
        f"robot: {' '.join(claim.word)}",
        f"of {claim.spec}, task {claim.task}, spec_sha256 {claim.spec_sha256}",
        f"exported by srgc {VERSION}; SI units",
    )
