"""Programs spoilt at random: in their tokens, characters, bytes, statements and nesting."""

from __future__ import annotations

import random
import re
from collections.abc import Callable, Sequence
from functools import cache
from pathlib import Path

from grammar_lang.load import load_text
from grammar_lang.parsing.tables import RESERVED, tables

ROOT = Path(__file__).parents[2]
TOKEN = re.compile(r"\s+|//[^\n]*|[A-Za-z_]\w*|[0-9]+(?:\.[0-9]+)?(?:e-?[0-9]+)?|->|[<>=]=|.", re.S)
BLOCK = re.compile(r"^```srg[^\n]*\n(.*?)^```", re.M | re.S)
STATEMENT = re.compile(r"[^;{}]*(?:[;{}]|\Z)", re.S)
NOISE = "@é0;{}()[]\t\\'\"/*x-^\0\r\n\ufeff\u2028\U0001f916%#~≤°·ſ٣"


def _listed(words: str) -> tuple[str, ...]:
    return tuple(words.split())


WORDS = _listed(
    "module grammar semantics workspace task edge include role param const dof state input der "
    "torque start accept contains starts ends with count length matches empty this world x y z and "
    "or not rot move rod point solid effector sin sqrt pi plane space bounds box polytope hull "
    "region obstacle target obstacles from robot in at rest reach avoid body self margin effort "
    "norm horizon steps of slack gravity modules satisfy robust always eventually next until last "
    "implies by rates for fixed control open loop feedback repeat mass measure bound revolute "
    "prismatic rate base joint link xy xyz m kg N deg s N*m rad/s "
    "accel drive gear rotor viscous coulomb payload carry minimize then sum held aligned oriented "
    "to within except by hull ball capsule cylinder sphere radius axis length size file scale mass "
    "com inertia let frame port male female with ports std in from "
    "at most time visual named "
    "0 1 2 -1 1e300 1e-300 0.1 1000000 99999999999999999999 1/0 2^200 ; { } ( ) [ ] , : = -> <= >= "
    "< > == | * + ? ^ . / - % 'a' \"b.srg\" /* */ //"
)
NUMBERS = _listed(
    "0 1 2 3 7 12 100 1000 1000000 1e9 1e300 1e-300 0.1 0.5 1.5 2.25 0.333333333333 180 360 90 1e-9"
)
UNITS = _listed("m cm mm kg g N N*m s ms rad deg kg/m m/s rad/s kg*m^2 N/m V Hz m/s^2 1/s m^-1")
ALIKE = (
    {"<=", "<", ">=", ">", "=="},
    {"+", "-", "*", "/", "^"},
    {"|", "*", "+", "?"},
    {"x", "y", "z"},
    {"and", "or", "implies", "until"},
    {"not", "always", "eventually", "next"},
    {"base", "joint", "link", "effector"},
    {"revolute", "prismatic"},
    {"region", "obstacle", "target"},
    {"effector", "body"},
    {"start", "measure"},
    {"effort", "mass", "modules", "time"},
    {"rot", "move", "rod", "point", "solid", "effector", "sin", "sqrt"},
    {"sphere", "capsule", "cylinder", "box", "hull", "visual"},
    {"ball", "capsule", "cylinder", "box", "polytope", "hull"},
    {"gear", "rotor", "viscous", "coulomb"},
    {"frame", "port", "const"},
    {"male", "female"},
    {"accel", "effort", "rate", "named"},
    {"aligned", "oriented"},
    {"contains", "matches"},
    set(NUMBERS),
    set(UNITS),
)
DEPTHS = (2, 5, 40, 99, 101, 250)
OPENERS = ("(", "[", "{", "-", "not ", "always ", "next ", "sin(", "1+", "2^", "(A|", "A until ")


@cache
def seeds() -> tuple[str, ...]:
    """The programs to start from: those of all pages, the specifications, and every construct.

    ``everything.srg`` holds each in the forms that the parser knows, with many other mistakes;
    ``complete.srg`` is valid.
    """
    folders = ("grammar_lang/diagnostics/catalogue", "tests/golden", "docs")
    pages = [page for folder in folders for page in sorted((ROOT / folder).rglob("*.md"))]
    blocks = [block for page in pages for block in BLOCK.findall(page.read_text("utf-8"))]
    files = [*(ROOT / "specs").glob("*.srg"), *Path(__file__).parent.glob("*.srg")]
    return tuple(dict.fromkeys([*blocks, *(file.read_text("utf-8") for file in sorted(files))]))


