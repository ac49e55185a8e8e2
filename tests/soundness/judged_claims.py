"""Whether the claim of a certificate is true, judged without any code of the project.

What is exact is computed in rational numbers; the motion is simulated and its distances to all
limits are sampled.  A claim whose least distance is within 1e-6 of zero is not judged.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from fractions import Fraction
from typing import Any

import numpy as np

from compiler.arrays import Array
from tests.oracles.hand_arms import HandArm, SimulatedArm
from tests.oracles.hand_motions import Diverges, SampledMotion, sampled_motion
from tests.oracles.spec_figures import Area, Figures, cell_of, figures_of
from tests.soundness.known_families import Family

CLEAR = 1e-6
REST = 1e-3
SAMPLES = 2400
"""Over a whole motion, shared among its steps."""
TEXTS = ("task", "spec", "spec_sha256", "step", "effort_peak", "robustness", "digest", "kind")
LISTS = ("word", "derivation", "start", "parameters", "inputs", "path", "cuts")
NUMBER = re.compile(r"-?[0-9]+(\.[0-9]+|/[0-9]+)?")


class Truth(Enum):
    TRUE = "true"
    FALSE = "false"
    UNCLEAR = "unclear"


@dataclass(frozen=True)
class Judgement:
    truth: Truth
    why: str


class FalseClaim(Exception):
    """The claim is false, or no claim."""


class Unclear(Exception):
    """Nothing can be said."""


@dataclass(frozen=True)
class Original:
    """The result that was spoilt: its certificate, its spec and the cells of its design."""

    certificate: Mapping[str, Any]
    text: str
    cells: Mapping[str, Sequence[str]]


def judged(
    claim: Mapping[str, Any],
    text: str,
    original: Original,
    family: Family,
    samples: int = SAMPLES,
) -> Judgement:
    """Judge a claim of a found robot against the text of the spec that it comes with."""
    try:
        slacks = _slacks(claim, text, original, family, samples)
        least, what = min(slacks, default=(1.0, "nothing"))
    except FalseClaim as error:
        return Judgement(Truth.FALSE, str(error))
    except Unclear as error:
        return Judgement(Truth.UNCLEAR, str(error))
    if least < -CLEAR:
        return Judgement(Truth.FALSE, f"{what}: {least:.3g}")
    if least > CLEAR:
        return Judgement(Truth.TRUE, f"{what}: {least:.3g}")
    return Judgement(Truth.UNCLEAR, f"{what}: {least:.3g}")


def _slacks(
    claim: Mapping[str, Any], text: str, original: Original, family: Family, samples: int
) -> list[tuple[float, str]]:
    _well_formed(claim, original.certificate)
    try:
        figures = figures_of(text)
    except ValueError:
        raise Unclear("a region without interior") from None
    if claim["task"] != figures.task:
        raise FalseClaim("no such task")
    word = tuple(claim["word"])
    _structure(claim, word, figures, family)
    values = _parameters(claim, word, family)
    if not family.is_regular(word) or "K" in word:
        raise Unclear("a word whose joints may merge")
    made = family.arm(word, values)
    arm = SimulatedArm(made, figures.gravity)
    inputs = _inputs(claim, figures, input_ranges(word, arm, figures, family))
    start = _start(claim, arm, figures)
    effector = _effector(claim, made, figures)
    rows = [np.array([float(u) for u in row]) for row in inputs]
    try:
        fine = max(8, samples // figures.steps)
        motion = sampled_motion(arm, start, rows, float(figures.dt), fine)
    except Diverges:
        raise FalseClaim("the motion leaves all bounds") from None
    found = [*along(motion, arm, figures), *at_ends(motion, arm, figures, effector)]
    found += _formulas(text, motion, figures)
    known = text == original.text and claim["cuts"] == original.certificate["cuts"]
    if known:
        found += _path(claim["path"], motion, original)
    elif min(found)[0] > -CLEAR:
        raise Unclear("cells that are not known")
    return found


# --- what is exact -------------------------------------------------------------------------------


def _well_formed(claim: Mapping[str, Any], good: Mapping[str, Any]) -> None:
    """The fields of a certificate with the types that they have in a good one."""
    if claim.keys() != good.keys():
        raise FalseClaim("other fields")
    if any(claim[name] != good[name] for name in ("kind", "format", "spec")):
        raise FalseClaim("another kind, format or file")
    if not all(isinstance(claim[name], str) for name in TEXTS):
        raise FalseClaim("a text that is none")
    if any(type(claim[name]) is not int for name in ("effector", "steps", "format")):
        raise FalseClaim("a whole number that is none")
    if not all(isinstance(claim[name], list) for name in LISTS):
        raise FalseClaim("a list that is none")
    rows = [claim["word"], claim["derivation"], claim["start"], *claim["inputs"], *claim["path"]]
    if not all(isinstance(row, list) for row in rows):
        raise FalseClaim("a row that is none")
    if not all(isinstance(item, str) for row in rows for item in row):
        raise FalseClaim("a text in a list that is none")
    _well_formed_parameters(claim["parameters"])
    if claim["cuts"] and claim["cuts"] != good["cuts"]:
        raise Unclear("cuts")


def _well_formed_parameters(items: Sequence[Any]) -> None:
    for item in items:
        if not isinstance(item, dict) or item.keys() != {"symbol", "name", "value"}:
            raise FalseClaim("a parameter that is none")
        if type(item["symbol"]) is not int or not isinstance(item["name"], str):
            raise FalseClaim("a parameter that is none")


def _exact(text: object) -> Fraction:
    if not isinstance(text, str) or not NUMBER.fullmatch(text) or len(text) > 300:
        raise FalseClaim(f"{text!r:.40} is no number")
    try:
        return Fraction(text)
    except ZeroDivisionError:
        raise FalseClaim("a division by zero") from None


def _structure(
    claim: Mapping[str, Any], word: tuple[str, ...], figures: Figures, family: Family
) -> None:
    if not claim["derivation"] or family.word(claim["derivation"]) != word:
        raise FalseClaim("the derivation does not give the word")
    if not family.accepts(word):
        raise FalseClaim("the word is not accepted")
    if figures.modules is not None and len(family.bare(word)) > figures.modules:
        raise FalseClaim("too many modules")
    if claim["steps"] != figures.steps or _exact(claim["step"]) != figures.dt:
        raise FalseClaim("another horizon")


def _parameters(
    claim: Mapping[str, Any], word: tuple[str, ...], family: Family
) -> dict[int, float]:
    expected = [(i, family.own[s][0]) for i, s in enumerate(word) if s in family.own]
    if [(p["symbol"], p["name"]) for p in claim["parameters"]] != expected:
        raise FalseClaim("other parameters")
    values = {}
    for item in claim["parameters"]:
        value = _exact(item["value"])
        domain = family.own[word[item["symbol"]]][1]
        if isinstance(domain, frozenset):
            inside = value in domain
        else:
            inside = domain[0] <= value <= domain[1]
        if not inside:
            raise FalseClaim("a parameter outside its range")
        values[item["symbol"]] = float(value)
    return values


@dataclass(frozen=True)
class InputRange:
    """What bounds one entry of an input; ``free`` says that the task does."""

    low: Fraction
    high: Fraction
    free: bool


def input_ranges(
    word: tuple[str, ...], arm: SimulatedArm, figures: Figures, family: Family
) -> list[InputRange]:
    """Per joint, in the order of the word."""
    found = []
    for joint in arm.joints:
        declared = family.inputs.get(word[joint.symbol])
        unit = "N*m" if joint.kind == "hinge" else "N"
        if declared is None and unit not in figures.efforts:
            raise FalseClaim(f"no bound in {unit}")
        low, high = declared or (-figures.efforts[unit], figures.efforts[unit])
        found.append(InputRange(low, high, declared is None))
    return found


def peak_and_margin(
    rows: Sequence[Sequence[Fraction]], ranges: Sequence[InputRange]
) -> tuple[Fraction, Fraction]:
    """The largest free input, and the least distance of any input to its bounds."""
    pairs = [(u, r) for row in rows for u, r in zip(row, ranges, strict=True)]
    peak = max((abs(u) for u, r in pairs if r.free), default=Fraction(0))
    return peak, min(min(u - r.low, r.high - u) for u, r in pairs)


def _inputs(
    claim: Mapping[str, Any], figures: Figures, ranges: Sequence[InputRange]
) -> list[list[Fraction]]:
    rows = [[_exact(text) for text in row] for row in claim["inputs"]]
    if len(rows) != figures.steps or any(len(row) != len(ranges) for row in rows):
        raise FalseClaim("inputs of another shape")
    peak, margin = peak_and_margin(rows, ranges)
    if margin < 0:
        raise FalseClaim("an input out of bounds")
    if _exact(claim["effort_peak"]) != peak or _exact(claim["robustness"]) != margin:
        raise FalseClaim("another peak or robustness")
    return rows


def _start(claim: Mapping[str, Any], arm: SimulatedArm, figures: Figures) -> Array:
    exact = [_exact(text) for text in claim["start"]]
    n = len(arm.joints)
    if len(exact) != 2 * n:
        raise FalseClaim("a start of another length")
    if any(exact[n:]):
        raise FalseClaim("a start in motion")
    return np.array([float(value) for value in exact])


def _effector(claim: Mapping[str, Any], made: HandArm, figures: Figures) -> int:
    number = int(claim["effector"])
    if not 0 <= number < len(made.effectors):
        raise FalseClaim("no such effector")
    named = {figures.start_by, figures.reach_by} - {None}
    if max((by for by in named if by is not None), default=0) > len(made.effectors):
        raise FalseClaim("an effector of the task is missing")
    # With two different names either is recorded, the one that reaches at least.
    wanted = figures.reach_by or figures.start_by
    if wanted is not None and wanted != number + 1:
        raise FalseClaim("another effector than the task names")
    return number


# --- what is sampled -----------------------------------------------------------------------------


def _least(name: str, values: Array, fine: int) -> tuple[float, str]:
    """The least of samples of a distance, less what may hide between two of them.

    That is told by how the distance bends upwards at the four samples around: below the line from
    one sample to the next it is only then.  Where the inputs change, every ``fine`` samples, there
    is a sample, and a kink hides nothing.
    """
    lowest = float(values.min())
    if lowest < -CLEAR:
        return lowest, name
    bends = np.zeros(len(values) + 2)
    bends[2:-2] = np.maximum(0.0, np.diff(values, 2))
    bends[1 + fine : -2 : fine] = 0
    around = np.max([bends[i : i + len(values) - 1] for i in range(4)], axis=0)
    shown = float(np.min(np.minimum(values[:-1], values[1:]) - around / 4))
    return (shown if shown > CLEAR else 0.0), name


def along(
    motion: SampledMotion, arm: SimulatedArm, figures: Figures
) -> Iterator[tuple[float, str]]:
    """The distances to what must hold at every instant."""
    n = len(arm.joints)
    for i, joint in enumerate(arm.joints):
        for limits, entry in ((joint.range, i), (joint.rate, n + i)):
            values = motion.states[:, entry]
            if limits is not None:
                yield _least("a limit of a joint", values - limits[0], motion.fine)
                yield _least("a limit of a joint", limits[1] - values, motion.fine)
    for e in range(motion.tips.shape[1]):
        for row, offset in zip(figures.bounds.normals, figures.bounds.offsets, strict=True):
            room = offset - motion.tips[:, e, : len(row)] @ row
            yield _least("bounds", room, motion.fine)
    for name, subject, margin in figures.avoids:
        ends = motion.bodies
        if subject == "effector":
            ends = np.stack([motion.tips, motion.tips], axis=2)
        for item in range(ends.shape[1]):
            away = figures.areas[name].distance(ends[:, item]) - margin
            yield _least(f"avoid {name}", away, motion.fine)


def at_ends(
    motion: SampledMotion, arm: SimulatedArm, figures: Figures, effector: int
) -> Iterator[tuple[float, str]]:
    """The distances to what must hold at the start and at the end."""
    first = effector if figures.start_by is None else figures.start_by - 1
    yield float(figures.areas[figures.start].slack(motion.tips[0, first])), "start"
    if figures.reach is not None:
        yield float(figures.areas[figures.reach].slack(motion.tips[-1, effector])), "target"
    if figures.rest:
        n = len(arm.joints)
        yield float((REST - np.abs(motion.states[-1, n : 2 * n])).min()), "rest"


def _formulas(text: str, motion: SampledMotion, figures: Figures) -> Iterator[tuple[float, str]]:
    """The three formulas of the patrol, by their definitions; no other spec here has any."""
    if "satisfy" not in text:
        return
    inside = {name: figures.areas[name].slack(motion.tips[:, 0]) for name in ("A", "B")}
    per_second = motion.fine / motion.dt
    within, after = (
        re.search(p, text) for p in (r"eventually\[0 s, (\d+) s\]", r"last\[(\d+) s\]")
    )
    assert within
    assert after
    later = np.maximum.accumulate(inside["B"][::-1])[::-1]
    early = round(int(within[1]) * per_second) + 1
    yield float(np.minimum(inside["A"], later)[:early].max()), "A and then B"
    away = figures.areas["C"].distance(np.stack([motion.tips[:, 0]] * 2, axis=1))
    yield _least("always not C", away, motion.fine)
    last = inside["B"][-round(int(after[1]) * per_second) - 1 :]
    yield _least("last B", last, motion.fine)


def _path(
    path: Sequence[Sequence[str]], motion: SampledMotion, original: Original
) -> Iterator[tuple[float, str]]:
    """Every effector is in its cell at every step."""
    points = motion.at_steps
    if len(path) != points.shape[1] or any(len(names) != len(points) for names in path):
        raise FalseClaim("a path of another shape")
    dimension = 3 if any("z" in row for rows in original.cells.values() for row in rows) else 2
    cells = dict[str, Area]()
    for effector, names in enumerate(path):
        for sample, name in enumerate(names):
            if name not in original.cells:
                raise FalseClaim("no such cell")
            if name not in cells:
                cells[name] = cell_of(original.cells[name], dimension)
            yield float(cells[name].slack(points[sample, effector])), f"cell {name}"
