"""Figure 1: the modules, a robot that is built of them, and its labelled graph."""

from __future__ import annotations

from timing import ROOT, SPEC

import srgc
from paper.graph_drawing import graph_svg
from paper.module_svg import module_svg
from paper.section import Claim, Figure, Section, claims_table, figures_of, plain_word, word

WORD = "B eps JO eps JO eps JO eps L eps JO eps L eps JO eps EN"
"""The caption of the paper's Figure 1, whose ε is ``eps`` in specifications."""
MODULES = ROOT / "specs" / "l_shaped.srg"
IN_SPACE = "B eps JO eps LL eps C eps EN"
"""A robot with each of the five modules once."""
APART, ROOM = 42.0, 26.0


def figure_1() -> Section:
    """The modules in space, the robot of the caption, and its graph."""
    in_space = srgc.robot(MODULES, IN_SPACE)
    robot = srgc.robot(SPEC, WORD)
    graph = srgc.graph(SPEC, "robot", word=WORD).picture
    places = {node.key: (20 + APART * i, ROOM) for i, node in enumerate(graph.nodes)}
    names = {node.key: _module(node.label) for node in graph.nodes}
    size = 40 + APART * (len(graph.nodes) - 1), 2 * ROOM
    drawn = graph_svg(graph, places, names, size, f"{len(graph.nodes)} modules, as labelled graph")
    roles = {name: module.role for name, module in srgc.load(MODULES).ir.modules.items()}
    listed = ", ".join(f"<code>{name}</code> ({role})" for name, role in roles.items())
    joints, links = len(robot.dofs), len(robot.parameters)
    shown = " ".join(name for name in WORD.split() if name != "eps")
    figures = [
        Figure(
            module_svg(MODULES, IN_SPACE),
            "An arm in space of a base, a joint, an L-shaped link, a cylindrical link and an "
            "effector.",
            "(a) The five modules, one behind the other: base, joint, L-shaped link, cylindrical "
            f"link, end effector. The word is {word(IN_SPACE.split())} of "
            "<code>specs/l_shaped.srg</code>.",
        ),
        Figure(
            module_svg(SPEC, WORD),
            f"A planar arm with {links} links, which {joints} joints move.",
            "(b) The robot of the caption, in the family of the case study.",
        ),
        Figure(
            drawn,
            f"A row of circles, {shown}, with an arrow from each to the next.",
            "(c) Its labelled graph: edges lead from the output end of a module to the input end "
            "of the next.",
        ),
    ]
    claims = [
        Claim(
            "Section 2.1, Figure 1(a)",
            "Five modules: end effector, joint, cylindrical link, base, L-shaped link. Links have "
            "their length as a parameter.",
            f"{len(roles)} modules: {listed}. The two links have a length: "
            f"{len(in_space.parameters)} parameters.",
            "agrees",
        ),
        Claim(
            "Figure 1(b), (c)",
            f"The sequence of symbols {word(WORD.split())} is a configuration.",
            f"It is a word of the family: {len(graph.nodes)} nodes, {len(graph.edges)} edges. In "
            f"the plane its first three joints turn about one axis, and the last one turns nothing "
            f"but a point: of its {WORD.count('JO')} joints {joints} coordinates are left.",
            "agrees",
        ),
    ]
    content = f"{figures_of(figures)}{claims_table('Figure 1 and Section 2.1', claims)}"
    return Section("figure-1", "Figure 1: modules and a robot", content)


def _module(label: str) -> str:
    return plain_word(label.split()[:1])
