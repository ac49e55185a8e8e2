"""The robot of a design for export in any format: its links, joints and names."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

from compiler.expressions.exact_numbers import rational_bounds
from compiler.rigid_links.rigid_tree import LinkJoint, RigidTree, RigidTreeError, rigid_tree
from compiler.robots.labelled_graph import LabelledGraph, labelled_graph
from compiler.robots.payloads import loads_of
from compiler.robots.robot import RobotModel
from compiler.robots.state_and_input import RobotInput, robot_inputs
from compiler.words.derivation import Derivation, DerivationNode, emission_order
from grammar_lang import ir
from grammar_lang.ir.expression_text import number_text
from solvers.verifier.claims.certificate import exact
from srgc.exports.joint_drives import JointDrive, joint_drives, viscous_friction
from srgc.exports.visual_meshes import VisualMesh, pictured_model, visual_meshes
from srgc.results.found_design import FoundDesign
from srgc.version import VERSION

# --------------------------------------------------------------------------------------------------
# Names of links, joints and effectors: from modules and their places.


COLUMNS = frozenset({"t", "robot"})
"""Names of columns beside those of joints."""
WORLD = "world"
"""The frame in which all stand, which is no link."""


@dataclass(frozen=True, slots=True)
class PartNames:
    """Unique names of the links and effectors of a rigid tree, and of its degrees of freedom."""

    links: tuple[str, ...]
    joints: tuple[str, ...]
    effectors: tuple[str, ...]


def part_names(
    model: RobotModel,
    tree: RigidTree | None,
    graph: LabelledGraph,
    modules: Mapping[str, ir.Module],
    tools: Sequence[int | None],
) -> PartNames:
    """Names like ``L_4``: the module and its index in the word, unless the module is ``named``.

    A joint is named after the joint modules that it was merged from, a link after its first module
    with a name of its own or else with the role link, the base after the first base, and a link
    without such a module after its joint.  An effector is named after its module at the place in
    ``tools`` (``effector_modules``), or if that is None, ``effector_1`` and so on by its own
    number.  If the robot is not a tree of rigid links (None), links get no names.
    """
    moving, bodies = UnusedNames({*COLUMNS, *_other_inputs(model)}), UnusedNames({WORLD})
    role = {node.place: modules[node.module].role for node in graph.nodes}
    own = {node.place: modules[node.module].named for node in graph.nodes}
    usual = {node.place: f"{node.module}_{node.place}" for node in graph.nodes}
    joints = [moving.name("_".join(parts)) for parts in _joint_names(model, graph, modules)]

    def body(called: str | None, otherwise: str) -> str:
        # A link may be called as a joint is, but only if somebody calls it so.
        return bodies.name(otherwise, joints) if called is None else bodies.name(called)

    links = list[str]()
    if tree is not None:
        owners = _owners(model, tree, graph)
        called: dict[int, str] = {}
        first: dict[int, str] = {0: "base"}
        for place in reversed(usual):
            text = own[place]
            if text is not None and role[place] != "effector":
                called[owners[place]] = text
            if role[place] == ("base" if owners[place] == 0 else "link"):
                first[owners[place]] = usual[place]
        links.append(body(called.get(0), first[0]))
        for number, link in enumerate(tree.links[1:], start=1):
            dof = link.joint.dof if link.joint is not None else 0
            links.append(body(called.get(number), first.get(number, f"{joints[dof]}_link")))
    effectors = [
        body(None, f"effector_{number}") if place is None else body(own[place], usual[place])
        for number, place in enumerate(tools, start=1)
    ]
    return PartNames(tuple(links), tuple(joints), tuple(effectors))


def _joint_names(
    model: RobotModel, graph: LabelledGraph, modules: Mapping[str, ir.Module]
) -> list[list[str]]:
    """For each degree of freedom of a robot, the names of the joints that are merged into it."""
    joints = [
        dof.named or f"{node.module}_{node.place}" + (f"_{dof.name}" if len(dofs) > 1 else "")
        for node in sorted(graph.nodes, key=lambda node: node.place)
        for dofs in [modules[node.module].dofs]
        for dof in dofs
    ]
    names: list[list[str]] = [[] for _ in model.dofs]
    for text, found in zip(joints, model.word_dofs, strict=True):
        if found.dof is not None:
            names[found.dof].append(text)
    return names


def input_name(item: RobotInput) -> str:
    """The name of an input that is no motor's: that of a load, or after its module."""
    own = item.name.replace(" ", "_")
    return own if item.is_load else f"{item.module}_{item.symbol}.{own}"


