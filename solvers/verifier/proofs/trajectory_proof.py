"""The proof that a claimed robot, so started and so driven, does its task at every instant.

Everything is recomputed from the spec: the robot from its derivation, its equations of motion, the
cells.  Positions of all points are enclosed along a validated tube.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from textwrap import shorten

from flint import arb

from compiler.arithmetic.balls import (
    BallArithmetic,
    ball,
    closed_ball,
    constant_ball,
    scalar_balls,
    working_precision,
)
from compiler.dynamics.absolute_angles import absolute_angles
from compiler.dynamics.equations_of_motion import RobotGraph, robot_graph
from compiler.dynamics.tape import UndefinedValueError, tape
from compiler.geometry.abstraction import Abstraction
from compiler.geometry.polytope import Polytope, polytope_of
from compiler.robots.parameter_values import ExactValue, value_ball
from compiler.robots.robot import RobotModel, RodBody, amounts_of
from compiler.robots.state_and_input import robot_states
from compiler.specifications.formula_text import formula_text
from compiler.specifications.monitor import key
from compiler.specifications.subformulas import atoms
from compiler.specifications.task_formula import missing_effector
from grammar_lang import ir
from solvers.verifier.proofs.cell_path import cell_path
from solvers.verifier.proofs.defined_checks import Defined
from solvers.verifier.proofs.enclosure import Accuracy, EnclosureFailure, VectorField, tube
from solvers.verifier.proofs.finding import Finding, inside, least
from solvers.verifier.proofs.formula_proof import FormulaProof
from solvers.verifier.proofs.region_distance import region_distance
from solvers.verifier.proofs.tube_checks import (
    Apart,
    Inside,
    PointReading,
    StateLimit,
    Status,
    check_segment,
    rows_of,
)

ACCURACIES = (Accuracy(10, 96, 1e-10), Accuracy(14, 128, 1e-15), Accuracy(20, 192, 1e-24))
REST_RATE = Fraction(1, 1000)
"""``reach ... at rest``: all rates below this, in SI units."""
LONGEST_TEXT = 72
"""Characters of a formula in a report."""


@dataclass(frozen=True, slots=True)
class Motion:
    """What drives a robot: exact parameters, initial state and inputs (one row per step).

    ``state`` holds coordinates and rates; the spec says where modules' own states begin.
    """

    theta: tuple[ExactValue, ...]
    state: tuple[Fraction, ...]
    inputs: tuple[tuple[Fraction, ...], ...]
    effector: int
    path: tuple[tuple[str, ...], ...]


@dataclass(frozen=True, slots=True)
class Scene:
    """The robot's graph and the exact sets of its workspace."""

    graph: RobotGraph
    workspace: ir.Workspace
    task: ir.Task
    abstraction: Abstraction

    @property
    def model(self) -> RobotModel:
        """The robot."""
        return self.graph.model

    def polytope(self, region: ir.Region) -> Polytope:
        """The exact set of a region."""
        return polytope_of(region.shape, self.workspace.dimension)


def prove_motion(
    scene: Scene, motion: Motion, tick: Callable[[], None] = lambda: None
) -> tuple[Finding, ...]:
    """All conditions on a motion, at the first accuracy that decides them all, with close margins.

    ``tick`` is called again and again; what it raises ends the proof.
    """
    missing = missing_effector(scene.task, len(scene.model.effectors))
    if missing is not None:
        return (Finding(f"effector {missing} of the task", Status.FAILS, 0.0, ""),)
    decided: tuple[Finding, ...] | None = None
    findings: tuple[Finding, ...] = ()
    for accuracy in ACCURACIES:
        with working_precision(accuracy.bits):
            try:
                findings = _findings(scene, motion, accuracy, tick)
            except UndefinedValueError as error:
                return (Finding(f"equations of motion: {error}", Status.FAILS, 0.0, ""),)
        if any(finding.status is Status.UNDECIDED for finding in findings):
            continue
        decided = findings
        # What fails stays so: only margins of what holds are worth another run.
        failed = any(finding.status is Status.FAILS for finding in findings)
        if failed or not any(finding.loose for finding in findings):
            break
    return findings if decided is None else decided


