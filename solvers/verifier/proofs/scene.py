"""What a proof is about: a robot in a task, and what drives it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Protocol, TypeVar

from compiler.dynamics.equations_of_motion import RobotGraph, robot_graph
from compiler.dynamics.rigid_bodies import coordinates_for_intervals
from compiler.robots.parameter_values import ParameterValue
from compiler.robots.robot import RobotModel
from compiler.words.derivation import Derivation, body_symbols
from compiler.workspaces.abstraction import Abstraction
from compiler.workspaces.polytope import Polytope, polytope_of
from grammar_lang import ir
from solvers.verifier.proofs.control_law import ControlLaw
from solvers.verifier.proofs.loop_set import Loop

# --- Who watches a long proof: told how far it has come, and able to end it -----------------------


Job = TypeVar("Job")
Result = TypeVar("Result")


class Each(Protocol):
    """Does each of some jobs."""

    def __call__(
        self, function: Callable[[Job], Result], jobs: Iterable[Job], /
    ) -> Iterator[Result]:
        """The results in the order of the jobs."""
        ...


def in_turn(function: Callable[[Job], Result], jobs: Iterable[Job]) -> Iterator[Result]:
    """One job after the other, when its result is asked for."""
    return map(function, jobs)


class Begin(Protocol):
    """Begins a job beside what is done here."""

    def __call__(self, function: Callable[[Job], Result], job: Job, /) -> Callable[[], Result]:
        """What waits for its result; that may never be asked for."""
        ...


def when_asked(function: Callable[[Job], Result], job: Job) -> Callable[[], Result]:
    """A job that is done when its result is asked for."""
    return lambda: function(job)


@dataclass(frozen=True, slots=True)
class Watch:
    """What a proof calls as it goes on.

    Attributes:
        tick: called again and again; what it raises ends the proof.
        part: told how many of all parts of the work are done: of the steps of a motion, or of the
            structures of a family.  Work that is done again begins at none.
        each: does parts that do not depend on each other, perhaps in several processes: a function
            found by its name in a module, and jobs that can be pickled.  Results are in order.
        begin: begins such a part beside others.
        brief: whether the first condition that fails ends the proof; others are then not known.
        roughly: whether what the fewest digits do not decide stays undecided.
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

    ``state`` holds coordinates and rates; the spec says where modules' own states begin.  All
    numbers are in SI units.  With a ``law``, inputs are those of the motion without deviations.
    With a ``loop`` the motion goes on for ever.
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
        """Of the robot alone: graphs are not pickled, but made again."""
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
    """The scene of a robot in a task; what collides is named after modules of its derivation."""
    bodies: tuple[str, ...] = ()
    if derivation is not None:
        semantics = program.grammars[task.grammar].semantics or {}
        own, shapes = body_symbols(derivation, semantics)
        if len(own) + len(model.payloads) == len(model.bodies) and len(shapes) == len(model.shapes):
            symbols = [s for number, s in enumerate(own) if number not in model.covered]
            bodies = _named(model, [*symbols, *shapes], derivation.word)
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


def _named(
    model: RobotModel, symbols: Sequence[int | None], word: Sequence[str]
) -> tuple[str, ...]:
    """With the module that each belongs to; where several say what it is, the first of these."""
    owners = model.collider_owners or (None,) * len(symbols)
    known = [
        symbol if owner is None else owner.symbol
        for symbol, owner in zip(symbols, owners, strict=True)
    ]
    return tuple(
        name + ("" if symbol is None else f" ({word[symbol]} at symbol {symbol})")
        for name, symbol in zip(model.collider_names, known, strict=True)
    )