def _other_inputs(model: RobotModel) -> Iterator[str]:
    return (input_name(item) for item in robot_inputs(model) if item.dof is None)


class UnusedNames:
    """Gives every name once; a name that is ``taken`` or given gets a number."""

    def __init__(self, taken: Iterable[str]) -> None:
        self.given = set(taken)

    def name(self, wanted: str, besides: Collection[str] = ()) -> str:
        """The name, or its first numbered form that is free, and not one of those ``besides``."""
        taken = self.given.union(besides)
        found = next(item for item in _forms(wanted) if item not in taken)
        self.given.add(found)
        return found


def _forms(wanted: str) -> Iterator[str]:
    yield wanted
    number = 2
    while True:
        yield f"{wanted}_no{number}"
        number += 1


def _owners(model: RobotModel, tree: RigidTree, graph: LabelledGraph) -> dict[int, int]:
    """The link of every module, by place: the link moved by it or by the joint module below it.

    If a joint module moves several links, it is the last of them.
    """
    owners = {
        place: number for number, joint in tree.carried() for place in model.dofs[joint.dof].symbols
    }
    lower = {edge.upper: edge.lower for edge in graph.edges}
    for node in graph.nodes:
        climbed = _climb(node.place, lower, owners)
        owner = owners.get(climbed[-1], 0)
        owners.update(dict.fromkeys(climbed, owner))
    return owners


def _climb(place: int, lower: Mapping[int, int], known: Mapping[int, int]) -> Sequence[int]:
    """The modules below a place, down to the first with a known link, or to a root."""
    places = [place]
    while places[-1] not in known and places[-1] in lower:
        places.append(lower[places[-1]])
    return places


def effector_modules(
    derivation: Derivation,
    semantics: Mapping[str, ir.SemanticBlock],
    modules: Mapping[str, ir.Module],
) -> tuple[int | None, ...]:
    """The place in the word of every effector, in the order of their numbers in the language.

    An effector belongs to a module if the production that emits it emits no other and has exactly
    one module of the role effector; otherwise its place is None.
    """
    found: list[int | None] = []
    for number in emission_order(derivation):
        node = derivation.nodes[number]
        emissions = semantics[node.production.label].emissions
        count = sum(isinstance(emission, ir.Effector) for emission in emissions)
        places = [place for place, name in _modules(node) if modules[name].role == "effector"]
        found += places if (count, len(places)) == (1, 1) else [None] * count
    return tuple(found)


def _modules(node: DerivationNode) -> list[tuple[int, str]]:
    """The modules of a production by place and name."""
    symbols = zip(node.children, node.production.right, strict=True)
    return [(place, symbol.name) for place, symbol in symbols if symbol.kind == "module"]


# --- Names of the parts of a design ---------------------------------------------------------------


def design_tree(design: FoundDesign) -> RigidTree | None:
    """The tree of rigid links of a design, or None if its robot is not one."""
    try:
        return rigid_tree(design.model, design.stated)
    except RigidTreeError:
        return None


def design_names(design: FoundDesign, tree: RigidTree | None) -> PartNames:
    """The names of joints and effectors, and of links if there is a tree."""
    grammar = design.program.grammars[design.task.grammar]
    modules = design.program.modules
    graph = labelled_graph(design.program, grammar, design.derivation)
    tools = effector_modules(design.derivation, grammar.semantics or {}, modules)
    return part_names(design.model, tree, graph, modules, tools)


# --- Dynamics that other formats cannot represent -------------------------------------------------


def left_out(design: FoundDesign) -> str | None:
    """The modules whose dynamics URDF and MJCF cannot represent, as text; None if there is none."""
    others = [own for own in design.model.own if viscous_friction(own, design.stated) is None]
    modules = sorted({(own.symbol, own.module) for own in others})
    if not modules:
        return None
    names = ", ".join(f"{module} (symbol {symbol})" for symbol, module in modules)
    return f"the dynamics of their own of {names}"


# --- The exported robot ---------------------------------------------------------------------------


