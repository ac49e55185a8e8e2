"""What is read off a robot's graph for a person."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from compiler.dynamics.equations_of_motion import RobotGraph, robot_graph
from compiler.formulas.trigonometric_reading import Formulas, formulas
from compiler.robots.robot import RobotModel


@dataclass(frozen=True, slots=True)
class ModelReading:
    """The functions of a robot's equations of motion as formulas, in the joints' coordinates.

    ``mass`` holds the entries of M on and above its diagonal row by row, ``centrifugal`` c (n,),
    ``gravitational`` g (n,), ``effectors`` positions (d * e,).
    """

    model: RobotModel
    gravity: tuple[Fraction, ...]
    graph: RobotGraph
    mass: Formulas
    centrifugal: Formulas
    gravitational: Formulas
    effectors: Formulas


def model_reading(model: RobotModel, gravity: tuple[Fraction, ...] = ()) -> ModelReading:
    """Read a robot; ``gravity`` in m/s^2."""
    graph, n = robot_graph(model, gravity), len(model.dofs)
    return ModelReading(
        model,
        gravity,
        graph,
        formulas(graph, graph.mass_matrix, [j * n + i for i in range(n) for j in range(i, n)]),
        formulas(graph, graph.centrifugal),
        formulas(graph, graph.gravitational),
        formulas(graph, graph.effectors),
    )
