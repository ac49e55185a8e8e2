"""The specs that come with srgc: they check, their words are those meant, and their robots exist.

What is expected is written out here: words by hand or by a regular expression, and the positions
of the hands by walking along the word with complex numbers.
"""

from __future__ import annotations

import cmath
import csv
import json
import re
from collections.abc import Callable, Sequence
from itertools import product
from pathlib import Path

import pytest

from tests.oracles import result_files
from tests.oracles.some_cases import some
from tests.srgc.conftest import ROOT, Ran

Run = Callable[..., Ran]
Made = Callable[[str], Path]
Values = dict[int, float]
"""Angles or lengths, by the position of their module in the word."""

SPECS = sorted((ROOT / "specs").glob("*.srg"))
NESTED, RIGHT_LINEAR, TWO_ARM = (
    ROOT / "specs" / f"{name}.srg" for name in ("nested", "right_linear", "two_arm")
)


def test_none_is_left_out() -> None:
    assert {NESTED, RIGHT_LINEAR, TWO_ARM} < set(SPECS)


@pytest.mark.parametrize("path", SPECS, ids=lambda path: path.stem)
def test_they_check_without_findings(path: Path, srgc: Run) -> None:
    """But for notes: which bodies may touch, how many robots of one word there are, and of maps."""
    ran = srgc("check", "--json", path)
    codes = {finding["code"] for finding in json.loads(ran.out)}
    assert ran.status == 0
    assert codes <= {"SRG0718", "SRG0408", "SRG0611"}
    assert srgc("fmt", "--check", path).status == 0


# --- words --------------------------------------------------------------------------------------


def words(srgc: Run, path: Path, longest: int) -> list[str]:
    return srgc("words", path, "--max-length", longest, "--limit", 10**6).out.splitlines()


def counts(srgc: Run, path: Path, longest: int) -> list[int]:
    lines = srgc("words", path, "--count", "--max-length", longest).out.splitlines()
    return [int(line.split()[1]) for line in lines]


def is_accepted(srgc: Run, path: Path, word: str) -> bool:
    status = srgc("accepts", path, *word.split()).status
    assert status in (0, 1)
    return status == 0


def pairs(motors: int, links: int) -> str:
    return "B" + motors * " eps M" + links * " eps L" + " eps EN"


def test_nested_words_are_matched_pairs(srgc: Run) -> None:
    """One word for every number of pairs, and none besides."""
    longest = 4 * 12 + 3
    assert words(srgc, NESTED, longest) == [pairs(n, n) for n in range(1, 13)]
    assert counts(srgc, NESTED, longest) == [
        int(length >= 7 and length % 4 == 3) for length in range(longest + 1)
    ]


def test_nested_words_need_a_stack(srgc: Run) -> None:
    """Of the beginnings with i motors every two differ in an ending (Myhill, Nerode)."""
    for motors, links in product(range(7), repeat=2):
        expected = motors == links > 0
        assert is_accepted(srgc, NESTED, pairs(motors, links)) == expected, (motors, links)
    assert is_accepted(srgc, NESTED, pairs(1000, 1000))
    assert not is_accepted(srgc, NESTED, pairs(1000, 999))


@pytest.mark.parametrize(
    "word",
    [
        "B", "B eps EN", "M eps L", "B M L EN", "B eps M eps L", "B eps L eps M eps EN",
        "B eps M eps L eps EN eps", "B eps M eps L eps M eps L eps EN",
        "B eps M eps L eps L eps M eps EN", "B eps M eps L eps EN eps EN",
    ],
)  # fmt: skip
def test_what_is_no_nested_word(word: str, srgc: Run) -> None:
    assert not is_accepted(srgc, NESTED, word)


LETTERS = {"B": "B", "JO": "J", "L": "L", "EN": "E", "eps": "-"}
ALTERNATING = re.compile(r"B-(J-L-)+E")


