"""Claims about objectives altered in every way that is thought of: none is accepted but true ones.

A claim stays true where it says less: a smaller least, fewer modules.  What is only written in
another way may be accepted or not.
"""

from __future__ import annotations

import copy
import json
import shutil
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest

from solvers.verifier.report import Report
from solvers.verifier.verification import Outcome, verify_directory
from srgc.cli import run
from tests.oracles.least_specs import link, spec
from tests.oracles.result_files import alter, read, write

Content = dict[str, Any]
Change = Callable[[Content], None]

ARMS = "matches Base eps Joint eps (A eps | B eps)+ Hand"
PRICES = {"A": "const price = 10;", "B": "const price = 3;"}
TWO = {"a": ("eps A", link("0.5 m", "1 kg")), "b": ("eps B", link("0.25 m", "0.3 kg"))}
THREE = {
    f"{name.lower()}{number}": (f"eps {name}", link(length, f"{mass} kg"))
    for name, length, masses in [
        ("A", "0.2 m", (1, 5)),
        ("B", "0.3 m", (2, 6)),
        ("C", "0.5 m", (10, 7)),
    ]
    for number, mass in enumerate(masses)
}
GROWING = {
    label: (
        f"eps {label.upper()}",
        f"this.size = Arm.size + 1; {link(length, 'Arm.size * 1 kg')}",
    )
    for label, length in [("a", "0.25 m"), ("b", "0.1 m")]
}


def _growing() -> str:
    """Links that weigh as much as there are links before them: all words are listed as dearer."""
    text = spec({"A": "", "B": ""}, GROWING, "modules <= 5; minimize mass;", accept=ARMS)
    text = text.replace("this.frame = world;", "this.frame = world; this.size = 1;")
    for place in ("rot(z, Joint.q);", "hand { this.frame = Arm.frame;"):
        text = text.replace(place, f"{place} this.size = Arm.size;")
    return text


WITHIN = "modules <= 5; minimize sum(price) within 100 % then modules;"
SPECS: dict[str, tuple[str, ...]] = {
    "lemmas": (spec(PRICES, TWO, "modules <= 5; minimize sum(price);", accept=ARMS),),
    "alone": (
        spec(PRICES, TWO, "modules <= 5; minimize sum(price) then mass;", accept=ARMS),
        "--no-lemmas",
    ),
    "within": (
        spec(PRICES, TWO, WITHIN, accept=ARMS),
    ),
    "endless": (spec(PRICES, TWO, "minimize sum(price) then modules;", accept=ARMS),),
    "endless alone": (
        spec(PRICES, TWO, "minimize sum(price) then modules;", accept=ARMS), "--no-lemmas",
    ),
    "ambiguous": (
        spec(
            {"A": "", "B": "", "C": ""}, THREE, "modules <= 4; minimize modules then mass;",
            accept="matches Base eps Joint eps (A | B | C) eps Hand",
        ),
        "--no-lemmas",
    ),
    "growing": (_growing(),),
}  # fmt: skip
LEAST = {
    "lemmas": ("6",),
    "alone": ("6", "3/5"),
    "within": ("6", "4"),
    "endless": ("6", "5"),
    "endless alone": ("6", "5"),
    "ambiguous": ("4", "7"),
    "growing": ("3",),
}
"""The least of each objective, by hand."""


