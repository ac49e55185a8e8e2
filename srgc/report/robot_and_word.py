"""The robot of a result, module by module, with its word and its derivation."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from math import degrees

from compiler.robots.frame_table import SemanticsError
from compiler.robots.robot import RobotDof
from compiler.words.derivation import Derivation
from grammar_lang import ir
from grammar_lang.ir.constants import to_float
from srgc.render.html_text import many, name_in_picture, number, text, with_unit
from srgc.render.module_drawing import module_drawing
from srgc.render.module_marks import marked_robot
from srgc.render.module_picture import robot_picture
from srgc.report.evidence import Evidence
from srgc.results.found_design import FoundDesign


def robot_section(evidence: Evidence) -> str:
    """The robot of the page with its word; empty if the result has no robot."""
    found = evidence.found
    if found is None:
        return ""
    grammar, modules = found.program.grammars[found.task.grammar], found.program.modules
    roles = _roles(found)
    return (
        '<section id="robot"><h2>The robot and its word</h2>'
        f"{_word(found.derivation, roles)}"
        f"<figure>{_picture(found, grammar, modules)}</figure>"
        f'<div class="scroll">{_table(found, roles)}</div></section>'
    )


def derivation_section(evidence: Evidence) -> str:
    """The derivation of the word; empty if the result has no robot."""
    found = evidence.found
    if found is None:
        return ""
    return (
        f'<section id="derivation"><h2>Derivation</h2><p>{_leftmost(found.derivation)}</p>'
        f'<div class="scroll">{derivation_tree(found.derivation, _roles(found))}</div>'
        "</section>"
    )


def _roles(found: FoundDesign) -> dict[str, ir.Role]:
    """The modules with their roles."""
    return {name: module.role for name, module in found.program.modules.items()}


def _word(derivation: Derivation, roles: Mapping[str, ir.Role]) -> str:
    """The word as a list of chips; edges are plain."""
    chips = []
    for place, name in enumerate(derivation.word):
        if name in roles:
            title = f"symbol {place}: {roles[name]}"
            chips.append(
                f'<li class="chip {roles[name]}" data-symbol="{place}" tabindex="0" '
                f'title="{text(title)}">{text(name)}<sub>{place}</sub></li>'
            )
        else:
            chips.append(f'<li class="edge" data-symbol="{place}">{text(name)}</li>')
    return f'<ol class="chips" aria-label="The word">{"".join(chips)}</ol>'


def _picture(found: FoundDesign, grammar: ir.Grammar, modules: Mapping[str, ir.Module]) -> str:
    try:
        robot = marked_robot(grammar, modules, found.derivation, found.model.dimension)
    except SemanticsError as error:
        return f"<figcaption>It is not drawn: {text(error)}.</figcaption>"
    drawing = module_drawing(robot, found.derivation.word, dict(modules), found.theta)
    values = {place: [shown for _, shown in each] for place, each in _parameters(found).items()}
    absent = [
        f"{text(name)} {place}"
        for place, name in enumerate(found.derivation.word)
        if name in modules and place not in {module.place for module in drawing.modules}
    ]
    caption = (
        "Drawn with its real lengths, in a pose that shows all modules and is not one of the task. "
        "A name consists of the module and its place in the word, counted from 0."
    )
    if absent:
        caption += f" Not drawn, as no frame passes them: {', '.join(absent)}."
    picture = robot_picture(drawing, values)
    return f"{picture}<figcaption>{caption}</figcaption>"


def _parameters(found: FoundDesign) -> dict[int, list[tuple[str, str]]]:
    """By place in the word, the names of its parameters and their values with units."""
    shown: dict[int, list[tuple[str, str]]] = {}
    for value in found.parameters:
        known = value.parameter
        row = known.name, with_unit(float(value), known.unit)
        shown.setdefault(known.symbol, []).append(row)
    return shown


def _table(found: FoundDesign, roles: Mapping[str, ir.Role]) -> str:
    parameters, joints = _parameters(found), _joints(found)
    labels = _labels(found.derivation)
    rows = []
    for place, name in enumerate(found.derivation.word):
        if name not in roles:
            continue
        values = [f"{text(key)} = {text(shown)}" for key, shown in parameters.get(place, ())]
        values += joints.get(place, [])
        rows.append(
            f'<tr data-symbol="{place}"><td>{place}</td><th scope="row">{text(name)}</th>'
            f'<td data-head="role">{roles[name]}</td><td>{"<br/>".join(values)}</td>'
            f'<td data-head="rule">{text(labels[place])}</td></tr>'
        )
    return (
        '<table class="parts folded"><thead><tr><th scope="col">place</th>'
        '<th scope="col">module</th><th scope="col">role</th>'
        '<th scope="col">values</th><th scope="col">rule</th></tr></thead>'
        f"<tbody>{''.join(rows)}</tbody></table>"
    )


def _joints(found: FoundDesign) -> dict[int, list[str]]:
    """By place in the word, the descriptions of its joints."""
    shown: dict[int, list[str]] = {}
    for index, dof in enumerate(found.model.dofs):
        for place in dof.symbols:
            words = f"q{index + 1}: {_joint_words(dof)}"
            if len(dof.symbols) > 1:
                others = ", ".join(str(other) for other in dof.symbols if other != place)
                words += f", one with {others}"
            shown.setdefault(place, []).append(text(words))
    for place in found.model.removed:
        shown.setdefault(place, []).append("moves nothing, left out")
    return shown


def _joint_words(dof: RobotDof) -> str:
    turning = dof.kind == "revolute"
    words = f"{'turns about' if turning else 'slides along'} {dof.axis}"
    if dof.range is None:
        return f"{words}, without end"
    low, high = to_float(dof.range.lower), to_float(dof.range.upper)
    if turning:
        return f"{words}, {number(degrees(low))}° to {number(degrees(high))}°"
    return f"{words}, {number(low)} to {number(high)} m"


def _labels(derivation: Derivation) -> dict[int, str]:
    """By place in the word, the production that put the symbol there."""
    return {
        child: node.production.label
        for node in derivation.nodes
        for child, symbol in zip(node.children, node.production.right, strict=True)
        if symbol.kind != "nonterminal"
    }


def _leftmost(derivation: Derivation) -> str:
    """The leftmost derivation as labels of productions."""
    return "Leftmost, by the labels of the rules: " + " ⇒ ".join(_codes(derivation)) + "."


def _codes(derivation: Derivation) -> Iterator[str]:
    for label in derivation.labels:
        yield f"<code>{text(label)}</code>"


# --------------------------------------------------------------------------------------------------
# The derivation tree of a word: nonterminals, the productions that replace them, and the word.


LETTER = 9.0
GAP = 18.0
ROW = 52.0
MARGIN = 14.0


def derivation_tree(derivation: Derivation, roles: Mapping[str, ir.Role]) -> str:
    """The tree as SVG, with the word in one row at the bottom, so that it reads left to right."""
    xs, width = _columns(derivation)
    places = _middles(derivation, xs)
    depths = _depths(derivation)
    floor = MARGIN + ROW * (max(depths) + 1)
    edges, marks = [], []
    for index, node in enumerate(derivation.nodes):
        at = places[index], MARGIN + ROW * depths[index]
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
    """The positions of the symbols of the word, and the width of the tree."""
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
    """The positions of the nodes: above the middle of what they derive, or above a gap if empty."""
    found = []
    for begin, end in derivation.spans():
        if begin < end:
            found.append((xs[begin] + xs[end - 1]) / 2)
        else:
            before = xs[begin - 1] if begin else MARGIN
            found.append((before + (xs[begin] if begin < len(xs) else before + 2 * GAP)) / 2)
    return found


def _depths(derivation: Derivation) -> list[int]:
    """The number of productions above each node."""
    found = [0] * len(derivation.nodes)
    for index, node in enumerate(derivation.nodes):
        for child, symbol in zip(node.children, node.production.right, strict=True):
            if symbol.kind == "nonterminal":
                found[child] = found[index] + 1
    return found


# --- What a design changes in the existing robot of its task, and the robots on the way -----------


def change_section(evidence: Evidence) -> str:
    """The section about changes to an existing robot; empty without such a robot."""
    change = evidence.design.get("reconfiguration")
    if evidence.found is None or change is None:
        return ""
    old, new = change["from"], evidence.found.claim.word
    words = change["configurations"]
    if len(words) == 1:
        said = "<p>No module: this is the existing robot, with other parameters where it may.</p>"
    else:
        steps = "".join(f'<li class="word">{text(" ".join(word))}</li>' for word in words)
        said = (
            f"<p>{_count(evidence, old, new)} The robots on the way, each a word of the grammar:"
            f'</p><ol start="0">{steps}</ol>'
        )
    return f'<section id="change"><h2>What changes of the existing robot</h2>{said}</section>'


def _count(evidence: Evidence, old: Sequence[str], new: Sequence[str]) -> str:
    """The modules that are added and removed, with their places in the new and the old word."""
    kept = evidence.design["reconfiguration"]["kept"]
    modules = evidence.program.modules
    added = [i for i, name in enumerate(new) if name in modules and i not in {b for _, b in kept}]
    removed = [i for i, name in enumerate(old) if name in modules and i not in {a for a, _ in kept}]
    if not added and not removed:
        return "No module, only edges."
    said = [
        f"{many(len(places), 'module')} {done}{_named(places, word)}"
        for places, word, done in ((added, new, "added"), (removed, old, "removed"))
    ]
    return f"{', '.join(said)}."


def _named(places: Iterable[int], word: Sequence[str]) -> str:
    names = ", ".join(f"<b>{text(word[place])} {place}</b>" for place in places)
    return f" ({names})" if names else ""
