"""The derivation tree of a word: nonterminals, the productions that replace them, and the word."""

from __future__ import annotations

from collections.abc import Mapping

from compiler.words.derivation import Derivation
from grammar_lang import ir
from srgc.render.html_text import name_in_picture, text

LETTER = 9.0
GAP = 18.0
ROW = 52.0
MARGIN = 14.0


def derivation_tree(derivation: Derivation, roles: Mapping[str, ir.Role]) -> str:
    """The tree as SVG: the word below, in one row, so that it reads from left to right."""
    xs, width = _columns(derivation)
    places = _middles(derivation, xs)
    depths = _depths(derivation)
    floor = MARGIN + ROW * (max(depths) + 1)
    edges, marks = [], []
    for number, node in enumerate(derivation.nodes):
        at = places[number], MARGIN + ROW * depths[number]
        for child, symbol in zip(node.children, node.production.right, strict=True):
            inner = symbol.kind == "nonterminal"
            end = (places[child], MARGIN + ROW * depths[child]) if inner else (xs[child], floor)
            edges.append(f'<path d="M{at[0]:.1f} {at[1] + 24:.1f}L{end[0]:.1f} {end[1] - 8:.1f}"/>')
        marks.append(
            f'<g class="replaced"><text x="{at[0]:.1f}" y="{at[1] + 4:.1f}">'
            f"{text(name_in_picture(node.production.left))}</text>"
            f'<text class="label" x="{at[0]:.1f}" y="{at[1] + 18:.1f}">'
            f"{text(name_in_picture(node.production.label))}</text></g>"
        )
    for place, symbol_name in enumerate(derivation.word):
        role, shown = roles.get(symbol_name, "edge"), name_in_picture(symbol_name)
        whole = f"<title>{text(symbol_name)}</title>" if shown != symbol_name else ""
        marks.append(
            f'<g class="leaf {role}" data-symbol="{place}">{whole}<text x="{xs[place]:.1f}" '
            f'y="{floor + 6:.1f}">{text(shown)}</text>'
            f'<text class="label" x="{xs[place]:.1f}" y="{floor + 20:.1f}">{place}</text></g>'
        )
    height = floor + 28
    return (
        f'<svg class="tree" viewBox="0 0 {width:.0f} {height:.0f}" width="{width:.0f}" '
        f'height="{height:.0f}" role="img" aria-label="The derivation tree of the word">'
        f'<g class="branches">{"".join(edges)}</g>{"".join(marks)}</svg>'
    )


def _columns(derivation: Derivation) -> tuple[list[float], float]:
    """Where the symbols of the word stand, and how wide the tree is."""
    found, x = [], MARGIN
    for symbol in derivation.word:
        half = LETTER * max(len(name_in_picture(symbol)), 2) / 2
        found.append(x + half)
        x += 2 * half + GAP
    widest = max(
        LETTER * len(name_in_picture(name))
        for node in derivation.nodes
        for name in (node.production.label, node.production.left)
    )
    shift = max(0.0, widest / 2 - min(found, default=MARGIN))
    return [each + shift for each in found], max(x - GAP + MARGIN + shift, widest) + widest / 2


def _middles(derivation: Derivation, xs: list[float]) -> list[float]:
    """Where the nodes stand: over the middle of what they derive, or a gap where that is empty."""
    found = []
    for begin, end in derivation.spans():
        if begin < end:
            found.append((xs[begin] + xs[end - 1]) / 2)
        else:
            before = xs[begin - 1] if begin else MARGIN
            found.append((before + (xs[begin] if begin < len(xs) else before + 2 * GAP)) / 2)
    return found


def _depths(derivation: Derivation) -> list[int]:
    """How many productions lie above each node."""
    found = [0] * len(derivation.nodes)
    for number, node in enumerate(derivation.nodes):
        for child, symbol in zip(node.children, node.production.right, strict=True):
            if symbol.kind == "nonterminal":
                found[child] = found[number] + 1
    return found
