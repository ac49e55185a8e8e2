"""What the links, joints and effectors of a robot are called: after modules and their places."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from compiler.rigid_links.rigid_tree import RigidTree
from compiler.robots.labelled_graph import LabelledGraph
from compiler.robots.robot import RobotModel
from compiler.words.derivation import Derivation, DerivationNode, emission_order
from grammar_lang import ir


@dataclass(frozen=True, slots=True)
class PartNames:
    """Names of the links and effectors of a rigid tree, and of its joints by degree of freedom.

    No two are equal.
    """

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
    """Names like ``L_4``: the module and its index in the word.

    A joint has the names of the joint modules that it was merged from; a link that of its first
    module with the role link, the base that of the first base; a link without one that of its
    joint.  An effector has that of its module, whose place ``tools`` holds (``effector_modules``),
    or else, where that is None, is called ``effector_1`` and so on by its own number.  Of a robot
    that is no tree of rigid links (None), no links are named.
    """
    unused = _Unused()
    role = {node.place: modules[node.module].role for node in graph.nodes}
    name = {node.place: f"{node.module}_{node.place}" for node in graph.nodes}
    joints = [unused.name("_".join(name[place] for place in dof.symbols)) for dof in model.dofs]
    links = list[str]()
    if tree is not None:
        owners = _owners(model, tree, graph)
        first: dict[int, str] = {}
        for place, text in name.items():
            if role[place] == ("base" if owners[place] == 0 else "link"):
                first.setdefault(owners[place], text)
        links.append(unused.name(first.get(0, "base")))
        for number, link in enumerate(tree.links[1:], start=1):
            dof = link.joint.dof if link.joint is not None else 0
            links.append(unused.name(first.get(number, f"{joints[dof]}_link")))
    effectors = [
        unused.name(f"effector_{number}" if place is None else name[place])
        for number, place in enumerate(tools, start=1)
    ]
    return PartNames(tuple(links), tuple(joints), tuple(effectors))


class _Unused:
    """Gives every name once; what is wanted again gets a number."""

    def __init__(self) -> None:
        self.given: set[str] = set()

    def name(self, wanted: str) -> str:
        """The name, or the first numbered form of it that is free."""
        found = next(item for item in _forms(wanted) if item not in self.given)
        self.given.add(found)
        return found


def _forms(wanted: str) -> Iterator[str]:
    yield wanted
    number = 2
    while True:
        yield f"{wanted}_no{number}"
        number += 1


def _owners(model: RobotModel, tree: RigidTree, graph: LabelledGraph) -> dict[int, int]:
    """The link of every module, by place: that of the joint module that it stands on, or its own.

    Where a joint module has several degrees of freedom, the last of them.
    """
    owners = {
        place: number
        for (number, _), dof in zip(tree.carried(), model.dofs, strict=True)
        for place in dof.symbols
    }
    lower = {edge.upper: edge.lower for edge in graph.edges}
    for node in graph.nodes:
        climbed = _climb(node.place, lower, owners)
        owner = owners.get(climbed[-1], 0)
        owners.update(dict.fromkeys(climbed, owner))
    return owners


def _climb(place: int, lower: Mapping[int, int], known: Mapping[int, int]) -> Sequence[int]:
    """The modules below a place, down to the first whose link is known, or to a root."""
    places = [place]
    while places[-1] not in known and places[-1] in lower:
        places.append(lower[places[-1]])
    return places


def effector_modules(
    derivation: Derivation,
    semantics: Mapping[str, ir.SemanticBlock],
    modules: Mapping[str, ir.Module],
) -> tuple[int | None, ...]:
    """For every effector, in the order in which the language numbers them, a place in the word.

    An effector belongs to a module if the production that emits it emits no other and has one
    module of the role effector only; of others (None) nobody can say.
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
