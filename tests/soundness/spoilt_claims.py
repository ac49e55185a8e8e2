"""Certificates and specs spoilt at random: in any field, by a digit, by much, or fittingly."""

from __future__ import annotations

import random
import re
from collections.abc import Callable, Mapping, Sequence
from copy import deepcopy
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, TypeAlias

from tests.soundness.judged_claims import InputRange, peak_and_margin

Content: TypeAlias = dict[str, Any]
DECIMAL = re.compile(r"-?[0-9]+(\.[0-9]+)?")
ODD = ("", "nan", "1e5", "-", "1/0", "0x10", " 1", "1.", "9" * 310, "١", "\x00", "\U0001f916")
OTHER_TYPES: tuple[Any, ...] = (None, True, 0, 1.5, "", [], {}, [[]], -1, 2.0)


@dataclass(frozen=True)
class Spoilt:
    """What was done, the certificate, and the text of its spec."""

    how: str
    content: Content
    text: str


def exact_text(value: Fraction) -> str:
    """A finite decimal."""
    power = 0
    while (value * 10**power).denominator > 1:
        power += 1
    digits = str(abs(value.numerator) * 10**power // value.denominator).rjust(power + 1, "0")
    whole = f"{digits[:-power]}.{digits[-power:]}" if power else digits
    return ("-" if value < 0 else "") + whole


def nudged(chance: random.Random, text: str) -> str:
    """A decimal changed by one in its last digit."""
    digits = len(text.partition(".")[2])
    return exact_text(Fraction(text) + chance.choice((-1, 1)) * Fraction(1, 10**digits))


def moved(chance: random.Random, text: str) -> str:
    """A decimal changed by an amount of any size, some of them large."""
    value = Fraction(text)
    size = Fraction(10) ** chance.randint(-9, 1) * chance.randint(1, 9)
    return exact_text(
        chance.choice((value + size, value - size, -value, value * 10, value / 2, Fraction(0)))
    )


def leaves(node: object, path: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """The paths to all that is neither an object nor a list, and to those."""
    found = [path] if path else []
    items: Sequence[tuple[Any, Any]] = ()
    if isinstance(node, dict):
        items = list(node.items())
    elif isinstance(node, list):
        items = list(enumerate(node))
    for key, value in items:
        found += leaves(value, (*path, key))
    return found


def value_at(content: Any, path: Sequence[Any]) -> Any:
    for key in path:
        content = content[key]
    return content


def put(content: Any, path: Sequence[Any], value: Any) -> None:
    value_at(content, path[:-1])[path[-1]] = value


def _changed_text(chance: random.Random, text: str, others: Sequence[str]) -> str:
    if DECIMAL.fullmatch(text) and chance.random() < 0.9:
        return chance.choice((nudged, moved))(chance, text)
    if "/" in text and chance.random() < 0.5:
        return text.replace("/", "/1", 1)
    return chance.choice((*others, chance.choice(ODD), text + "x", text[:-1]))


def _changed(chance: random.Random, value: Any, others: Sequence[str]) -> Any:
    """Another value, mostly of the same type."""
    if chance.random() < 0.08:
        return chance.choice(OTHER_TYPES)
    if isinstance(value, str):
        return _changed_text(chance, value, others)
    if isinstance(value, bool) or value is None:
        return chance.choice((not value, 0, 1, others[0]))
    if isinstance(value, int):
        return value + chance.choice((-1, 1, -value, 10**6, -(10**6)))
    if isinstance(value, list):
        return _rearranged(chance, value)
    return _other_keys(chance, value)


def _rearranged(chance: random.Random, items: list[Any]) -> list[Any]:
    found = list(items)
    if not found:
        return [chance.choice(OTHER_TYPES)]
    here, there = chance.randrange(len(found)), chance.randrange(len(found))
    match chance.randrange(4):
        case 0:
            del found[here]
        case 1:
            found.insert(there, found[here])
        case 2:
            found[here], found[there] = found[there], found[here]
        case _:
            found = found[:here]
    return found


def _other_keys(chance: random.Random, item: Mapping[str, Any]) -> dict[str, Any]:
    found = dict(item)
    key = chance.choice(sorted(found))
    value = found.pop(key)
    if chance.random() < 0.5:
        found[key + "2"] = value
    return found


# --- kinds of mutation ---------------------------------------------------------------------------


def any_field(chance: random.Random, content: Content) -> str:
    """One place of one field; the fields are drawn first, so that all have their turn."""
    name = chance.choice(sorted(set(content) - {"digest"}))
    inner = leaves(content[name], (name,))
    path = chance.choice(inner)
    texts = [v for v in (value_at(content, p) for p in inner) if isinstance(v, str)] or ["x"]
    before = value_at(content, path)
    for _ in range(20):
        after = _changed(chance, before, texts)
        if after != before or type(after) is not type(before):
            put(content, path, after)
            break
    return f"{'.'.join(map(str, path))}: {before!r:.60} -> {value_at(content, path)!r:.60}"


def one_number(chance: random.Random, content: Content) -> str:
    """A number that the proof depends on, by a digit or by much."""
    named = ("inputs", "start", "parameters")
    paths = [p for name in named for p in leaves(content.get(name, []), (name,))]
    values = [(p, value_at(content, p)) for p in paths]
    fit = [(p, v) for p, v in values if isinstance(v, str) and DECIMAL.fullmatch(v)]
    if not fit:
        return any_field(chance, content)
    path, before = chance.choice(fit)
    put(content, path, chance.choice((nudged, moved))(chance, before))
    return f"{'.'.join(map(str, path))}: {before} -> {value_at(content, path)}"


def swapped_steps(chance: random.Random, content: Content) -> str:
    """The inputs of two steps exchanged, or moved by one step, or those of two joints exchanged."""
    rows = content.get("inputs")
    if not rows:
        return any_field(chance, content)
    a, b = chance.randrange(len(rows)), chance.randrange(len(rows))
    match chance.randrange(3):
        case 0:
            rows[a], rows[b] = rows[b], rows[a]
        case 1:
            rows.insert(b, rows.pop(a))
        case _:
            rows[a] = rows[a][::-1]
    return f"steps {a} and {b} exchanged"


def shortened_word(chance: random.Random, content: Content) -> str:
    """A module and its label less, or one more, and the inputs as the shapes then have to be."""
    if "inputs" not in content:
        return any_field(chance, content)
    labels, word = content["derivation"], content["word"]
    here = chance.randrange(len(labels))
    if chance.random() < 0.5:
        del labels[here]
        place = 2 * max(1, len(labels) - here)
        del word[place - 1 : place + 1]
        parameters = [p for p in content["parameters"] if p["symbol"] != place]
        for item in parameters:
            item["symbol"] -= 2 * (item["symbol"] > place)
        content["parameters"] = parameters
    else:
        labels.insert(here, labels[here])
        place = chance.randrange(1, len(word) + 1)
        word[place:place] = ["eps", chance.choice(word)]
    if chance.random() < 0.3:
        content["inputs"] = [row[:-1] for row in content["inputs"]]
        content["start"] = content["start"][::2]
    return f"label {here} of the derivation"


KINDS: tuple[Callable[[random.Random, Content], str], ...] = (
    any_field, any_field, any_field, one_number, one_number, swapped_steps, shortened_word,
)  # fmt: skip


def restate(content: Content, ranges: Sequence[InputRange]) -> None:
    """State peak and robustness as the inputs have them, where these are numbers."""
    try:
        rows = [[Fraction(text) for text in row] for row in content["inputs"]]
        peak, margin = peak_and_margin(rows, ranges)
    except (ValueError, TypeError, ZeroDivisionError, KeyError):
        return
    content["effort_peak"], content["robustness"] = exact_text(peak), exact_text(margin)


FIGURE = re.compile(r"(?<![\w.])-?[0-9]+(?:\.[0-9]+)?(?![\w.])")


def other_text(chance: random.Random, text: str) -> str:
    """One number of the workspace or of the task changed."""
    begin = text.index("workspace ")
    lines = [(m, text.rfind("\n", 0, m.start())) for m in FIGURE.finditer(text, begin)]
    places = [m for m, line in lines if "//" not in text[line : m.start()]]
    place = chance.choice(places)
    change = chance.choice((nudged, moved))
    changed = change(chance, place.group())
    return text[: place.start()] + changed + text[place.end() :]


def spoilt(
    chance: random.Random,
    content: Content,
    text: str,
    ranges: Sequence[InputRange] | None = None,
) -> Spoilt:
    """One mutation; with the ranges of the inputs, peak and robustness may be stated anew."""
    changed, kind = deepcopy(content), chance.random()
    if kind < 0.1:
        return Spoilt("spec", changed, other_text(chance, text))
    how = chance.choice(KINDS)(chance, changed)
    if ranges is not None and chance.random() < 0.6:
        restate(changed, ranges)
    return Spoilt(how, changed, text)