def test_right_linear_words_are_those_of_a_regular_expression(srgc: Run) -> None:
    """Against all words of up to 7 symbols, and of up to 15 with an edge at every other place."""
    order = {name: number for number, name in enumerate(LETTERS)}
    short = [word for n in range(8) for word in product(LETTERS, repeat=n)]
    modules = [name for name in LETTERS if name != "eps"]
    chains = [chain for n in range(5, 9) for chain in product(modules, repeat=n)]
    long = [tuple(" eps ".join(chain).split()) for chain in chains]
    expected = sorted(
        {w for w in [*short, *long] if ALTERNATING.fullmatch("".join(LETTERS[s] for s in w))},
        key=lambda word: (len(word), [order[symbol] for symbol in word]),
    )
    assert [len(word) for word in expected] == [7, 11, 15]
    assert words(srgc, RIGHT_LINEAR, 15) == [" ".join(word) for word in expected]


@pytest.mark.parametrize(
    "word",
    [
        "B eps JO eps L eps EN", "B eps JO eps L eps JO eps L eps EN", "B eps EN",
        "B eps JO eps EN", "B eps L eps EN", "B eps JO eps L eps L eps EN",
        "B eps JO eps JO eps L eps EN", "B eps JO eps L", "B eps JO eps L eps EN eps EN",
        "JO eps L eps EN", "B JO L EN", "B" + 2000 * " eps JO eps L" + " eps EN",
        "B" + 2000 * " eps JO eps L" + " eps JO eps EN",
    ],
    ids=lambda word: word[-40:],
)  # fmt: skip
def test_right_linear_membership(word: str, srgc: Run) -> None:
    letters = "".join(LETTERS[symbol] for symbol in word.split())
    assert is_accepted(srgc, RIGHT_LINEAR, word) == bool(ALTERNATING.fullmatch(letters))


def arm(links: int) -> str:
    return links * "JO eps L eps " + "EN"


def two_arms(left: int, right: int) -> str:
    return f"B eps W eps T [ {arm(left)} ] [ {arm(right)} ]"


def test_two_arms_of_any_lengths(srgc: Run) -> None:
    most = 6
    longest = len(two_arms(1, most).split())
    expected = {
        two_arms(left, right)
        for left, right in product(range(1, most + 1), repeat=2)
        if left + right <= most + 1
    }
    found = words(srgc, TWO_ARM, longest)
    assert len(found) == len(set(found))
    assert set(found) == expected
    assert sum(counts(srgc, TWO_ARM, longest)) == len(expected)


def test_two_hands_and_balanced_brackets(srgc: Run) -> None:
    for word in words(srgc, TWO_ARM, 43):
        depth, hands, arms = 0, [], 0
        for symbol in word.split():
            depth += {"[": 1, "]": -1}.get(symbol, 0)
            arms += symbol == "["
            assert 0 <= depth <= 1
            if symbol == "EN":
                hands.append((arms, depth))
        assert depth == 0
        assert hands == [(1, 1), (2, 1)], word


@pytest.mark.parametrize(
    "word",
    [
        "B eps W eps T", f"B eps W eps T [ {arm(1)} ]", f"B eps W eps T {arm(1)} {arm(1)}",
        f"B eps W eps T [ {arm(1)} ] {arm(1)}", f"B eps W eps T [ {arm(1)} [ {arm(1)} ] ]",
        f"B eps W eps T [ {arm(1)} ] [ {arm(1)} ] [ {arm(1)} ]",
        f"B eps W eps T [ {arm(0)} ] [ {arm(1)} ]", f"B eps T [ {arm(1)} ] [ {arm(1)} ]",
        f"B eps W eps T [ {arm(1)} ] [ {arm(1)}", f"B eps W eps T ] {arm(1)} [ ] {arm(1)} [",
    ],
)  # fmt: skip
def test_what_is_no_two_armed_robot(word: str, srgc: Run) -> None:
    assert not is_accepted(srgc, TWO_ARM, word)


# --- robots -------------------------------------------------------------------------------------


