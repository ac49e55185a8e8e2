"""Figure 2: words as states, with the run that builds the robot of Figure 1."""

from __future__ import annotations

from collections import defaultdict

from timing import SPEC

import srgc
from compiler.views.workspace_view import Node, Picture
from paper.figure_1 import WORD
from paper.graph_drawing import graph_svg
from paper.section import Claim, Figure, Section, claims_table, figure, word
from srgc.render.html_text import text

ACROSS, DOWN, FIRST = 92.0, 62.0, (58.0, 24.0)
"""Between states of one length, between lengths, and where the initial state is."""


def figure_2() -> Section:
    """The run with what is one transition beside it, and the finite and pushdown automata."""
    picture = srgc.graph(SPEC, "words", highlight=WORD, near=True).picture
    states = {node.key: _word(node) for node in picture.nodes}
    run = [node.key for node in picture.nodes if node.highlighted]
    places = _places(picture)
    names = {key: f"q{number}" for number, key in enumerate(run)} | {run[-1]: "qf"}
    size = max(x for x, _ in places.values()) + 24, max(y for _, y in places.values()) + 24
    shown = graph_svg(
        picture, places, {key: names.get(key, "") for key in states}, size,
        "Words as states; the run in red",
    )  # fmt: skip
    listed = "".join(
        f"<li><code>{text(names[key])}</code>: {word(states[key])}</li>" for key in run
    )
    pushdown = srgc.graph(SPEC, "sra").picture
    finite = srgc.graph(SPEC, "dfa").picture
    moves = sum(len(edge.lines) for edge in pushdown.edges)
    accepted = [key for key in run if picture_node(picture, key).double]
    one = Figure(
        shown,
        f"{len(run)} states one below the other, joined by red arrows; beside each of them, but "
        "the first, those that another module leads to. Those with an end effector are accepting.",
        "Part of the automaton: the run in red, and the states that are one transition away from "
        "it. A transition adds an edge and a module; double circles accept.",
    )
    claims = [
        Claim(
            "Figure 2, Example 2",
            "The initial state is q0 = B; q0 to q1 connects a joint module to the base.",
            f"The run starts in {word(states[run[0]])} and goes on to {word(states[run[1]])}.",
            "agrees" if states[run[0]] == ("B",) and states[run[1]][-1] == "JO" else "differs",
        ),
        Claim(
            "Figure 2, caption",
            "An accepted run, in red, constructs the robot of Figure 1.",
            f"{len(run)} states; {', '.join(names[key] for key in accepted)} is the only one of "
            "them that accepts.",
            "agrees" if accepted == [run[-1]] else "differs",
        ),
        Claim(
            "Definition 4",
            "The automaton is a pushdown automaton, with all words over N and Z as states.",
            f"A pushdown automaton with a stack: {len(pushdown.nodes)} states, {moves} moves. The "
            f"grammar is linear, so there is a finite automaton, too: {len(finite.nodes)} states "
            "from which a word can be completed. Words as states are a picture only (erratum 4.1).",
            "corrected",
        ),
        Claim(
            "Example 2",
            "L(SRG) = L(SRA), and only words with an end effector are accepted.",
            "A condition, <code>accept</code>, binds grammar and automaton alike (erratum 4.3).",
            "corrected",
        ),
    ]
    content = (
        f"{figure(one)}<details><summary>The run in words</summary><ol>{listed}</ol>"
        f"</details>{claims_table('Figure 2, Definition 4 and Example 2', claims)}"
    )
    return Section("figure-2", "Figure 2: the automaton", content)


def picture_node(picture: Picture, key: str) -> Node:
    """The node with a key."""
    return next(node for node in picture.nodes if node.key == key)


def _word(node: Node) -> tuple[str, ...]:
    found = node.data["word"]
    assert isinstance(found, tuple)
    return found


def _places(picture: Picture) -> dict[str, tuple[float, float]]:
    """A row for each number of modules: the run on the left, what is beside it on the right."""
    rows = defaultdict[int, list[Node]](list)
    for node in picture.nodes:
        rows[len(_word(node))].append(node)
    found = dict[str, tuple[float, float]]()
    for row, length in enumerate(sorted(rows)):
        ordered = sorted(rows[length], key=lambda node: not node.highlighted)
        for column, node in enumerate(ordered):
            found[node.key] = FIRST[0] + ACROSS * column, FIRST[1] + DOWN * row
    return found
