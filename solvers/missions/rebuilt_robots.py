"""A robot for each task of a mission, rebuilt between tasks at the lowest cost.

The robots of all tasks are layers of a graph whose edges are weighted by the costs of rebuilding; a
mission is a path through it.  Only robots on a cheapest path are tried: first whether they are
refuted, then for motions.  If all robots of a path have motions, but with parameters that kept
modules cannot share, boxes of parameters are cut, and the search for a path continues.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import pairwise

from compiler.missions.chains import ChainCosts, Link, cheapest_chain
from compiler.missions.open_layers import fixes
from compiler.missions.parameter_boxes import BoxTree, Cut, choices_halved, whole_box
from compiler.missions.parameter_ranges import Ranges, meet, ranges_of, single
from compiler.missions.robot_changes import Built, Changes, built, built_of, changes
from compiler.time_limits.time_limit import current_limit
from compiler.words.derivation import Derivation
from grammar_lang import ir
from solvers.conclusion import MOTION_SEARCHES
from solvers.missions.kept_parameters import KeptParameters, LinkedRobot
from solvers.missions.mission_result import BoxEvidence, CutRobot, Existing
from solvers.missions.shared_values import (
    Candidate,
    Group,
    agreed,
    cut_between,
    is_within,
    pinned,
    proved_at_once,
    widest_disagreement,
)
from solvers.missions.task_robots import NO_COVERING, Labels, TaskRobots
from solvers.missions.undecided_robots import Undecided
from solvers.search.path_task import Design

MOST_CUTS = 40
"""The most boxes that are cut; robots that still disagree then are left undecided."""
UNSUITED = "its parameters do not suit the existing robot"


@dataclass(slots=True, eq=False)
class Node:
    """The robots of a structure with parameters in a box, for one task."""

    layer: int
    rank: int
    derivation: Derivation
    cut: CutRobot
    leaf: BoxTree
    screened: bool = False
    undecided: Undecided | None = None
    design: Design | None = None
    narrow: bool = False
    """Whether its parameters are known more closely than by their domains."""


@dataclass(slots=True)
class RebuiltSearch:
    """The search in progress; ``found`` are the designs of the cheapest chain."""

    tasks: Sequence[TaskRobots]
    mission: ir.Mission
    prices: ir.Prices
    existing: Existing | None = None
    ranked: Sequence[Derivation] = ()
    """All structures, in order of preference."""
    found: tuple[Design, ...] = ()
    stopped: str | None = None
    failed: int = 0
    """The number of searches for motions without a result."""
    cuts: int = 0
    wanted: bool = False
    """Whether the limit kept further boxes from being cut."""
    cut: dict[tuple[int, Labels], CutRobot] = field(
        default_factory=dict[tuple[int, Labels], CutRobot]
    )
    """Robots whose boxes were cut, by index of the task and derivation."""
    incumbent: tuple[Design, ...] = ()
    """Designs of a chain that were proved at once, in case the time is up before better ones."""
    costs: ChainCosts = field(init=False)
    kept: KeptParameters = field(init=False)
    layers: list[list[Node]] = field(init=False)
    _modules: frozenset[str] = field(init=False)
    _blocked: list[tuple[Node, Node]] = field(default_factory=list[tuple[Node, Node]])
    _links: dict[int, tuple[Node, Link]] = field(default_factory=dict[int, tuple[Node, Link]])

    def __post_init__(self) -> None:
        self._modules = frozenset(self.tasks[0].program.modules)
        given = None
        if self.existing is not None:
            given = Link(self.existing.robot, narrow=True)
        self.costs = ChainCosts(self.prices, self.mission.free, given)
        self.kept = KeptParameters(self.prices, self.mission.free)
        self.layers = [
            [
                self._node(layer, rank, derivation)
                for rank, derivation in enumerate(self.ranked)
                if self._is_within(derivation, robots.task.modules)
            ]
            for layer, robots in enumerate(self.tasks)
        ]

    def _is_within(self, derivation: Derivation, most: int | None) -> bool:
        count = sum(symbol in self._modules for symbol in derivation.word)
        return most is None or count <= most

    def _node(self, layer: int, rank: int, derivation: Derivation) -> Node:
        model = self.tasks[layer].model(derivation)
        leaf = BoxTree(() if model is None else whole_box(model))
        cut = CutRobot(layer, derivation.word, derivation.labels, leaf)
        node = Node(layer, rank, derivation, cut, leaf, narrow=self.is_narrow(layer))
        if model is None:
            node.undecided = Undecided(self.tasks[layer].fault(derivation), layer)
        return node

    def is_narrow(self, layer: int) -> bool:
        """Whether parameters affect the cost of a step to a robot whose box is not cut yet."""
        return (not layer and self.existing is not None) or fixes(self.tasks[layer].task)

    # --- the search -----------------------------------------------------------------------------

    def search(self) -> None:
        """Continue until the robots of a cheapest path do the tasks, or no path is left."""
        while not self.found:
            if self.failed >= MOTION_SEARCHES * len(self.tasks):
                self.stopped = (
                    f"the search ended at its limit of {self.failed} robots that no motion was "
                    "found for"
                )
                return
            nodes = self._cheapest()
            if nodes is None:
                return
            self._advance(nodes)

    def _advance(self, nodes: Sequence[Node]) -> None:
        """Try the next robot of a path, or whether all of them agree in their parameters."""
        # Designs of all robots are used even if the time was up when the last one was proved.
        if any(node.design is None for node in nodes):
            self.tasks[0].context.check_time()
        order = sorted(nodes, key=lambda node: -self.tasks[node.layer].success)
        for node in order:
            if not node.screened:
                self._screen(node)
                return
        if len(nodes) > 1 and current_limit() and not any(node.design for node in nodes):
            self._prove_at_once(nodes)
        for node in order:
            if node.design is None:
                self._find(node)
                return
        self._agree(nodes)

    def _prove_at_once(self, nodes: Sequence[Node]) -> None:
        """Look for first designs of all robots of a path, if there is no such path yet."""
        if not self.incumbent:
            robots = [(self.tasks[k], n.derivation, n.leaf.box) for k, n in enumerate(nodes)]
            self.incumbent = proved_at_once(robots, *self._groups(nodes), nodes[0].rank) or ()

    def _cheapest(self) -> list[Node] | None:
        """The cheapest path of robots that are not undecided; None if it costs too much."""
        layers = [[node for node in layer if not node.undecided] for layer in self._left()]
        places = {id(node): i for layer in layers for i, node in enumerate(layer)}
        blocked = [
            (a.layer, places[id(a)], places[id(b)])
            for a, b in self._blocked
            if id(a) in places and id(b) in places
        ]
        links = [[self._link(node) for node in layer] for layer in layers]
        chain = cheapest_chain(self.costs, links, blocked)
        most = self.mission.most
        if chain is None or (most is not None and chain.cost > most):
            return None
        return [layer[i] for layer, i in zip(layers, chain.robots, strict=True)]

    def _left(self) -> list[list[Node]]:
        """The layers after removing refuted robots."""
        for layer, robots in zip(self.layers, self.tasks, strict=True):
            layer[:] = [
                node
                for node in layer
                if not node.leaf.refuted and not robots.is_known(node.derivation)
            ]
        return self.layers

    def _link(self, node: Node) -> Link:
        known = self._links.get(id(node))
        if known is None:
            known = node, Link(self._built(node), node.rank, node.narrow)
            self._links[id(node)] = known
        return known[1]

    def _built(self, node: Node) -> Built:
        """The robots of a node as modules, with the ranges of their parameters."""
        model = self.tasks[node.layer].model(node.derivation)
        values: dict[tuple[int, str], Ranges] = {}
        if model is not None:
            for parameter, ranges in zip(model.parameters, node.leaf.ranges(), strict=True):
                values[parameter.symbol, parameter.name] = ranges
        return built(node.derivation.word, self._modules, values)

    # --- one robot ------------------------------------------------------------------------------

    def _screen(self, node: Node) -> None:
        """Try to refute a robot."""
        node.screened = True
        robots, whole = self.tasks[node.layer], node.leaf is node.cut.tree
        if whole and robots.refutes(node.derivation):
            robots.teaches(node.derivation)
            return
        screening = robots.answer(node.derivation, node.leaf.box)
        if screening.refutation.refuted and not whole:
            boxes = robots.covering(node.derivation, node.leaf.box)
            if boxes is not None:
                self._refute(node, BoxEvidence(node.layer, boxes))
            elif not self._choose(node):
                node.undecided = Undecided(NO_COVERING, node.layer)
        elif screening.inadmissible is not None:
            node.undecided = Undecided(screening.inadmissible, node.layer)

    def _find(self, node: Node) -> None:
        """Search for a motion of a robot, first with the values that it keeps."""
        robots = self.tasks[node.layer]
        node.design = self._as_it_is(node)
        if node.design is not None:
            return
        sought = robots.motions(node.derivation, node.leaf.box, node.rank)
        design = sought.first()
        if design is not None:
            node.design = design
            return
        late = robots.too_weak(node.derivation, node.leaf.box)
        if late is None:
            if not self._choose(node):
                self.failed += 1
                node.undecided = sought.undecided(node.layer)
        elif node.leaf is node.cut.tree:
            robots.teaches(node.derivation)
        else:
            self._refute(node, BoxEvidence(node.layer, late))

    def _as_it_is(self, node: Node) -> Design | None:
        """A design with the values that kept modules of the existing robot have, if it has any."""
        if node.layer or self.existing is None:
            return None
        values = self.kept.values(self.existing.robot, self._linked(node))
        whole, box = node.leaf.box, pinned(node.leaf.box, values)
        if not values or not all(meet(single(v), ranges_of(whole[p])) for p, v in values.items()):
            return None
        motions = self.tasks[0].open_motions(node.derivation, box, node.rank)
        return None if motions is None else motions.best()

    def _linked(self, node: Node) -> LinkedRobot:
        """The robot of a node as a link of a chain."""
        model = self.tasks[node.layer].model(node.derivation)
        parameters = () if model is None else model.parameters
        return LinkedRobot(
            self._built(node),
            tuple(i for i, each in enumerate(node.derivation.word) if each in self._modules),
            tuple((each.symbol, each.name) for each in parameters),
        )

    def _groups(self, nodes: Sequence[Node]) -> tuple[list[Group], dict[Group, Fraction]]:
        """The parameters that must be equal along a path, and the groups whose value is given."""
        before = None if self.existing is None else self.existing.robot
        return self.kept.groups(before, [self._linked(node) for node in nodes])

    def _refute(self, node: Node, evidence: BoxEvidence) -> None:
        """Record a refuted part of a robot's parameters; recompute the links of its other parts."""
        node.leaf.refuted = True
        node.cut.evidence[id(node.leaf)] = evidence
        for other in self.layers[node.layer]:
            if other.cut is node.cut:
                self._links.pop(id(other), None)

    # --- the robots of a path together ----------------------------------------------------------

    def _agree(self, nodes: Sequence[Node]) -> None:
        """Search for common parameter values of kept modules; otherwise cut boxes, or give up."""
        candidates = [
            Candidate(self.tasks[k], node.derivation, node.leaf.box, node.design)
            for k, node in enumerate(nodes)
            if node.design is not None
        ]
        groups, fixed = self._groups(nodes)
        result = agreed(candidates, groups, fixed, nodes[0].rank)
        if result is not None and self._takes(result.designs):
            return
        whole = [node.cut.tree.box for node in nodes]
        widest = widest_disagreement(candidates, groups, whole, fixed)
        parted = widest is not None and self._part(nodes, *widest)
        if not parted:
            self._block(nodes)

    def _takes(self, designs: tuple[Design, ...]) -> bool:
        """Take designs as the result, unless they cost too much; return whether they are taken."""
        self.found = designs
        if self.mission.most is not None and self.cost > self.mission.most:
            self.found = ()  # irrational values may compare as equal although they are not
        return bool(self.found)

    def take_incumbent(self) -> None:
        """Once the time is up, take the designs proved at once, if there are no others."""
        if self.incumbent and not self.found:
            self._takes(self.incumbent)

    def _part(self, nodes: Sequence[Node], group: Group, low: Fraction, high: Fraction) -> bool:
        """Cut the boxes of the robots of a group between two values; return whether one was cut."""
        parted = False
        for layer, parameter in group:
            node = nodes[layer]
            cut = cut_between(node.leaf.box, parameter, low, high)
            if cut is None or not self._may_cut():
                continue
            self._split(node, cut)
            parted = True
        return parted

    def _choose(self, node: Node) -> bool:
        """Cut the choices of a robot, as some may be refuted or succeed; whether it was cut."""
        cut = choices_halved(node.leaf.box)
        if cut is None or not self._may_cut():
            return False
        self._split(node, cut)
        return True

    def _may_cut(self) -> bool:
        """Whether one more box may be cut."""
        self.wanted |= self.cuts >= MOST_CUTS
        return self.cuts < MOST_CUTS

    def _split(self, node: Node, cut: Cut) -> None:
        """Replace a node by one for each part of its box."""
        self.cuts += 1
        self.cut[node.layer, node.derivation.labels] = node.cut
        parts = [
            Node(node.layer, node.rank, node.derivation, node.cut, leaf, narrow=True)
            for leaf in node.leaf.split(cut)
        ]
        if node.design is not None:
            # The part that contains the design inherits it and is not tried again.
            own = next((part for part in parts if is_within(node.design, part.leaf.box)), None)
            if own is not None:
                own.screened, own.design = True, node.design
        place = self.layers[node.layer].index(node)
        self.layers[node.layer][place : place + 1] = parts

    def _block(self, nodes: Sequence[Node]) -> None:
        """Exclude the steps of a path whose robots disagree, though this proves nothing."""
        if len(nodes) == 1:
            nodes[0].undecided = Undecided(UNSUITED, 0, apart=True)
        self._blocked += pairwise(nodes)

    @property
    def cost(self) -> Fraction:
        """The cost of all changes, by the values of the designs found."""
        return sum((step.cost for step in self.steps if step is not None), Fraction(0))

    @property
    def steps(self) -> tuple[Changes | None, ...]:
        """The changes before each task, by the values of the designs found."""
        found: list[Changes | None] = []
        before = None if self.existing is None else self.existing.robot
        for design in self.found:
            robot = built_of(design.derivation.word, self._modules, design.parameters)
            way = None
            if before is not None:
                way = changes(before, robot, self.prices, self.mission.free)
            found.append(way)
            before = robot
        return tuple(found)