def serial_hands(word: Sequence[str], angles: Values, lengths: Values) -> list[complex]:
    """Every joint turns what comes after it in the word."""
    place, heading = 0j, 0.0
    for position in range(len(word)):
        heading += angles.get(position, 0.0)
        place += cmath.rect(lengths.get(position, 0.0), heading)
    return [place]


def cable_hands(word: Sequence[str], angles: Values, lengths: Values) -> list[complex]:
    """The last motor of the word turns the first link."""
    place, heading = 0j, 0.0
    for motor, link in zip(sorted(angles, reverse=True), sorted(lengths), strict=True):
        assert (word[motor], word[link]) == ("M", "L")
        heading += angles[motor]
        place += cmath.rect(lengths[link], heading)
    return [place]


def branching_hands(word: Sequence[str], angles: Values, lengths: Values) -> list[complex]:
    """A bracket opens at an end of the beam, left before right, and closes back on the beam."""
    beam, hands = angles[word.index("W")], list[complex]()
    place, heading = 0j, beam
    for position, symbol in enumerate(word):
        if symbol == "[":
            heading = beam + (cmath.pi / 2 if not hands else -cmath.pi / 2)
            place = cmath.rect(0.5, heading)
        elif symbol in ("JO", "L"):
            heading += angles.get(position, 0.0)
            place += cmath.rect(lengths.get(position, 0.0), heading)
        elif symbol == "EN":
            hands.append(place)
    return hands


HANDS = {"right_linear": serial_hands, "nested": cable_hands, "two_arm": branching_hands}
FOUND = {
    "right_linear": "B eps JO eps L eps JO eps L eps EN",
    "nested": pairs(2, 2),
    "two_arm": two_arms(1, 2),
}
"""The shortest words whose robots have two links for the far end; a single one is refuted."""

ENDS = {
    # (hand, x from, x to, y from, y to) at the first and at the last instant
    "right_linear": ((0, 0.7, 0.9, -0.9, -0.7), (0, 1.2, 1.5, 0.5, 0.8)),
    "nested": ((0, 0.8, 1.0, -0.1, 0.1), (0, -0.2, 0.2, 1.5, 1.8)),
    "two_arm": ((0, 0.7, 0.95, -0.2, 0.2), (1, 1.2, 1.4, -0.2, 0.2)),
}


def inside(hands: Sequence[complex], box: tuple[int, float, float, float, float]) -> bool:
    hand, left, right, low, high = box
    return left < hands[hand].real < right and low < hands[hand].imag < high


@pytest.mark.parametrize("name", some(["nested", "right_linear", "two_arm"], 1))
def test_a_robot_is_found_and_verified(name: str, srgc: Run, made: Made) -> None:
    folder = made(name) / "out"
    ran = srgc("verify", folder, "--spec", ROOT / "specs" / f"{name}.srg")
    assert (ran.status, ran.out.splitlines()[0]) == (0, "valid: found, level validated")
    design = result_files.read(folder, "design.json")
    assert " ".join(design["word"]) == FOUND[name]
    assert {s["verdict"] for s in design["structures_tried"][:-1]} == {"refuted"}
    lengths = {item["symbol"]: item["value"] for item in design["parameters"]}
    joints = [dof["symbols"][0] for dof in design["dofs"]]
    with (folder / "trajectory.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    walked = []
    for row in rows:
        angles = {joint: float(row[f"q{i}"]) for i, joint in enumerate(joints, 1)}
        hands = HANDS[name](design["word"], angles, lengths)
        walked.append(hands)
        for number, hand in enumerate(hands, 1):
            given = complex(float(row[f"e{number}_x"]), float(row[f"e{number}_y"]))
            assert abs(given - hand) < 1e-6
        assert f"e{len(hands) + 1}_x" not in row
    first, last = ENDS[name]
    assert inside(walked[0], first)
    assert inside(walked[-1], last)
    assert not inside(walked[0], last), "nothing has to move"