def _findings(
    scene: Scene, motion: Motion, accuracy: Accuracy, tick: Callable[[], None]
) -> tuple[Finding, ...]:
    graph, task = scene.graph, scene.task
    tail = tuple(value_ball(value) for value in motion.theta)
    tail += tuple(constant_ball(constant) for constant in graph.constants)
    own = robot_states(graph.model)
    field = VectorField(
        tape(graph.balance), tape(graph.variation), len(graph.model.dofs), tail, len(own)
    )
    reading = PointReading(tape(graph.points), field, graph.model.dimension)
    n, coordinates = len(graph.model.dofs), graph.coordinates
    exact = [coordinates.solved_for(part) for part in (motion.state[:n], motion.state[n:])]
    state = [ball(value) for part in exact for value in part]
    state += [arb(0) if item.initial is None else closed_ball(item.initial) for item in own]
    inputs = [[ball(value) for value in step] for step in motion.inputs]
    always = _always(scene, tail)
    limits = _limits(graph)
    found = [_positive_mass(graph, state, tail), *_unphysical(graph.model, tail)]
    found += _start(scene, motion, reading, state)
    if any(finding.status is Status.FAILS for finding in found):
        return tuple(found)
    samples = [state]
    defined = Defined(tape(graph.conditions), graph.divisors, tail)
    formulas = _formulas(scene, reading, tick)
    try:
        for segment in tube(field, state, inputs, ball(task.step), accuracy):
            tick()
            check_segment(reading, segment, inputs[segment.number], always, limits)
            formulas.add(segment, inputs[segment.number])
            if defined.is_needed:
                defined.check(segment, inputs[segment.number])
            if segment.number == len(samples):
                samples.append(state)
            state = list(segment.end)
    except EnclosureFailure as failure:
        found.append(Finding(str(failure), Status.UNDECIDED, 0.0, "m"))
        return tuple(found)
    samples.append(state)
    if defined.is_needed:
        name = "equations of motion defined"
        found.append(Finding(name, defined.status, float("inf"), "", defined.time))
    found += [Finding(c.name, c.status, c.margin, "m", c.time, c.place) for c in always]
    found += [
        Finding(limit.name, limit.status, limit.margin, "SI", limit.time)
        for limit in limits
        if limit.margin < float("inf") or limit.status is not Status.HOLDS
    ]
    positions = [reading.positions(sample) for sample in samples]
    # Whose path a formula is about, and that it holds, is proved without the path.
    following = None if task.satisfy else motion.effector
    found.append(cell_path(scene.abstraction, float(task.step), motion.path, following, positions))
    if task.reach is not None:
        found += _arrival(scene, task.reach, positions[-1][motion.effector], samples[-1])
    found += [_satisfied(number, clause, formulas) for number, clause in enumerate(task.satisfy)]
    return tuple(found)


def _formulas(scene: Scene, reading: PointReading, tick: Callable[[], None]) -> FormulaProof:
    """The atoms of the task's formulas, with the sets they speak of."""
    regions = {
        key(atom): region_distance(scene.polytope(scene.workspace.region(atom.region)))
        for atom in atoms(*(clause.formula for clause in scene.task.satisfy))
    }
    return FormulaProof(reading, regions, scene.task, tick)


def _satisfied(number: int, clause: ir.Satisfy, formulas: FormulaProof) -> Finding:
    """What is proved of a formula; its margin is a bound of its robustness."""
    text = shorten(formula_text(clause.formula), LONGEST_TEXT, placeholder=" …")
    verdict = formulas.verdict(clause.formula)
    name = f"satisfy {number + 1}: {text}"
    return Finding(
        name, verdict.status, verdict.robustness, "m", clause=number, loose=verdict.loose
    )


def _arrival(
    scene: Scene, reach: ir.Reach, tip: Sequence[arb], state: Sequence[arb]
) -> list[Finding]:
    """The effector is in the target at the last instant, at rest where it has to be."""
    end = float(scene.task.step) * scene.task.steps
    target = scene.polytope(scene.workspace.region(reach.region))
    found = [inside(f"target {reach.region}", target, tip, end)]
    if reach.at_rest:
        found.append(_rest("rest at the end", scene.graph, state, end))
    return found


def _always(scene: Scene, tail: Sequence[arb]) -> list[Inside | Apart]:
    """The conditions that hold at every instant: bounds, and every ``avoid``."""
    task, workspace, graph = scene.task, scene.workspace, scene.graph
    effectors = tuple(range(len(graph.model.effectors)))
    bodies = [tuple(len(effectors) + i for i in hull) for hull in graph.hulls]
    bounds = rows_of(scene.polytope(workspace.bounds))
    radii = [_radius(graph.model, i, tail) for i in range(len(bodies))]
    found: list[Inside | Apart] = [Inside("bounds", points=effectors, rows=bounds)]
    if task.bounds_body:
        for points, radius in zip(bodies, radii, strict=True):
            found.append(Inside("bounds of body", points=points, rows=bounds, distance=radius))
    for avoid in task.avoid:
        for name in avoid.regions:
            polytope = scene.polytope(workspace.region(name))
            vertices: tuple[tuple[arb, ...], ...] = ()
            if polytope.is_bounded:
                vertices = tuple(tuple(ball(x) for x in v) for v in polytope.vertices)
            groups: list[tuple[tuple[int, ...], arb]] = [((e,), arb(0)) for e in effectors]
            if avoid.subject == "body":
                groups = list(zip(bodies, radii, strict=True))
            rows = rows_of(polytope)
            for points, radius in groups:
                distance = ball(avoid.margin) + radius
                label = f"clearance of {avoid.subject} to {name}"
                found.append(
                    Apart(label, points=points, rows=rows, vertices=vertices, distance=distance)
                )
    return found


