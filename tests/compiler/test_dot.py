from __future__ import annotations

import html
import os
import re
import shutil
import subprocess
import sys
from collections import Counter
from itertools import pairwise
from pathlib import Path
from xml.etree import ElementTree

import networkx as nx
import pydot
import pytest

from compiler.views.dot import to_dot
from compiler.views.family_views import family_dfa_view, grammar_view
from compiler.views.pushdown_views import sra_view
from compiler.views.words_view import words_view
from compiler.views.workspace_view import Arrow, Edge, Node, Picture
from compiler.words.language import Language, language
from compiler.words.pushdown_automaton import sra
from grammar_lang import ir
from srgc.api.graph import to_networkx
from tests.oracles.grammars import ALPHABET, ARM_MODULES, ARM_TERMINALS, TRAPS, arm, grammar
from tests.oracles.some_cases import some

pytestmark = pytest.mark.filterwarnings("ignore:.* deprecated - use .*:DeprecationWarning")

HOSTILE = (
    '"', "\\", "\\n", "\\N", '\\"', "\\\\", "end\\", "<b>", "[", "]", "{", "}", "|", ";", "->",
    "--", "node", "graph", "start0", "&amp;", "&", "&#92;", "'", "ε", "é", "日本",
    "#", "//", "/*", "a:b", "%d", "=",
)  # fmt: skip


def hostile() -> Language:
    """Every strange symbol in one production, and by itself."""
    symbols = tuple(ir.Symbol(name, "edge") for name in HOSTILE)
    again = (symbols[0], ir.Symbol("S", "nonterminal"))
    rights = [symbols, *((symbol,) for symbol in symbols), again]
    productions = [ir.Production(f'<"{i}\\', "S", right) for i, right in enumerate(rights)]
    strange = ir.Grammar('"G\\', "S", ("S",), tuple(productions), ir.AllOf(()), None)
    return language(strange, HOSTILE, frozenset(HOSTILE))


def pictures(lang: Language, word: tuple[str, ...] | None) -> dict[str, Picture]:
    return {
        "sra": sra_view(sra(lang.srg, lang.accept), word),
        "dfa": family_dfa_view(lang, word),
        "words": words_view(lang, 2, word or None),
        "grammar": grammar_view(lang, word),
    }


def languages() -> dict[str, Language]:
    found = {
        name: language(grammar(text, ALPHABET), ALPHABET, frozenset("ab"))
        for name, text in TRAPS.items()
    }
    found["arm"] = language(arm(), ARM_TERMINALS, ARM_MODULES)
    found["hostile"] = hostile()
    return found


def plain(label: str) -> str:
    """What a label says, by the rules of the DOT language."""
    if label.startswith("<"):
        label = re.sub(r"</?font[^>]*>", "", label[1:-1].replace("<br/>", "\\n"))
    return html.unescape(name_of(label))


def name_of(quoted: str) -> str:
    escapes = {"\\\\": "\\", '\\"': '"', "\\n": "\n"}
    body = quoted.removeprefix('"').removesuffix('"')
    return re.sub(r"\\.", lambda found: escapes[found[0]], body)


def red(item: pydot.Node | pydot.Edge) -> bool:
    colours = {item.get("color"), item.get("fontcolor")}
    assert colours in ({None}, {'"#d00000"'})
    assert (item.get("penwidth") == "2") == (colours != {None})
    return colours != {None}


def check(picture: Picture) -> None:
    """The DOT text, read by pydot, and the graph of networkx say what the picture says."""
    (read,) = pydot.graph_from_dot_data(to_dot(picture))
    assert name_of(read.get_name()) == picture.name
    nodes = {n.get_name(): n for n in read.get_nodes()}
    shown = {
        name_of(key): (plain(n.get("label")), n.get("peripheries") == "2", red(n))
        for key, n in nodes.items()
        if key not in ("node", "edge", "graph") and n.get("shape") != "none"
    }
    assert shown == {n.key: (n.label, n.double, n.highlighted) for n in picture.nodes}
    drawn: Counter[tuple[str, str, str, bool]] = Counter()
    starts = {}
    for edge in read.get_edges():
        tail, head = name_of(edge.get_source()), name_of(edge.get_destination())
        for text in parts(edge.get("label")):
            coloured = red(edge) and "black" not in text
            if tail in shown:
                drawn.update((tail, head, line, coloured) for line in plain(text).split("\n"))
            else:
                assert tail not in starts
                starts[tail] = (head, plain(text), coloured)
    assert drawn == Counter(
        (e.tail, e.head, line, e.highlighted) for e in picture.edges for line in e.lines or ("",)
    )
    assert [*starts.values()] == [(a.head, a.label, a.highlighted) for a in picture.initial]
    graph = to_networkx(picture)
    attributes = {
        key: (n["label"], n["accepting"], n["highlighted"]) for key, n in graph.nodes(data=True)
    }
    assert attributes == shown
    assert Counter((t, h, d["label"], d["highlighted"]) for t, h, d in graph.edges(data=True)) == (
        Counter((e.tail, e.head, "\n".join(e.lines), e.highlighted) for e in picture.edges)
    )
    assert {key for key, first in graph.nodes(data="initial") if first} == {
        a.head for a in picture.initial
    }


