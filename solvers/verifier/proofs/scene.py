"""The subject of a proof: a robot in a task, and the inputs that drive it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from typing import Protocol, TypeVar

from compiler.dynamics.equations_of_motion import RobotGraph, robot_graph
from compiler.dynamics.rigid_bodies import coordinates_for_intervals
from compiler.robots.collider_names import collider_names
from compiler.robots.parameter_values import ParameterValue
from compiler.robots.robot import RobotModel
from compiler.words.derivation import Derivation
from compiler.workspaces.abstraction import Abstraction
from compiler.workspaces.polytope import Polytope, polytope_of
from grammar_lang import ir
from solvers.verifier.proofs.control_law import ControlLaw
from solvers.verifier.proofs.loop_set import Loop

# --- The watch of a long proof: it receives progress and can end the proof ------------------------


Job = TypeVar("Job")
Result = TypeVar("Result")


class Each(Protocol):
    """Applies a function to each of some jobs."""

    def __call__(
        self, function: Callable[[Job], Result], jobs: Iterable[Job], /
    ) -> Iterator[Result]:
        """The results in the order of the jobs."""
        ...


def in_turn(function: Callable[[Job], Result], jobs: Iterable[Job]) -> Iterator[Result]:
    """Do one job after the other, each when its result is asked for."""
    return map(function, jobs)


class Begin(Protocol):
    """Begins a job that runs alongside the caller."""

    def __call__(self, function: Callable[[Job], Result], job: Job, /) -> Callable[[], Result]:
        """A function that waits for the result; it need not be called."""
        ...


def when_asked(function: Callable[[Job], Result], job: Job) -> Callable[[], Result]:
    """Do a job only when its result is asked for."""
    return lambda: function(job)


@dataclass(frozen=True, slots=True)
class Watch:
    """The callbacks and options of a proof.

    Attributes:
        tick: called repeatedly; an exception from it ends the proof.
        part: called with the number of parts done and the number of all parts: the steps of a
            motion, or the structures of a family. It starts again at zero if work is repeated.
        each: does parts that do not depend on each other, perhaps in several processes: a function
            found by its name in a module, and jobs that can be pickled. Results are in order.
        begin: begins such a part alongside others.
        brief: whether the first condition that fails ends the proof; the others are then unknown.
        roughly: whether conditions that the lowest precision leaves open stay undecided.
    """

    tick: Callable[[], None] = lambda: None
    part: Callable[[int, int], None] = lambda _done, _count: None
    each: Each = in_turn
    begin: Begin = when_asked
    brief: bool = False
    roughly: bool = False


UNWATCHED = Watch()


@dataclass(frozen=True, slots=True)
class Motion:
    """What drives a robot: exact parameters, initial state and inputs (one row per step).

    ``state`` holds coordinates and rates; the spec gives the initial values of the modules' own
    states. All numbers are in SI units. With a ``law``, inputs are those of the motion without
    deviations. With a ``loop`` the motion goes on for ever.
    """

    theta: tuple[ParameterValue, ...]
    state: tuple[Fraction, ...]
    inputs: tuple[tuple[Fraction, ...], ...]
    effector: int
    path: tuple[tuple[str, ...], ...]
    law: ControlLaw | None = None
    loop: Loop | None = None


@dataclass(frozen=True, slots=True)
class Scene:
    """The robot's graph and the exact sets of its workspace; ``bodies`` names the bodies."""

    graph: RobotGraph
    workspace: ir.Workspace
    task: ir.Task
    abstraction: Abstraction
    bodies: tuple[str, ...] = ()

    @property
    def model(self) -> RobotModel:
        """The robot."""
        return self.graph.model

    def __reduce__(self) -> tuple[object, ...]:
        """Pickle the robot model instead of the graph, which is built again."""
        return _scene, (self.model, self.workspace, self.task, self.abstraction, self.bodies)

    def polytope(self, region: ir.Region) -> Polytope:
        """The exact set of a region."""
        return polytope_of(region.shape, self.workspace.dimension)

    def body(self, number: int) -> str:
        """The name of a collider of the model, by its number from 0."""
        return self.bodies[number] if self.bodies else self.model.collider_names[number]


def scene_of(
    program: ir.Program,
    task: ir.Task,
    model: RobotModel,
    cells: Abstraction,
    derivation: Derivation | None = None,
) -> Scene:
    """The scene of a robot in a task; colliders are named after modules of the derivation."""
    bodies: tuple[str, ...] = ()
    if derivation is not None:
        bodies = collider_names(program, program.grammars[task.grammar], derivation, model)
    return _scene(model, program.workspaces[task.workspace], task, cells, bodies)


def _scene(
    model: RobotModel,
    workspace: ir.Workspace,
    task: ir.Task,
    cells: Abstraction,
    bodies: tuple[str, ...],
) -> Scene:
    graph = robot_graph(model, task.gravity, coordinates_for_intervals(model))
    return Scene(graph, workspace, task, cells, bodies)