@cache
def valid_seeds() -> tuple[str, ...]:
    """Those without an error; the larger ones, which say more, several times."""
    valid = [text for text in seeds() if load_text(text, "t.srg").program is not None]
    return tuple(text for text in valid for _ in range(1 + len(text) // 500))


def _places(chance: random.Random, items: Sequence[object], count: int = 2) -> list[int]:
    return [chance.randrange(len(items)) for _ in range(count)]


def _shuffled(chance: random.Random, pieces: list[str], other: Callable[[], str]) -> str:
    """One to four pieces lost, repeated, exchanged or put in from elsewhere."""
    for _ in range(chance.randint(1, 4)):
        if not pieces:
            break
        here, there = _places(chance, pieces)
        match chance.randrange(5):
            case 0:
                del pieces[here]
            case 1:
                pieces[here] = pieces[there]
            case 2:
                pieces.insert(here, pieces[there])
            case 3:
                pieces[here], pieces[there] = pieces[there], pieces[here]
            case _:
                pieces[here] = other()
    return "".join(pieces)


def tokens(chance: random.Random, text: str) -> str:
    """Other words and signs."""
    return _shuffled(chance, TOKEN.findall(text), lambda: chance.choice(WORDS))


def characters(chance: random.Random, text: str) -> str:
    """Other characters, some that the language does not know."""
    return _shuffled(chance, list(text), lambda: chance.choice(NOISE))


def statements(chance: random.Random, text: str) -> str:
    """Statements, or their heads, that are lost, doubled or stand elsewhere."""
    pieces = STATEMENT.findall(text)
    borrowed = STATEMENT.findall(chance.choice(seeds()))
    return _shuffled(chance, pieces, lambda: chance.choice(borrowed))


def meanings(chance: random.Random, text: str) -> str:
    """Words, numbers, units and signs with others of their kind in their place: still a program."""
    pieces = TOKEN.findall(text)
    keywords = {*tables().words, *RESERVED, *UNITS}
    own = [piece for piece in pieces if piece[0].isalpha() and piece not in keywords] or ["A"]
    for _ in range(chance.randint(2, 10)):
        here = _places(chance, pieces)[0]
        piece = pieces[here]
        alike = [sorted(kind) for kind in ALIKE if piece in kind]
        if piece[0].isdigit():
            pieces[here] = chance.choice(NUMBERS)
        elif alike:
            pieces[here] = chance.choice(chance.choice(alike))
        elif piece in own:
            pieces[here] = chance.choice(own)
    return "".join(pieces)


def clauses(chance: random.Random, text: str) -> str:
    """Statements lost, doubled, exchanged or borrowed; every brace stays where it is."""
    pieces = STATEMENT.findall(text)
    places = [i for i, piece in enumerate(pieces) if piece.endswith(";")]
    if not places:
        return text
    borrowed = [piece for piece in STATEMENT.findall(chance.choice(seeds())) if piece[-1:] == ";"]
    for _ in range(chance.randint(1, 2)):
        here, there = chance.choice(places), chance.choice(places)
        match chance.randrange(4):
            case 0:
                pieces[here] = ""
            case 1:
                pieces[here] += pieces[there]
            case 2:
                pieces[here], pieces[there] = pieces[there], pieces[here]
            case _:
                pieces[here] += chance.choice(borrowed) if borrowed else ""
    return "".join(pieces)


def nesting(chance: random.Random, text: str) -> str:
    """Brackets and prefixes, many of them, some closed again; or a bracket that is lost."""
    pieces = TOKEN.findall(text)
    here, there = sorted(_places(chance, pieces))
    brackets = [i for i, piece in enumerate(pieces) if piece in set("()[]{}")]
    if brackets and chance.random() < 0.3:
        del pieces[chance.choice(brackets)]
        return "".join(pieces)
    opener, depth = chance.choice(OPENERS), chance.choice(DEPTHS)
    closer = {"(": ")", "[": "]", "{": "}"}.get(opener[-1], ")" if "(" in opener else "")
    if chance.random() < 0.7:
        there = min(here + 1, len(pieces) - 1)  # about one token, which may well be allowed
        here = there - 1
        pieces.insert(there, closer * depth)
    pieces.insert(here, opener * depth)
    return "".join(pieces)


def splices(chance: random.Random, text: str) -> str:
    """The beginning of one program and the end of another."""
    cut = chance.choice((TOKEN, STATEMENT))
    first, second = cut.findall(text), cut.findall(chance.choice(seeds()))
    return "".join(first[: _places(chance, first)[0]] + second[_places(chance, second)[0] :])


def spoilt_bytes(chance: random.Random, text: str) -> bytes:
    """Bytes that are flipped, lost or doubled; mostly no UTF-8 where the text was not ASCII."""
    data = bytearray(text.encode())
    for _ in range(chance.randint(1, 3)):
        if not data:
            break
        here, there = sorted(_places(chance, data))
        match chance.randrange(4):
            case 0:
                data[here] ^= 1 << chance.randrange(8)
            case 1:
                data[here] = chance.randrange(256)
            case 2:
                del data[here:there]
            case _:
                data[here:here] = data[here : min(there, here + 40)]
    return bytes(data)


MUTATIONS = (tokens, characters, statements, nesting, splices)
MILD = (meanings, meanings, clauses)


def spoilt_text(chance: random.Random) -> str:
    """A program with one mutation, seldom two; half of them leave it fit for the later checks."""
    kinds, start = chance.choice(((MUTATIONS, seeds()), (MILD, valid_seeds())))
    text = chance.choice(start)
    for _ in range(1 if chance.random() < 0.8 else 2):
        text = chance.choice(kinds)(chance, text) or ";"
    return text
