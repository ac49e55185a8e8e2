"""Lemmas altered in every way that is thought of: none is accepted that is not true."""

from __future__ import annotations

import random
import shutil
from collections.abc import Callable
from dataclasses import replace
from itertools import islice
from pathlib import Path
from typing import Any

import pytest

from compiler.words.language import language
from grammar_lang import ir
from grammar_lang.conditions import condition_of
from solvers.verifier.claims.spec_copy import read_copy
from solvers.verifier.verification import Outcome, verify_directory
from tests.oracles.result_files import alter, read

Content = dict[str, Any]


@pytest.fixture(scope="module")
def learnt(made: Callable[[str], Path]) -> Path:
    return made("learnt") / "out"


@pytest.fixture(scope="module")
def varied(made: Callable[[str], Path]) -> Path:
    return made("walled_arm") / "out"


def outcome(folder: Path, target: Path, change: Callable[[Content], None]) -> Outcome:
    shutil.copytree(folder, target)
    (target / "design.json").unlink()
    alter(target, change, sign=True)
    found = verify_directory(target)
    shutil.rmtree(target)
    return found.outcome


def test_as_they_are(learnt: Path, varied: Path, tmp_path: Path) -> None:
    for folder in (learnt, varied):
        report = verify_directory(folder)
        assert (report.outcome, report.level) == (Outcome.VALID, "validated")
        assert outcome(folder, tmp_path / "same", lambda _: None) is Outcome.VALID
        assert read(folder)["format"] == 4
    assert {c["argument"] for c in read(varied)["claims"]} >= {"variants"}
    assert {c["argument"] for c in read(learnt)["claims"]} == {"too far"}


def lemma(number: int, **changes: object) -> Callable[[Content], None]:
    return lambda content: content["claims"][number].update(changes)


def shifted(text: str, by: int) -> str:
    """A condition with its last count changed."""
    head, _, count = text.rpartition(" ")
    return f"{head} {int(count) + by}"


def test_counts_off_by_one(learnt: Path, tmp_path: Path) -> None:
    for number, claim in enumerate(read(learnt)["claims"]):
        wider = lemma(number, condition=shifted(claim["condition"], 1))
        assert outcome(learnt, tmp_path / "wider", wider) is Outcome.REFUTED
        # One too few is true, but then words are left over.
        narrower = lemma(number, condition=shifted(claim["condition"], -1))
        assert outcome(learnt, tmp_path / "narrower", narrower) is Outcome.REFUTED


NOT_TRUE: dict[str, Content] = {
    "every word": {"condition": "length >= 1"},
    "another module": {"condition": "count(JO) <= 0"},
    "no condition": {"condition": "count(X) <= 1"},
    "broken": {"condition": "count(L"},
    "a bound beyond": {"bound": "100"},
    "no number": {"bound": "far"},
    "another direction": {"vector": ["0", "-1"]},
    "the other way": {"vector": ["-1", "-1"]},
    "no direction": {"vector": ["0", "0"]},
    "three coordinates": {"vector": ["1", "0", "0"]},
    "another region": {"region": "O"},
    "no region": {"region": "nowhere"},
    "another argument": {"argument": "too near"},
    "an unknown argument": {"argument": "too late"},
    "a kind": {"kind": "lemmas"},
    "more": {"because": "I say so"},
}


@pytest.mark.parametrize("name", NOT_TRUE)
def test_what_is_not_true(learnt: Path, tmp_path: Path, name: str) -> None:
    change = lemma(0, **NOT_TRUE[name])
    found = outcome(learnt, tmp_path / "altered", change)
    assert found in (Outcome.REFUTED, Outcome.UNDECIDED)


def test_a_lemma_left_out(learnt: Path, tmp_path: Path) -> None:
    for number in range(len(read(learnt)["claims"])):

        def without(content: Content, number: int = number) -> None:
            del content["claims"][number]
            if not content["claims"]:
                del content["claims"]
                content["format"] = 3

        assert outcome(learnt, tmp_path / "left", without) is Outcome.REFUTED


