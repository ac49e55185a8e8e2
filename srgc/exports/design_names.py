"""The names that the parts of a design have in whatever it is exported as."""

from __future__ import annotations

from compiler.rigid_links.part_names import PartNames, effector_modules, part_names
from compiler.rigid_links.rigid_tree import RigidTree, RigidTreeError, rigid_tree
from compiler.robots.labelled_graph import labelled_graph
from srgc.results.found_design import FoundDesign


def design_tree(design: FoundDesign) -> RigidTree | None:
    """The tree of rigid links of a design, if its robot is one."""
    try:
        return rigid_tree(design.model, design.stated)
    except RigidTreeError:
        return None


def design_names(design: FoundDesign, tree: RigidTree | None) -> PartNames:
    """The names of joints and effectors, and of the links of a tree."""
    grammar = design.program.grammars[design.task.grammar]
    modules = design.program.modules
    graph = labelled_graph(design.program, grammar, design.derivation)
    tools = effector_modules(design.derivation, grammar.semantics or {}, modules)
    return part_names(design.model, tree, graph, modules, tools)