def parts(label: str | None) -> list[str]:
    """A label, or its coloured and its black lines where a loop has both."""
    if label is None or not label.startswith("<"):
        return [label or ""]
    coloured, black = re.fullmatch(r'<(.*)<br/>(<font color="black">.*</font>)>', label).groups()
    return [f"<{coloured}>", f"<{black}>"]


@pytest.mark.parametrize("name", some(["arm", *TRAPS, "hostile"], 5))
def test_every_view_is_read_back(name: str) -> None:
    lang = languages()[name]
    words = [word for word in lang.words(max_length=5) if word]
    for word in [None, *words[:1]] if name == "arm" else words[-1:] or [None]:
        for picture in pictures(lang, word).values():
            check(picture)


def test_keys_and_titles_are_escaped() -> None:
    keys = (*HOSTILE, "start0", "digraph", "two\nlines")
    nodes = tuple(Node(key, key, double=True) for key in dict.fromkeys(keys))
    edges = tuple(Edge(a.key, b.key, (a.key,)) for a, b in pairwise(nodes))
    check(Picture('g"\\', "box", nodes, edges, (Arrow(nodes[0].key, "in"),), 'a "title"\\'))


def test_both_colours_of_a_loop_are_drawn_on_one() -> None:
    edges = (Edge("a", "a", ("x<", "y"), highlighted=True), Edge("a", "a", ("z",)))
    text = to_dot(Picture("g", "circle", (Node("a", "a"),), edges))
    assert text.count("->") == 1
    assert '<x&lt;<br/>y<br/><font color="black">z</font>>' in text


def test_graphs_of_networkx_hold_what_is_meant() -> None:
    lang = languages()["arm"]
    word = ("B", "eps", "JO", "eps", "EN")
    graph = to_networkx(words_view(lang, 3, word))
    assert isinstance(graph, nx.MultiDiGraph)
    (source,) = (n for n, first in graph.nodes(data="initial") if first)
    (sink,) = (n for n, d in graph.nodes(data=True) if d["data"]["word"] == word)
    path = nx.shortest_path(graph, source, sink)
    assert [graph.nodes[n]["data"]["word"] for n in path] == [word[:1], word[:3], word]
    assert all(graph.nodes[n]["highlighted"] for n in path)
    # A word has one predecessor here: the words are a tree.
    assert nx.is_arborescence(graph)
    undirected = to_networkx(
        Picture("w", "box", (Node("a", "a"), Node("b", "b")), (Edge("a", "b"),), directed=False)
    )
    assert sorted(undirected.edges()) == [("a", "b"), ("b", "a")]


@pytest.mark.skipif(shutil.which("dot") is None, reason="Graphviz is not installed")
@pytest.mark.parametrize("name", ["hostile", "arm", "ambiguous", "empty language"])
def test_graphviz_draws_what_is_written(name: str) -> None:
    lang = languages()[name]
    word = next((word for word in lang.words() if len(word) > 2), None)
    for picture in pictures(lang, word).values():
        drawn = subprocess.run(
            ["dot", "-Tsvg"], input=to_dot(picture).encode(), capture_output=True, check=True
        )
        assert drawn.stderr == b""
        texts = Counter(
            (element.text or "").replace("\xa0", " ")
            for element in ElementTree.fromstring(drawn.stdout).iter(
                "{http://www.w3.org/2000/svg}text"
            )
        )
        lines = [line for node in picture.nodes for line in node.label.split("\n")]
        lines += [line for edge in picture.edges for line in edge.lines]
        lines += [arrow.label for arrow in picture.initial if arrow.label]
        lines += [picture.title] if picture.title else []
        assert texts == Counter(lines)


SCRIPT = """
from tests.compiler.test_dot import languages, pictures
from compiler.views.dot import to_dot
for lang in languages().values():
    for word in (None, next((w for w in lang.words() if w), None)):
        for picture in pictures(lang, word).values():
            print(to_dot(picture))
"""


@pytest.mark.slow
def test_the_same_bytes_whatever_the_hash_seed() -> None:
    root = Path(__file__).resolve().parents[2]
    outputs = {
        subprocess.run(
            [sys.executable, "-c", SCRIPT],
            cwd=root,
            env={
                **os.environ,
                "PYTHONHASHSEED": seed,
                "PYTHONPATH": str(root),
                "PYTHONUTF8": "1",
            },
            capture_output=True,
            check=True,
        ).stdout
        for seed in ("0", "1")
    }
    assert len(outputs) == 1
    assert outputs.pop().count(b"digraph") == 8 * len(languages())
