"""The families of the specs whose certificates are spoilt, written down by hand.

Per family: which word a derivation gives, which words are accepted, the ranges of the parameters,
and the arm of a word.  Nothing is read from the specs but workspace and task.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import pairwise
from math import pi, radians

from tests.oracles.hand_arms import Drive, HandArm

Word = tuple[str, ...]
Values = Mapping[int, float]
"""Parameters by the place of their module in the word."""
Domain = tuple[Fraction, Fraction] | frozenset[Fraction]
EDGES = frozenset({"eps", "[", "]"})
F = Fraction


@dataclass(frozen=True)
class Family:
    """``inputs`` bounds the inputs that modules declare, ``own`` tells modules with parameters."""

    word: Callable[[Sequence[str]], Word | None]
    accepts: Callable[[Word], bool]
    arm: Callable[[Word, Values], HandArm]
    own: Mapping[str, tuple[str, Domain]]
    inputs: Mapping[str, tuple[Fraction, Fraction]] = field(default_factory=dict)
    joints: frozenset[str] = frozenset({"JO", "M", "P", "R", "W"})

    def bare(self, word: Word) -> list[str]:
        """The modules alone."""
        return [symbol for symbol in word if symbol not in EDGES]

    def is_regular(self, word: Word) -> bool:
        """No joint beside another of its name or without anything behind it: no merging.

        Words of other orders are judged all the same where their robots are regular.
        """
        modules = self.bare(word)
        merging = self.joints - {"P"}
        return not any(a in merging and b in {*merging, "EN"} for a, b in pairwise(modules))


def _left(symbols: Mapping[str, str]) -> Callable[[Sequence[str]], Word | None]:
    """Grammars ``N -> B`` and ``N -> N eps X``: the leftmost derivation is the word reversed."""

    def word(labels: Sequence[str]) -> Word | None:
        if list(labels).count("base") != 1 or labels[-1] != "base":
            return None
        if any(label not in symbols for label in labels):
            return None
        parts = [symbols[label] for label in reversed(labels)]
        return tuple(" eps ".join(parts).split())

    return word


# --- chains in the plane -------------------------------------------------------------------------


def _rods(
    joints: Mapping[str, tuple[float, Drive, tuple[float, float] | None]],
    density: Mapping[str, float],
    tool: float = 0,
) -> Callable[[Word, Values], HandArm]:
    """Joints about z with a half-range in rad and a drive, rods along x, a point mass at tools."""

    def arm(word: Word, values: Values) -> HandArm:
        made = HandArm()
        for index, symbol in enumerate(word):
            if symbol in joints:
                half, drive, rate = joints[symbol]
                made.joint(index, 2, limits=(-half, half), rate=rate, drive=drive)
            elif symbol in density:
                length = values[index]
                made.rod(0, length, density[symbol]).move(length)
            elif symbol == "EN":
                if tool:
                    made.point(tool)
                made.effector()
        return made

    return arm


PLAIN = Drive()


def _motor(resistance: float, inductance: float, constant: float) -> Drive:
    return Drive(
        lambda _q, _v, s, _u: constant * s[0],
        lambda _q, v, s, u: [(u - resistance * s[0] - constant * v) / inductance],
        (0.0,),
    )


VOLTS = {"M": (F(-24), F(24))}
CHAIN = {"base": "B", "joint": "JO", "link": "L", "tool": "EN"}


def _turner(word: Word) -> bool:
    return "EN" in word and word[:3] == ("B", "eps", "JO")


def _turning(modules: str) -> Callable[[Word], bool]:
    return lambda word: "EN" in word and word[:3] == ("B", "eps", modules)


def _lengths(low: str, high: str) -> dict[str, tuple[str, Domain]]:
    return {"L": ("length", (F(low), F(high)))}


TURNER = Family(
    _left(CHAIN), _turner, _rods({"JO": (pi, PLAIN, None)}, {"L": 1}), _lengths("1", "2")
)
MOTOR = Family(
    _left({**CHAIN, "joint": "M"}),
    _turning("M"),
    _rods({"M": (pi, _motor(1.5, 0.3, 0.8), None)}, {"L": 1}),
    _lengths("1", "2"),
    VOLTS,
)
PLANAR = Family(
    _left(CHAIN), _turner, _rods({"JO": (pi, PLAIN, None)}, {"L": 1}), _lengths("0.5", "5")
)
PAPER = Family(
    _left({"base": "B", "joint": "JO", "link1": "L1", "link2": "L2", "tool": "EN"}),
    _turner,
    _rods({"JO": (pi, PLAIN, None)}, {"L1": 1, "L2": 1}),
    {"L1": ("length", (F("2.23"), F("2.23"))), "L2": ("length", (F("3.35"), F("3.35")))},
)
PATROL = Family(
    _left(CHAIN),
    lambda word: _turner(word) and word[-1] == "EN" and word.count("EN") == 1,
    _rods({"JO": (pi, PLAIN, None)}, {"L": 1}),
    _lengths("0.5", "3"),
)


def _motor_words(word: Word) -> bool:
    modules = list(word[::2])
    inner = modules[2:-1]
    return (
        modules[:2] == ["B", "M"]
        and modules[-1] == "EN"
        and len(modules) > 2
        and set(inner) <= {"JO", "L"}
        and inner.count("JO") <= 1
    )


MOTOR_ARM = Family(
    _left({**CHAIN, "motor": "M"}),
    _motor_words,
    _rods(
        {
            "M": (radians(170), _motor(1.5, 0.3, 0.8), (-4.0, 4.0)),
            "JO": (radians(170), Drive(lambda _q, v, _s, u: u - 0.3 * v), None),
        },
        {"L": 1.2},
        0.3,
    ),
    _lengths("0.4", "1"),
    VOLTS,
)


# --- other grammars ------------------------------------------------------------------------------


def _hoist_word(labels: Sequence[str]) -> Word | None:
    *body, last = labels if labels else [""]
    if not body or body[0] != "foot" or last != "hook" or len(body) % 2:
        return None
    if body[1:] != [*(["turn", "on"] * (len(body) // 2 - 1)), "turn"]:
        return None
    return tuple(f"B eps {' eps '.join(['JO eps L'] * (len(body) // 2))} eps EN".split())


HOIST = Family(
    _hoist_word,
    lambda _word: True,
    _rods({"JO": (radians(170), PLAIN, None)}, {"L": 1.5}, 0.2),
    {"L": ("length", frozenset({F("0.4"), F("0.6"), F("0.8"), F(1)}))},
)


def _cable_word(labels: Sequence[str]) -> Word | None:
    if len(labels) < 2 or labels[0] != "whole" or labels[-1] != "inner":
        return None
    if any(label != "outer" for label in labels[1:-1]):
        return None
    pairs = len(labels) - 1
    parts = ["B", *["M"] * pairs, *["L"] * pairs, "EN"]
    return tuple(" eps ".join(parts).split())


def _cable_arm(word: Word, values: Values) -> HandArm:
    """The innermost motor and link are at the base."""
    motors = [i for i, symbol in enumerate(word) if symbol == "M"]
    links = [i for i, symbol in enumerate(word) if symbol == "L"]
    made = HandArm()
    for motor, link in zip(reversed(motors), links, strict=True):
        made.joint(motor, 2, limits=(-radians(160), radians(160)))
        made.rod(0, values[link], 1).move(values[link])
    return made.effector()


CABLES = Family(
    _cable_word, lambda _word: True, _cable_arm, _lengths("0.5", "1.5"), joints=frozenset()
)


def _arms_word(labels: Sequence[str]) -> Word | None:
    if not labels or labels[0] != "beam":
        return None
    rest, hands = list(labels[1:]), list[str]()
    for _ in range(2):
        links = 1
        while rest and rest[0] == "longer":
            rest, links = rest[1:], links + 1
        if not rest or rest[0] != "hand":
            return None
        rest = rest[1:]
        hands.append(" eps ".join(["JO eps L"] * links))
    if rest:
        return None
    return tuple(f"B eps W eps T [ {hands[0]} eps EN ] [ {hands[1]} eps EN ]".split())


def _two_arms(word: Word, values: Values) -> HandArm:
    made = HandArm().joint(word.index("W"), 2, limits=(-radians(170), radians(170)))
    made.rod(1, 1.0, 6, start=-0.5)
    beam, side = made.place, 1
    for index, symbol in enumerate(word):
        if symbol == "[":
            made.place = beam
            made.move(y=0.5 * side).turn(2, side * pi / 2)
            side = -side
        elif symbol == "JO":
            made.joint(index, 2)
        elif symbol == "L":
            made.rod(0, values[index], 2).move(values[index])
        elif symbol == "EN":
            made.point(0.5).effector()
    return made


TWO_ARMS = Family(
    _arms_word,
    lambda _word: True,
    _two_arms,
    _lengths("0.3", "0.5"),
    joints=frozenset({"JO"}),
)


def _gantry_words(word: Word) -> bool:
    modules = list(word[::2])
    inner = modules[1:-1]
    return (
        modules[0] == "B"
        and modules[-1] == "EN"
        and len(inner) > 0
        and set(inner) <= {"R", "P", "K", "L"}
        and inner.count("R") <= 1
        and inner.count("P") <= 2
    )


def _gantry(word: Word, values: Values) -> HandArm:
    made = HandArm()
    for index, symbol in enumerate(word):
        if symbol == "R":
            made.joint(index, 2, limits=(-radians(120), radians(120)), rate=(-3.0, 3.0))
        elif symbol == "P":
            made.joint(index, 0, "slide", (0.0, 0.6), (-1.5, 1.5))
            made.rod(0, 0.6, 2, start=-0.6)
        elif symbol == "K":
            made.point(0.2).turn(2, values[index])
        elif symbol == "L":
            made.rod(0, values[index], 1.5).move(values[index])
        elif symbol == "EN":
            made.point(0.4).effector()
    return made


GANTRY = Family(
    _left({"base": "B", "turn": "R", "slide": "P", "bend": "K", "link": "L", "tool": "EN"}),
    _gantry_words,
    _gantry,
    {"L": ("length", (F("0.2"), F("0.8")))},
    joints=frozenset({"R"}),
)


def _slider(_word: Word, _values: Values) -> HandArm:
    return HandArm().joint(2, 0, "slide", (0.0, 3.0)).point(1).effector()


SLIDER = Family(
    _left({"base": "B", "slide": "P", "load": "M", "tool": "EN"}),
    lambda word: word == ("B", "eps", "P", "eps", "M", "eps", "EN"),
    _slider,
    {},
    joints=frozenset(),
)


# --- in space ------------------------------------------------------------------------------------


def _spatial(word: Word, values: Values) -> HandArm:
    made = HandArm().move(z=0.3).joint(2, 2, limits=(-radians(150), radians(150)))
    long, short = values[word.index("L")], values[word.index("S")]
    made.solid(1.5, (long / 2, 0, 0), (0.01, 0.04, 0.045)).move(long).turn(0, radians(30))
    made.joint(6, 1, limits=(-radians(110), radians(110)), rate=(-5.0, 5.0))
    made.solid(0.7, (short / 3, 0.02, 0), (0.004, 0.009, 0.01)).move(short)
    return made.point(0.1).effector()


SPATIAL = Family(
    _left({"base": "B", "waist": "Z", "shoulder": "Y", "long": "L", "short": "S", "tool": "EN"}),
    lambda word: word[::2] == ("B", "Z", "L", "Y", "S", "EN"),
    _spatial,
    {"L": ("length", (F("0.4"), F("0.7"))), "S": ("length", (F("0.2"), F("0.35")))},
    joints=frozenset(),
)

FAMILIES: Mapping[str, Family] = {
    "turner": TURNER,
    "slider": SLIDER,
    "motor": MOTOR,
    "planar_arm": PLANAR,
    "planar_arm_paper": PAPER,
    "planar_arm_body": PLANAR,
    "patrol": PATROL,
    "motor_arm": MOTOR_ARM,
    "right_linear": HOIST,
    "nested": CABLES,
    "two_arm": TWO_ARMS,
    "prismatic": GANTRY,
    "spatial": SPATIAL,
}
