"""The case study's arm with two free links on a way round its obstacle, by the cells' adjacency."""

from __future__ import annotations

from dataclasses import fields
from functools import cache

import networkx as nx
import numpy as np

from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.robots.normal_form import family_of
from compiler.workspaces.abstraction import abstract
from grammar_lang.load import load
from solvers.search.evaluation import evaluate
from solvers.trajectory.path_following import PathProblem
from tests.conftest import ROOT

THETAS = [np.array(theta) for theta in ((2.23, 3.35), (3.5, 1.75), (1.2, 3.9))]
LABELS = ("tool", "link", "joint", "link", "joint", "base")


@cache
def planned_arm():
    program = load(ROOT / "specs" / "planar_arm.srg").program
    (task,) = program.tasks.values()
    workspace = program.workspaces[task.workspace]
    cells = abstract(workspace)
    family = family_of(program, task)
    model = family.robot(family.replay(LABELS))
    numeric = NumericRobot(robot_graph(model, task.gravity))
    free = [i for i, cell in enumerate(cells.cells) if "O" not in cell.propositions]
    adjacency = nx.Graph((a, b) for a in free for b in cells.neighbours[a] if b in free)
    path = nx.shortest_path(adjacency, cells.index("S"), cells.index("T"))
    return PathProblem(numeric, workspace, task, cells, 0, tuple(path), 2e-3, 0)


@cache
def evaluated(*theta):
    """The outcome at some lengths, by this process alone."""
    return evaluate(planned_arm(), np.array(theta))


def bits(outcome):
    """All that an outcome says."""
    parts = []
    for field in fields(outcome):
        value = getattr(outcome, field.name)
        arrays = [getattr(value, name) for name in ("x", "u", "theta") if hasattr(value, name)]
        parts.append([a.tobytes() for a in arrays] or np.asarray(value).tobytes())
    return parts
