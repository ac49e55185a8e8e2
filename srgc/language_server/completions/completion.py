"""Completion: the continuations that the parser accepts, and the declared names."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from pathlib import Path
from types import MappingProxyType

from lsprotocol import types as lsp

from grammar_lang.files.file_tree import LIBRARY
from grammar_lang.files.meshes import SUFFIXES, VISUALS
from grammar_lang.source import Span
from grammar_lang.units import UNIT_NAMES
from srgc.language_server.completions.call_forms import EMISSIONS, FUNCTIONS
from srgc.language_server.completions.completion_names import NamesDue, Offer
from srgc.language_server.completions.cursor import Cursor, cursor_at, open_call
from srgc.language_server.documents.analysis import Analysis
from srgc.language_server.keywords import explained

_KINDS = lsp.CompletionItemKind
_COMPOUND = ("N*m", "kg/m", "m/s", "m/s^2", "rad/s", "deg/s", "kg*m^2", "N*m*s/rad")
_SUFFIXES = {
    "include": (".srg",),
    "std": (".srg",),
    "from": (".yaml", ".yml", ".geojson", ".json", ".stl", ".obj"),
}
_OF_EMISSIONS = {"hull": SUFFIXES, "visual": VISUALS}
_MOST_PATHS = 200


def _keywords(cursor: Cursor) -> Iterator[Offer]:
    for word in sorted(cursor.expected):
        if word.isidentifier() and not word.isupper():
            if word == "at" and cursor.statement == ("horizon",):
                word = "at most"  # noqa: PLW2901
            elif word == "one":
                word = "one robot"  # noqa: PLW2901
            means = explained(word, cursor.item[0]) or "keyword"
            yield Offer(word, _KINDS.Keyword, means)


def _units(cursor: Cursor) -> Iterator[Offer]:
    if "UNIT" in cursor.expected:
        for name in (*UNIT_NAMES, *_COMPOUND):
            yield Offer(name, _KINDS.Unit, "unit")


def _snippets(cursor: Cursor) -> Iterator[Offer]:
    """Snippets for whole items and statements, where one may begin."""
    kind = cursor.item[0]
    forms: Mapping[str, str] = {}
    if not cursor.before:
        forms = ITEMS
    elif cursor.statement or "}" not in cursor.expected:
        return
    elif kind == "semantics":
        forms = STATEMENTS["block"] | EMISSION_SNIPPETS if cursor.block else {}
    else:
        forms = STATEMENTS.get(kind, {})
    other = ""
    if kind == "grammar":
        other = "production" if "ports" in cursor.before[:4] else "with"
    for name, body in forms.items():
        if name == other:
            continue
        yield Offer(name, _KINDS.Snippet, f"{name} …", body)


def _paths(cursor: Cursor, folder: Path | None) -> Iterator[Offer]:
    """Files that a string may name."""
    said = cursor.statement[-1:]
    suffixes = _SUFFIXES.get(said[0]) if said else None
    if cursor.statement[-2:] == ("file", ":"):
        call = open_call(cursor.statement)
        suffixes = None if call is None else _OF_EMISSIONS.get(call.name)
    if said == ("std",):
        folder = Path(LIBRARY)
    if folder is None or suffixes is None:
        return
    written = (cursor.quoted or "").rpartition("/")[0]
    try:
        place = Path(os.path.realpath(folder / written))
        entries = sorted(place.iterdir())[:_MOST_PATHS]
    except (OSError, ValueError):
        return
    for entry in entries:
        shown = f"{written}/{entry.name}" if written else entry.name
        if entry.name.startswith(".") or not shown.isprintable():
            continue
        if entry.is_dir():
            yield Offer(f"{shown}/", _KINDS.Folder, "folder")
        elif entry.name.lower().endswith(suffixes):
            yield Offer(shown, _KINDS.File, "file")


def _offers(analysis: Analysis, cursor: Cursor, folder: Path | None) -> list[Offer]:
    if cursor.silent:
        return []
    if cursor.quoted is not None:
        return list(_paths(cursor, folder))
    names = NamesDue(analysis, cursor).offers()
    snippets = list(_snippets(cursor))
    replaced = {offer.label for offer in snippets}
    keywords = [offer for offer in _keywords(cursor) if offer.label not in replaced]
    return [*names, *snippets, *keywords, *_units(cursor)]


def completions(
    analysis: Analysis, text: str, offset: int, number: int = 0, *, snippets: bool = True
) -> list[lsp.CompletionItem]:
    """The completions at an offset of a text.

    Args:
        analysis: the program.
        text: the text of the document.
        offset: the position of the cursor.
        number: the number of the document in the program.
        snippets: whether the client supports snippets; otherwise plain words are inserted.
    """
    cursor = cursor_at(text, offset)
    path = analysis.path(number)
    offers = _offers(analysis, cursor, None if path is None else path.parent)
    place = analysis.lines(number).range(Span(cursor.start, offset, number))
    items: dict[tuple[str, str | None], lsp.CompletionItem] = {}
    for rank, offer in enumerate(offers):
        body = offer.insert if snippets else None
        form = lsp.InsertTextFormat.PlainText if body is None else lsp.InsertTextFormat.Snippet
        items.setdefault(
            (offer.label, body),
            lsp.CompletionItem(
                label=offer.label,
                kind=offer.kind,
                detail=offer.detail,
                sort_text=f"{rank:04}",
                insert_text_format=form,
                text_edit=lsp.TextEdit(place, offer.label if body is None else body),
            ),
        )
    return list(items.values())


# --- Snippets for the places where an item or a statement may begin -------------------------------


ITEMS = MappingProxyType(
    {
        "module": "module ${1:L} {\n  role ${2|link,joint,base,effector|};\n  $0\n}",
        "edge": "edge ${1:eps};",
        "include": 'include "${1:modules.srg}";',
        "include std": 'include std "${1:serial.srg}";',
        "grammar": ("grammar ${1:Arm} {\n  start ${2:N};\n  ${3:base}: ${2:N} -> ${4:B};\n  $0\n}"),
        "grammar from ports": (
            "grammar ${1:Arm} from ports {\n  start ${2:Plate};\n  with ${3:Drive, Hand};\n  $0\n}"
        ),
        "semantics": "semantics ${1:Arm} {\n  ${2:base} { this.frame = world; }\n  $0\n}",
        "workspace": (
            "workspace ${1:Bench} {\n  plane xy;\n  bounds box [${2:0, 5}] x [${3:0, 5}] m;\n"
            "  region ${4:S} box [${5:0, 1}] x [${6:0, 1}] m;\n"
            "  target ${7:T} box [${8:2, 3}] x [${9:2, 3}] m;\n  $0\n}"
        ),
        "task": (
            "task ${1:Reach} {\n  robot ${2:Arm};\n  workspace ${3:Bench};\n"
            "  start in ${4:S} at rest;\n  reach ${5:T};\n  effort <= ${6:10} N*m;\n"
            "  horizon ${7:40} steps of ${8:0.1} s;\n  $0\n}"
        ),
        "mission": (
            "mission ${1:Day} {\n  tasks ${2:Morning}, ${3:Noon};\n"
            "  ${4|one robot,reconfigure|};\n  $0\n}"
        ),
    }
)

EMISSION_SNIPPETS = MappingProxyType(
    {
        "rod": (
            "rod(frame: ${1:N.frame}, axis: ${2:x}, length: ${3:L.length}, "
            "density: ${4:L.density});"
        ),
        "point": "point(frame: ${1:this.frame}, mass: ${2:1 kg});",
        "solid": (
            "solid(frame: ${1:this.frame}, mass: ${2:1 kg}, com: ${3:(0, 0) m}, "
            "inertia: ${4:0.1 kg*m^2});"
        ),
        "effector": "effector(frame: ${1:this.frame});",
        "sphere": "sphere(frame: ${1:this.frame}, radius: ${2:5 cm});",
        "capsule": (
            "capsule(frame: ${1:N.frame}, axis: ${2:x}, length: ${3:L.length}, radius: ${4:4 cm});"
        ),
        "cylinder": (
            "cylinder(frame: ${1:N.frame}, axis: ${2:x}, length: ${3:L.length}, radius: ${4:4 cm});"
        ),
        "box": "box(frame: ${1:this.frame}, size: ${2:(10, 8, 6) cm});",
        "hull": 'hull(frame: ${1:this.frame}, file: "${2:part.stl}", scale: ${3:1 mm});',
        "visual": 'visual(frame: ${1:this.frame}, file: "${2:part.stl}", scale: ${3:1 mm});',
    }
)

STATEMENTS = MappingProxyType(
    {
        "module": {
            "param": "param ${1:length} in [${2:0.5}, ${3:5}] ${4:m};",
            "const": "const ${1:density} = ${2:1} ${3:kg/m};",
            "drive": "drive ${1:q}: gear ${2:100} rotor ${3:1e-5 kg*m^2} viscous ${4:0.1 N*m*s};",
            "dof": "dof ${1:q}: ${2|revolute,prismatic|} ${3:z} in [${4:-180}, ${5:180}] ${6:deg};",
            "state": "state ${1:current} ${2:A} = ${3:0};",
            "input": "input ${1:voltage} in [${2:-24}, ${3:24}] ${4:V};",
            "der": "der(${1:current}) = $0;",
            "torque": "torque(${1:q}) = ${0:u};",
            "frame": "frame ${1:out} = in * ${0:move(x, 10 cm)};",
            "port": "port ${1|in,out|}: ${2:Flange};",
            **{
                name: body.replace("this.frame", "in").replace("N.frame", "in").replace("L.", "")
                for name, body in EMISSION_SNIPPETS.items()
            },
        },
        "grammar": {
            "production": "${1:label}: ${2:N} -> ${3:N eps L};",
            "accept": "accept ${0:contains EN};",
            "with": "with ${0:Drive, Hand};",
        },
        "block": {"let": "let ${1:joint} = ${0:N.frame * rot(z, J.q)};"},
        "workspace": {
            "region": "region ${1:S} box [${2:0, 1}] x [${3:0, 1}] ${4:m};",
            "obstacle": "obstacle ${1:O} box [${2:0, 1}] x [${3:0, 1}] ${4:m};",
            "target": "target ${1:T} box [${2:0, 1}] x [${3:0, 1}] ${4:m};",
            "obstacles": 'obstacles from "${1:map.yaml}";',
        },
        "task": {
            "start": "start in ${1:S} at rest;",
            "reach": "reach ${1:T};",
            "avoid": "avoid ${1:O} with ${2|effector,body|};",
            "effort": "effort <= ${1:10} ${2|N*m,N|};",
            "horizon": "horizon ${1:40} steps of ${2:0.1} s;",
            "satisfy": "satisfy ${0:eventually T};",
            "repeat": "repeat;",
            "payload": "payload ${1:0.5} kg;",
            "carry": "carry ${1:0.5} kg from ${2:A} to ${3:B};",
            "minimize": "minimize ${1|modules,mass,time,energy,effort|};",
            "control": "control ${1|open loop,feedback|};",
        },
        "mission": {
            "tasks": "tasks ${1:Morning}, ${2:Noon};",
            "one robot": "one robot;",
            "reconfigure": "reconfigure add ${1:1}, remove ${2:1};",
            "free": "free ${1:L}.${2:length};",
            "changes": "changes <= ${1:3};",
            "minimize": "minimize ${1|changes,effort,modules,mass|};",
        },
    }
)


# --- Signature help inside the brackets of an emission or a function ------------------------------


def signature(text: str, offset: int) -> lsp.SignatureHelp | None:
    """The call that is being written; None outside calls."""
    cursor = cursor_at(text, offset)
    call = open_call(cursor.statement)
    form = None if call is None else EMISSIONS.get(call.name) or FUNCTIONS.get(call.name)
    if call is None or form is None or cursor.silent:
        return None
    names = [name for name, _ in form.parameters]
    active = min(call.argument, len(names) - 1)
    if form.named:
        current = call.current
        left = [name for name in names if name not in call.named]
        active = names.index(current if current in names else (left or names)[0])
    parameters = [
        lsp.ParameterInformation(name, lsp.MarkupContent(lsp.MarkupKind.Markdown, means))
        for name, means in form.parameters
    ]
    label = form.label(call.name)
    return lsp.SignatureHelp([lsp.SignatureInformation(label, form.means, parameters)], 0, active)