def _radius(model: RobotModel, body: int, tail: Sequence[arb]) -> arb:
    """The radius of a body: that of a capsule, else zero."""
    item = model.bodies[body]
    if not isinstance(item, RodBody) or item.radius is None:
        return arb(0)
    return scalar_balls(model.scalars, tail)[item.radius]


def _limits(graph: RobotGraph) -> list[StateLimit]:
    """Joint limits and rate limits as balls, on the rows of q = D y."""
    found = []
    none = (0,) * len(graph.model.dofs)
    own = (0,) * len(robot_states(graph.model))
    for number, dof in enumerate(graph.model.dofs):
        weights_of = graph.coordinates.rows[number]
        for weights, interval, what in (
            ((*weights_of, *none, *own), dof.range, "range"),
            ((*none, *weights_of, *own), dof.rate, "rate"),
        ):
            if interval is not None:
                ends = closed_ball(interval.lower), closed_ball(interval.upper)
                found.append(StateLimit(f"{what} of joint {number + 1}", weights, *ends))
    return found


def _positive_mass(graph: RobotGraph, state: Sequence[arb], tail: Sequence[arb]) -> Finding:
    """M is positive definite at the start: all pivots of its LDL^T factorisation are positive.

    Along the tube the pivots stay away from zero, or the enclosure would fail, so M stays so.
    """
    n = len(graph.model.dofs)
    flat = tape(graph.mass_matrix).run([*state[:n], *tail], BallArithmetic())
    matrix = [[flat[j * n + i] for j in range(n)] for i in range(n)]
    least = arb("inf")
    for k in range(n):
        pivot = matrix[k][k]
        least = least.min(pivot)
        if not pivot > 0:
            break
        for i in range(k + 1, n):
            for j in range(k + 1, n):
                matrix[i][j] = matrix[i][j] - matrix[i][k] * matrix[k][j] / pivot
    status = Status.HOLDS if least > 0 else Status.FAILS if least < 0 else Status.UNDECIDED
    return Finding("mass matrix positive definite", status, float(least.lower()), "SI", 0.0)


def _unphysical(model: RobotModel, tail: Sequence[arb]) -> list[Finding]:
    """The bodies of which a length, mass, density, radius or moment of inertia is negative."""
    scalars = scalar_balls(model.scalars, tail)
    return [
        Finding(f"amounts of body {number}", Status.FAILS, float(scalars[i].mid()), "SI", 0.0)
        for number, body in enumerate(model.bodies, 1)
        for i in amounts_of(body)
        if scalars[i] < 0
    ]


def _weighed(weights: Sequence[int], values: Sequence[arb]) -> arb:
    return sum((w * x for w, x in zip(weights, values, strict=False) if w), arb(0))


def _rest(name: str, graph: RobotGraph, state: Sequence[arb], time: float) -> Finding:
    """All rates of the joints are below the bound of a rest."""
    rates = [_weighed(row, state[len(row) :]) for row in graph.coordinates.rows]
    return least(name, [ball(REST_RATE) - abs(rate) for rate in rates], "SI", time)


def _start(
    scene: Scene, motion: Motion, reading: PointReading, state: Sequence[arb]
) -> list[Finding]:
    """The initial state is one that the task allows."""
    start, n = scene.task.start, len(scene.model.dofs)
    if isinstance(start, ir.StartAt):
        exact = [closed_ball(value) for value in start.values]
        own = [_weighed(row, state) for row in scene.graph.coordinates.rows]
        near = [ball(Fraction(1, 10**9)) - abs(s - e) for s, e in zip(own, exact, strict=False)]
        if len(exact) != n:
            near = [arb(-1)]
        rest = all(value == 0 for value in motion.state[n:])
        return [
            least("start pose", near, "SI", 0.0),
            Finding("start at rest", Status.HOLDS if rest else Status.FAILS, 0.0, "SI", 0.0),
        ]
    region = scene.polytope(scene.workspace.region(start.region))
    number = motion.effector if start.effector is None else start.effector - 1
    tip = reading.positions(state)[number]
    within = all(abs(value) <= start.rates for value in motion.state[n:])
    rates = float(start.rates - max((abs(v) for v in motion.state[n:]), default=Fraction(0)))
    return [
        inside(f"start {start.region}", region, tip, 0.0),
        Finding("start rates", Status.HOLDS if within else Status.FAILS, rates, "SI", 0.0),
    ]


def scene_of(program: ir.Program, task: ir.Task, model: RobotModel, cells: Abstraction) -> Scene:
    """The scene of a robot in a task."""
    return Scene(
        robot_graph(model, task.gravity, absolute_angles(model)),
        program.workspaces[task.workspace],
        task,
        cells,
    )