def test_a_structure_left_out(varied: Path, tmp_path: Path) -> None:
    structures = read(varied)["structures"]
    last = [n for n, s in enumerate(structures) if s["same_robot_as"] is not None][-1]
    assert outcome(varied, tmp_path / "0", lambda c: c["structures"].pop(last)) is Outcome.REFUTED
    assert outcome(varied, tmp_path / "1", lambda c: c["structures"].clear()) is Outcome.REFUTED


def variant(content: Content) -> Content:
    return next(c for c in content["claims"] if c["argument"] == "variants")


def altered_variants(content: Content) -> list[Content]:
    """Changes of a lemma about variants, none of which leaves it true."""
    claim = variant(content)
    others = [c for c in content["claims"] if c["argument"] == "variants" and c is not claim]
    condition = claim["condition"]
    found: list[Content] = [
        {"condition": condition.replace("(eps JO)?", "(eps JO)*", 1)},
        {"condition": condition.replace("eps L", "eps L (eps KN)?", 1)},
        {"condition": "count(L) == 2"},
        {"evidence": None, "boxes": None},
        {"evidence": "proofs/9999.smt2", "boxes": None},
        {"evidence": "../spec/walled_arm.srg", "boxes": None},
        {"derivation": ["tool", "base"]},
        {"derivation": claim["derivation"][:-1]},
        {"word": claim["word"][:-1]},
        {"word": []},
    ]
    found += [{"evidence": o["evidence"], "boxes": o["boxes"]} for o in others[:3]]
    found += [{"derivation": o["derivation"], "word": o["word"]} for o in others[:3]]
    found += [{"condition": o["condition"]} for o in others[:3]]
    return found


def test_altered_variants(varied: Path, tmp_path: Path) -> None:
    for changes in altered_variants(read(varied)):
        if changes.get("condition") == variant(read(varied))["condition"]:
            continue

        def change(content: Content, changes: Content = changes) -> None:
            variant(content).update(changes)

        assert outcome(varied, tmp_path / "altered", change) is Outcome.REFUTED, changes


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(20))
def test_two_hundred_altered_lemmas(learnt: Path, varied: Path, tmp_path: Path, seed: int) -> None:
    """Numbers and conditions changed at random: what is accepted says no more than what is true."""
    choose = random.Random(seed)
    for number in range(10):
        folder = choose.choice([learnt, varied])
        before = read(folder)
        place = choose.randrange(len(before["claims"]))
        claim = before["claims"][place]
        key = choose.choice([k for k in claim if k != "kind"])

        def change(content: Content, place: int = place, key: str = key) -> None:
            value = content["claims"][place][key]
            content["claims"][place][key] = mutated(choose, value)

        if outcome(folder, tmp_path / str(number), change) is Outcome.VALID and key == "condition":
            text = alter(shutil.copytree(folder, tmp_path / "kept"), change, sign=True)
            altered = text["claims"][place]["condition"]
            shutil.rmtree(tmp_path / "kept")
            assert not beyond(folder, altered), altered


def beyond(folder: Path, altered: str) -> list[tuple[str, ...]]:
    """Words of the family that an altered condition is about and no condition before."""
    program = read_copy(folder / "spec", *(read(folder)[k] for k in ("spec", "spec_sha256")))[0]
    (grammar,) = program.grammars.values()
    symbols = program.terminals
    known = tuple(condition_of(c["condition"], symbols) for c in read(folder)["claims"])
    accept = ir.AllOf(
        (grammar.accept, condition_of(altered, symbols), ir.NotAccept(ir.AnyOf(known)))
    )
    narrowed = replace(grammar, accept=accept)
    return list(islice(language(narrowed, symbols, program.modules).words(max_modules=9), 1))


def mutated(choose: random.Random, value: object) -> object:
    match value:
        case str() if value:
            at = choose.randrange(len(value))
            return value[:at] + choose.choice("0123456789()LJ*?|") + value[at + 1 :]
        case list() if value:
            some = list(value)
            some.pop(choose.randrange(len(some)))
            return some
        case None:
            return "proofs/0000.smt2"
        case _:
            return "x"