@pytest.fixture(scope="module")
def folders(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    """Results by the name of their spec, each made once."""
    base = tmp_path_factory.mktemp("objectives")
    known: dict[str, Path] = {}

    def get(name: str) -> Path:
        if name not in known:
            text, *options = SPECS[name]
            known[name] = base / name
            path = base / f"{name.replace(' ', '_')}.srg"
            path.write_text(text, encoding="utf-8")
            asked = ["synth", str(path), "-o", str(known[name]), "-q", "--paths", "2"]
            assert run([*asked, "--evaluations", "3", *options]) == 0
        return known[name]

    return get


def claim_of(content: Content) -> Content:
    (found,) = (c for c in content["claims"] if c["kind"] == "objectives")
    return found


@dataclass(frozen=True)
class Altered:
    """A change of a claim; ``accepted``: whether it has to be, None where both are right."""

    name: str
    change: Change
    accepted: bool | None = False


def judged(folder: Path, target: Path, change: Change, *, stated: bool = False) -> Report:
    """The report on an altered certificate, without or with what ``design.json`` has ``stated``."""
    shutil.copytree(folder, target)
    if not stated:
        (target / "design.json").unlink()
    alter(target, change, sign=True)
    report = verify_directory(target)
    shutil.rmtree(target)
    return report


def check(folder: Path, target: Path, altered: Altered) -> None:
    report = judged(folder, target, altered.change)
    if altered.accepted is None:
        assert report.outcome in (Outcome.VALID, Outcome.REFUTED), altered.name
    else:
        assert (report.outcome is Outcome.VALID) is altered.accepted, (altered.name, report.reason)


def on_claim(change: Change) -> Change:
    return lambda content: change(claim_of(content))


def at(*path: str | int, to: object) -> Change:
    """What stands at a place of the claim is something else."""

    def change(content: Content) -> None:
        place: Any = claim_of(content)
        for key in path[:-1]:
            place = place[key]
        place[path[-1]] = copy.deepcopy(to)

    return change


# --- values ---------------------------------------------------------------------------------------


def of_values(claim: Content, least: tuple[str, ...]) -> Iterator[Altered]:
    for k, (each, true) in enumerate(zip(claim["values"], least, strict=True)):
        value, most = Fraction(each["value"]), Fraction(true)
        for other in (
            value + Fraction(1, 10**12), value - Fraction(1, 10**12), value + 1, value * 2,
            value / 2, -value, Fraction(0),
        ):  # fmt: skip
            yield Altered(f"value {k} is {other}", at("values", k, "value", to=str(other)))
        for text in ("", "six", "1e400000", "nan", "6/0"):
            yield Altered(f"value {k} is `{text}`", at("values", k, "value", to=text))
            yield Altered(f"least {k} is `{text}`", at("values", k, "least", to=text))
        yield Altered(f"value {k} is a number", at("values", k, "value", to=float(value)))
        above = (most + Fraction(1, 10**12), most + Fraction(1, 2), most + 1, most * 2)
        for other in {*above, value, value + 1}:
            if other > most:
                yield Altered(f"least {k} is {other}", at("values", k, "least", to=str(other)))
        for other in (Fraction(0), most / 2, most - Fraction(1, 10**12), Fraction(-1)):
            # Some of the structures that are listed are not due any more.
            accepted = None if claim["structures"] or claim["dearer"] else True
            yield Altered(
                f"least {k} is {other}", at("values", k, "least", to=str(other)), accepted
            )


def of_objectives(claim: Content) -> Iterator[Altered]:
    values = claim["values"]
    for k, each in enumerate(values):
        others = ("sum(weight)", "mass", "modules", "effort", "sum(price) within 5 %", "")
        for name in others:
            if name != each["objective"]:
                yield Altered(f"{k} is {name}", at("values", k, "objective", to=name))
        yield Altered(f"without {k}", at("values", to=[*values[:k], *values[k + 1 :]]))
        yield Altered(f"{k} twice", at("values", to=[*values, each]))
        yield Altered(f"{k} with more", at("values", k, to={**each, "most": "9"}))
    if len(values) > 1:
        yield Altered("reversed", at("values", to=values[::-1]))


# --- evidence -------------------------------------------------------------------------------------


def of_structures(claim: Content) -> Iterator[Altered]:
    structures = claim["structures"]
    alone = [s["boxes"] for s in structures]
    for k, each in enumerate(structures):
        rest = [*structures[:k], *structures[k + 1 :]]
        yield Altered(f"structure {k} left out", at("structures", to=rest))
        yield Altered(f"structure {k} twice", at("structures", to=[*structures, each]))
        without = {**each, "boxes": None, "evidence": None}
        yield Altered(f"structure {k} without boxes", at("structures", k, to=without))
        for boxes in ("proofs/least/9999.boxes", "../certificate.json", "/etc/passwd", ""):
            yield Altered(f"{k} by {boxes}", at("structures", k, "boxes", to=boxes))
        for boxes in alone:
            if boxes != each["boxes"]:  # may refute this one just as well
                yield Altered(f"{k} by {boxes}", at("structures", k, "boxes", to=boxes), None)
        yield Altered(f"{k} like itself", at("structures", k, "same_robot_as", to=k))
        yield Altered(f"{k} like a later one", at("structures", k, "same_robot_as", to=k + 1))
        if k:
            yield Altered(f"{k} like the first", at("structures", k, "same_robot_as", to=0))
        shorter = each["derivation"][:-1]
        yield Altered(f"{k} of less", at("structures", k, "derivation", to=shorter))
        dearer = [*claim["dearer"], each["word"]]
        yield Altered(
            f"structure {k} is said to be dearer",
            on_claim(lambda c, rest=rest, dearer=dearer: c.update(structures=rest, dearer=dearer)),  # type: ignore[misc]
        )
    if structures:
        yield Altered("no structures", at("structures", to=[]))
    if len(structures) > 1:
        yield Altered("structures reversed", at("structures", to=structures[::-1]), None)


def of_dearer(claim: Content, word: list[str]) -> Iterator[Altered]:
    dearer = claim["dearer"]
    for k, each in enumerate(dearer):
        rest = [*dearer[:k], *dearer[k + 1 :]]
        yield Altered(f"dearer {k} left out", at("dearer", to=rest))
        yield Altered(f"dearer {k} shorter", at("dearer", k, to=each[:-1]))
    if dearer:
        yield Altered("no dearer words", at("dearer", to=[]))
        yield Altered("reversed", at("dearer", to=dearer[::-1]), accepted=True)
        yield Altered("twice", at("dearer", to=[*dearer, *dearer]), accepted=True)
    # Such words are not counted, or have no less.
    yield Altered("a word of no robot", at("dearer", to=[*dearer, ["Hand"]]), accepted=True)
    yield Altered("an unknown word", at("dearer", to=[*dearer, ["X"]]), accepted=True)
    yield Altered("the robot itself", at("dearer", to=[*dearer, word]), None)
    yield Altered("no word", at("dearer", to=[*dearer, [1]]))
    yield Altered("no list", at("dearer", to="all"))


def of_lemmas(claim: Content) -> Iterator[Altered]:
    lemmas = claim["lemmas"]
    for k, each in enumerate(lemmas):
        yield Altered(f"lemma {k} left out", at("lemmas", to=[*lemmas[:k], *lemmas[k + 1 :]]))
        yield Altered(f"lemma {k} twice", at("lemmas", to=[*lemmas, each]), accepted=True)
        head, _, count = each["condition"].rpartition(" ")
        for condition in (
            "length >= 1", f"{head} {int(count) + 1}", f"not ({each['condition']})", "",
            "count(A) <= 9", "ends with Hand",
        ):  # fmt: skip
            yield Altered(f"{k}: {condition}", at("lemmas", k, "condition", to=condition))
        narrow = f"{each['condition']} and length <= 3"
        yield Altered(f"{k}: {narrow}", at("lemmas", k, "condition", to=narrow))
        yield Altered(f"{k} at home", at("lemmas", k, "region", to="Home"))
        yield Altered(f"{k} about nothing", at("lemmas", k, "vector", to=["0", "0"]))
        yield Altered(f"{k} with less", at("lemmas", k, "bound", to="0.1"))
        yield Altered(f"{k} with more", at("lemmas", k, "bound", to="0.6"))


def of_modules(claim: Content) -> Iterator[Altered]:
    modules = claim["modules"]
    if modules is not None:
        for other in (modules - 1, modules + 1, 0, -1, None, str(modules), True, float(modules)):
            yield Altered(f"{other} modules", at("modules", to=other))
        return
    for other in ("5", True, 5.0):
        yield Altered(f"{other} modules", at("modules", to=other))


def of_fields(_: Content) -> Iterator[Altered]:
    for key in ("values", "modules", "structures", "dearer", "lemmas"):
        yield Altered(f"no {key}", on_claim(lambda c, key=key: c.pop(key)))  # type: ignore[misc]
        if key != "modules":
            yield Altered(f"{key} is null", at(key, to=None))
    yield Altered("more", at("because", to="it is so"))
    yield Altered("another kind", at("kind", to="objective"))
    yield Altered("twice", lambda c: c["claims"].append(claim_of(c)))


def alterations(name: str, folder: Path) -> list[Altered]:
    content = read(folder)
    claim = claim_of(content)
    return [
        *of_values(claim, LEAST[name]),
        *of_objectives(claim),
        *of_structures(claim),
        *of_dearer(claim, content["word"]),
        *of_lemmas(claim),
        *of_modules(claim),
        *of_fields(claim),
    ]


@pytest.mark.parametrize("name", SPECS)
def test_as_they_are(name: str, folders: Callable[[str], Path], tmp_path: Path) -> None:
    folder = folders(name)
    assert verify_directory(folder).outcome is Outcome.VALID
    assert judged(folder, tmp_path / "same", lambda _: None).outcome is Outcome.VALID
    values = claim_of(read(folder))["values"]
    assert [Fraction(v["least"]) for v in values] == [Fraction(each) for each in LEAST[name]]


@pytest.mark.parametrize("name", SPECS)
def test_some_altered_claims(name: str, folders: Callable[[str], Path], tmp_path: Path) -> None:
    for altered in alterations(name, folders(name))[:: len(SPECS) * 3]:
        check(folders(name), tmp_path / "altered", altered)


@pytest.mark.slow
@pytest.mark.parametrize("name", SPECS)
def test_all_altered_claims(
    name: str,
    folders: Callable[[str], Path],
    tmp_path: Path,
    record_property: Callable[[str, object], None],
) -> None:
    every = alterations(name, folders(name))
    record_property("alterations", len(every))
    for altered in every:
        check(folders(name), tmp_path / "altered", altered)


def test_fewer_modules_are_said_so(folders: Callable[[str], Path], tmp_path: Path) -> None:
    """A claim about robots of few modules is true, and does not read as one about all."""
    folder = folders("endless")
    report = judged(folder, tmp_path / "few", at("modules", to=4))
    assert report.outcome is Outcome.VALID
    said = [each.name for each in report.conditions[-2:]]
    assert said == [
        "price 6: no robot with up to 4 modules has less",
        "modules 5: no robot with price up to 6 and up to 4 modules has less",
    ]


@pytest.mark.parametrize("name", SPECS)
def test_what_design_says(name: str, folders: Callable[[str], Path], tmp_path: Path) -> None:
    folder = folders(name)

    def drop(content: Content) -> None:
        content["claims"] = [c for c in content["claims"] if c["kind"] != "objectives"]
        if not content["claims"]:
            del content["claims"]
            content["format"] = 3

    assert judged(folder, tmp_path / "a", drop).outcome is Outcome.VALID
    assert judged(folder, tmp_path / "b", drop, stated=True).outcome is Outcome.REFUTED
    design = read(folder, "design.json")
    altered: list[Content] = []
    for k, each in enumerate(design["objectives"]):
        for key, value in (
            ("value", each["value"] + 1e-6), ("value", 0.0), ("value", str(each["value"])),
            ("least", each["least"] + 1), ("least", None), ("objective", "modules then mass"),
            ("unit", "m"), ("gap", 0),
        ):  # fmt: skip
            other = copy.deepcopy(design)
            other["objectives"][k][key] = value
            altered.append(other)
        altered.append({**design, "objectives": design["objectives"][:k]})
    altered += [
        {**design, "objectives": None},
        {k: v for k, v in design.items() if k != "objectives"},
    ]
    shutil.copytree(folder, tmp_path / "c")
    for content in altered:
        write(tmp_path / "c", content, "design.json")
        outcome = verify_directory(tmp_path / "c").outcome
        assert outcome is Outcome.REFUTED, json.dumps(content.get("objectives"))