def exported_robot(design: FoundDesign, factors: Sequence[float] = ()) -> ExportedRobot:
    """The robot of a design for export; ``factors`` multiply the masses of its bodies.

    Raises:
        RigidTreeError: a number of the robot has no value.
    """
    model, task = design.model, design.task
    seen = pictured_model(design)
    tree = rigid_tree(seen, design.stated, factors)
    gravity = [float(value) for value in task.gravity] + [0.0] * 3
    coordinates = design.start[: 2 * len(model.dofs)]
    flat = "in the plane xy, where only moments of inertia about z act on the motion"
    plane = (flat,) if model.dimension == 2 else ()
    return ExportedRobot(
        task.name,
        tree,
        design_names(design, tree),
        tuple(motor_bound(model, task, dof) for dof in range(len(model.dofs))),
        joint_drives(model, design.stated),
        (gravity[0], gravity[1], gravity[2]),
        task.step,
        tuple(float(value) for value in coordinates),
        (*origin(design), *plane, *remarks(design)),
        visual_meshes(design, seen),
    )


def motor_bound(model: RobotModel, task: ir.Task, dof: int) -> float | None:
    """The smallest bound on the free input of a degree of freedom (N m or N), or None."""
    if all(item.dof != dof for item in robot_inputs(model)):
        return None
    kind, own = model.dofs[dof].kind, model.dofs[dof].effort
    bounds: list[Fraction] = [item.bound for item in task.effort if item.kind == kind]
    bounds += [] if own is None else [rational_bounds(own)[0]]
    return float(min(bounds)) if bounds else None


def remarks(design: FoundDesign) -> tuple[str, ...]:
    """Remarks on parts of a robot that an export leaves out, and on what it carries."""
    others = left_out(design)
    found = [f"{others} are left out; every joint has a plain motor"] if others else []
    if design.task.carries:
        found.append("what is taken up and put down is left out: the robot is without it")
    for payload in design.task.payloads:
        who = "" if payload.effector is None else f" of effector {payload.effector}"
        found.append(f"the payload{who}, {number_text(payload.mass)} kg, is part of the robot")
    return tuple(found)


# --- Loads in each step ---------------------------------------------------------------------------


def load_rows(design: FoundDesign) -> tuple[tuple[float, ...], ...]:
    """Which loads are carried, 1 or 0, in a row (c,) for each step."""
    first = len(robot_inputs(design.model)) - len(design.task.carries)
    return tuple(tuple(float(exact(text)) for text in row[first:]) for row in design.claim.inputs)


def load_states(design: FoundDesign) -> tuple[tuple[float, ...], ...]:
    """The distinct rows of loads in a motion, beginning with no load."""
    none = (0.0,) * len(design.task.carries)
    return tuple(dict.fromkeys([none, *load_rows(design)]))


def body_factors(design: FoundDesign, loads: Sequence[float]) -> list[float]:
    """The factors of the masses of bodies: those of ``loads`` for loads, 1 for others."""
    found = [1.0] * len(design.model.bodies)
    for body, there in zip(loads_of(design.model), loads, strict=True):
        found[body] = there
    return found


def origin(design: FoundDesign) -> tuple[str, ...]:
    """Lines that state the source of a file."""
    claim = design.claim
    return (
        f"robot: {' '.join(claim.word)}",
        f"of {claim.spec}, task {claim.task}, spec_sha256 {claim.spec_sha256}",
        f"exported by srgc {VERSION}; SI units",
    )


# --- Types ----------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Motor:
    """The motor of a joint: its name, the index of the link it moves, and its effort limit."""

    name: str
    link: int
    joint: LinkJoint
    bound: float | None
    drive: JointDrive


@dataclass(frozen=True, slots=True)
class ExportedRobot:
    """A robot with the numbers of its task.

    ``efforts`` are the effort limits of the motors by degree of freedom (N m, N), None for no
    limit; ``drives`` are their drives.  ``gravity`` is in m/s^2, and ``step`` is the step of the
    task in seconds.  ``start`` has coordinates and rates, or is empty; ``remarks`` are lines for
    readers.  A link with ``visuals`` is shown only by these.
    """

    name: str
    tree: RigidTree
    names: PartNames
    efforts: tuple[float | None, ...]
    drives: tuple[JointDrive, ...]
    gravity: tuple[float, float, float]
    step: Fraction
    start: tuple[float, ...]
    remarks: tuple[str, ...]
    visuals: tuple[VisualMesh, ...] = ()

    def motors(self) -> Iterator[Motor]:
        """The motors in the order of the degrees of freedom.

        Raises:
            RigidTreeError: a degree of freedom moves several links, which no motor at one joint
                does.
        """
        if (coupled := self.tree.coupled) is not None:
            raise RigidTreeError(f"degree of freedom {coupled + 1} moves several frames")
        for link, joint in self.tree.carried():
            dof = joint.dof
            name, drive = self.names.joints[dof], self.drives[dof]
            yield Motor(name, link, joint, self.efforts[dof], drive)
