"""Arms of two free links on a way round obstacles, by the cells' adjacency."""

from __future__ import annotations

from dataclasses import fields
from functools import cache

import networkx as nx
import numpy as np

from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.robots.normal_form import family_of
from compiler.workspaces.abstraction import abstract
from grammar_lang.load import load_text
from solvers.search.evaluation import evaluate
from solvers.trajectory.path_following import PathProblem
from tests.conftest import ROOT

THETAS = [np.array(theta) for theta in ((2.23, 3.35), (3.5, 1.75), (1.2, 3.9))]
LABELS = ("tool", "link", "joint", "link", "joint", "base")


def planned(text: str, margin: float = 2e-3) -> PathProblem:
    """The arm of a specification in its one task, from S to T past O."""
    program = load_text(text, "arm.srg").program
    assert program is not None
    (task,) = program.tasks.values()
    workspace = program.workspaces[task.workspace]
    cells = abstract(workspace)
    family = family_of(program, task)
    model = family.robot(family.replay(LABELS))
    numeric = NumericRobot(robot_graph(model, task.gravity))
    free = [i for i, cell in enumerate(cells.cells) if "O" not in cell.propositions]
    adjacency = nx.Graph((a, b) for a in free for b in cells.neighbours[a] if b in free)
    path = nx.shortest_path(adjacency, cells.index("S"), cells.index("T"))
    return PathProblem(numeric, workspace, task, cells, 0, tuple(path), margin, 0)


def planned_spec(name: str) -> PathProblem:
    """That of one of the specifications that come with srgc."""
    return planned((ROOT / "specs" / f"{name}.srg").read_text(encoding="utf-8"))


@cache
def planned_arm() -> PathProblem:
    """That of the case study."""
    return planned_spec("planar_arm")


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
