"""What the benchmarks measure is what they say."""

from __future__ import annotations

import random

import networkx as nx
import pytest

from benchmarks.language_grammars import CHAIN_ITEMS, Subject, accepted, is_chain, refused, subjects
from benchmarks.large_spec import FORMULA_EVERY, large_spec
from benchmarks.linearisations import disagreement, expansion, ours, pinocchio_loop, samples
from benchmarks.planning_worlds import grid, maze
from compiler.words.language import language
from grammar_lang.load import load_text
from srgc.session import check_loaded
from tests.oracles.brute_force_grammar import all_words, words_of
from tests.oracles.robots import rod_chain


@pytest.mark.parametrize("size", [1, 10_000, 40_000])
def test_large_specifications_are_sound_and_of_their_size(size: int) -> None:
    text = large_spec(size)
    assert size <= len(text) < size + 4_000
    checked = check_loaded(load_text(text, "large.srg"))
    assert checked.program is not None
    assert not checked.diagnostics
    cells = len(checked.program.tasks)
    assert len(checked.program.grammars) == len(checked.program.workspaces) == cells
    formulas = sum(len(task.satisfy) for task in checked.program.tasks.values())
    assert formulas == cells // FORMULA_EVERY


SUBJECTS = {subject.name: subject for subject in subjects()}


@pytest.mark.parametrize(("name", "length"), [(n, 4 if n == "chain" else 7) for n in SUBJECTS])
def test_the_oracle_of_a_benchmark_agrees_with_brute_force(name: str, length: int) -> None:
    subject = SUBJECTS[name]
    derived = words_of(subject.grammar, length)
    assert derived
    assert all(map(subject.oracle, derived))
    nearby = {(*word[:i], t, *word[i + 1 :]) for word in derived for i, t in _places(subject, word)}
    short = all_words(subject.terminals, 4)
    assert {w for w in [*nearby, *short] if subject.oracle(w)} <= derived


def _places(subject: Subject, word: tuple[str, ...]) -> list[tuple[int, str]]:
    return [(i, token) for i in range(len(word)) for token in subject.terminals]


def test_the_oracle_of_the_chain_agrees_with_a_scan_item_by_item() -> None:
    """Dense words, where it matters which items the letters are taken for."""
    rng = random.Random(7)
    verdicts = []
    for _ in range(400):
        kept = [item for item in CHAIN_ITEMS if rng.random() < 0.95]
        word = list("".join(kept))
        word[rng.randrange(len(word))] = rng.choice("abcd")
        ends = {0}
        for item in CHAIN_ITEMS:
            ends |= {end + len(item) for end in ends if word[end : end + len(item)] == list(item)}
        verdicts.append(len(word) in ends)
        assert is_chain(tuple(word)) is verdicts[-1]
    assert 40 < sum(verdicts) < 360


@pytest.mark.parametrize("length", [10, 50, 200, 1000])
@pytest.mark.parametrize("name", SUBJECTS)
def test_words_of_a_benchmark_are_distinct_and_of_their_length(name: str, length: int) -> None:
    subject = SUBJECTS[name]
    inside, outside = accepted(subject, length, 16), refused(subject, length, 16)
    assert len(set(inside)) == len(inside) == len(set(outside)) == len(outside) == 16
    assert {len(word) for word in inside} <= {length, length + 1}
    assert len({len(word) for word in inside}) == 1
    assert {len(inside[0]) - len(word) for word in outside} <= {0, 1}
    assert all(map(subject.oracle, inside))
    assert not any(map(subject.oracle, outside))
    assert (accepted(subject, length, 16), refused(subject, length, 16)) == (inside, outside)


@pytest.mark.parametrize("name", SUBJECTS)
def test_refused_words_of_a_benchmark_fail_early_late_and_at_the_end(name: str) -> None:
    """How far a prefix of an accepted word reaches, in tenths."""
    subject = SUBJECTS[name]
    inside, outside = accepted(subject, 200, 40), refused(subject, 200, 40)
    common = [max(_common(word, other) for other in inside) / len(word) for word in outside]
    assert min(common) < 0.2
    assert any(0.35 < part < 0.65 for part in common)
    assert max(common) > 0.98


def _common(word: tuple[str, ...], other: tuple[str, ...]) -> int:
    pairs = zip(word, other, strict=False)
    return next((i for i, (a, b) in enumerate(pairs) if a != b), len(word))


@pytest.mark.parametrize("length", [10, 50])
@pytest.mark.parametrize("name", SUBJECTS)
def test_ours_agrees_with_the_oracle_of_a_benchmark(name: str, length: int) -> None:
    subject = SUBJECTS[name]
    ours = language(subject.grammar, subject.terminals, subject.modules)
    words = [*accepted(subject, length, 60), *refused(subject, length, 60)]
    assert [w for w in words if ours.accepts(w) is not subject.oracle(w)] == []


@pytest.mark.parametrize("links", [1, 3])
def test_all_linearisations_of_a_benchmark_agree(links: int) -> None:
    model, at = rod_chain(links), samples(links, 4)
    us = ours(model, at).call()
    assert [part.shape for part in us] == [
        (4, 2 * links), (4, 2 * links, 2 * links), (4, 2 * links, links), (4, 2 * links, links),
    ]  # fmt: skip
    for theta in (False, True):
        for cse in (False, True):
            found = expansion(model, at, theta=theta, cse=cse).call()
            assert len(found) == 3 + theta
            assert disagreement(us, found) < 1e-11
    spoilt = (us[0], us[1] + 1e-6, *us[2:])
    assert disagreement(us, spoilt) > 1e-8


def test_pinocchio_linearises_the_same_arm() -> None:
    pin = pytest.importorskip("pinocchio")
    model, at = rod_chain(3), samples(3, 4)
    assert disagreement(ours(model, at).call(), pinocchio_loop(pin, at).call()) < 1e-11


def test_the_worlds_of_the_planning_benchmark_have_the_paths_they_say() -> None:
    for world in (grid(12, 15, 20), maze(8)):
        graph = nx.Graph((i, j) for i, near in enumerate(world.neighbours) for j in near)
        graph.remove_nodes_from(world.blocked)
        path = nx.shortest_path(graph, world.start, world.target)
        assert len(path) - 1 <= world.steps
        world.checked(path, len(path) - 1)
        for wrong in (path[:-1], path[1:], [path[0], *path[2:]]):
            with pytest.raises(SystemExit, match="no path"):
                world.checked(wrong, world.steps)
        with pytest.raises(SystemExit, match="no path"):
            world.checked(path, len(path) - 2)
    # A maze without cycles has one path.
    assert len(list(nx.all_simple_paths(graph, world.start, world.target))) == 1
