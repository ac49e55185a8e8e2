r"""Dry friction as additional inputs of the equations of motion.

Coulomb friction of size c is any measurable :math:`f \in -c\,\operatorname{Sgn}(\dot q)`, an effort
on its joint. Here f is an input, so the user of the graph decides which values it may have.
"""

from __future__ import annotations

from dataclasses import replace

import casadi as ca

from compiler.dynamics.equations_of_motion import RobotGraph
from compiler.dynamics.kinematics import generalised_forces
from compiler.robots.state_and_input import dry_friction


def with_dry_friction(graph: RobotGraph) -> RobotGraph:
    """The robot graph with the efforts of dry friction (N m, N) as its last inputs.

    They are in the order of the joints that have friction; without such joints the graph is
    unchanged.
    """
    rubbing = list(dry_friction(graph.model))
    if not rubbing:
        return graph
    p, friction = graph.parts, ca.SX.sym("friction", len(rubbing))
    forces = ca.SX(len(graph.model.dofs), 1)
    for place, joint in enumerate(rubbing):
        forces[joint] = friction[place]
    added = generalised_forces(graph.coordinates, forces)
    return replace(graph, parts=replace(p, u=ca.vertcat(p.u, friction), forces=p.forces + added))
