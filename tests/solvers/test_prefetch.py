"""Screenings ahead of need: of the right robots, in order, and never with one worker."""

from __future__ import annotations

import json

import pytest

from compiler.robots.candidate import candidates
from compiler.robots.normal_form import family_of
from compiler.robots.robot_key import robot_key
from grammar_lang.load import load
from solvers.execution.process_pool import ProcessPool
from solvers.run_context import Memory, RunContext
from solvers.search import prefetch
from solvers.search.prefetch import Prefetch, screening_of
from tests.oracles.small_specs import BEYOND_REACH

MODULES = 5


class Recording:
    """Does jobs here, but draws so many of them ahead; what is begun is noted."""

    def __init__(self, width):
        self.width, self.begun = width, []

    def map(self, function, jobs):
        remaining, results = iter(jobs), []
        while True:
            for job in remaining:
                self.begun.append(job.number)
                results.append(function(job))
                if len(results) >= self.width:
                    break
            if not results:
                return
            yield results.pop(0)

    def close(self):
        """Nothing."""


@pytest.fixture(scope="module")
def question(tmp_path_factory):
    path = tmp_path_factory.mktemp("spec") / "spec.srg"
    path.write_text(BEYOND_REACH, encoding="utf-8")
    program = load(path).program
    (task,) = program.tasks.values()
    return program, task


def drawn(question):
    return candidates(family_of(*question), MODULES, None)


def all_examined(question, context, given=None):
    """By number, the screening of every robot that was not seen before."""
    seen, found = set(), {}
    ahead = Prefetch(given or drawn(question), *question, context)
    numbers = []
    for candidate in ahead:
        numbers.append(candidate.number)
        if candidate.model is None or robot_key(candidate.model) in seen:
            continue
        seen.add(robot_key(candidate.model))
        found[candidate.number] = ahead.screening(candidate)
    assert numbers == list(range(len(numbers)))
    return found


@pytest.fixture(scope="module")
def here(question):
    return all_examined(question, RunContext())


def test_the_same_examinations_whoever_makes_them(question, here):
    assert len(here) > 4
    assert {one.refutation.refuted for one in here.values()} >= {True}
    workers = Recording(3)
    assert all_examined(question, RunContext(workers=workers)) == here
    assert workers.begun == list(here)
    pool = ProcessPool(2, patience=0.0)
    try:
        assert all_examined(question, RunContext(workers=pool)) == here
    finally:
        pool.close()


def test_workers_are_ahead_by_their_width_and_no_more(question):
    for width in (1, 2):
        workers = Recording(width)
        ahead = Prefetch(drawn(question), *question, RunContext(workers=workers))
        first = next(candidate for candidate in ahead if candidate.model is not None)
        assert workers.begun == []
        ahead.screening(first)
        assert workers.begun[0] == first.number
        assert len(workers.begun) == width


def test_nothing_is_drawn_before_it_is_needed_where_there_is_one_process(question):
    given = []

    def noted():
        for candidate in drawn(question):
            given.append(candidate.number)
            yield candidate

    ahead = Prefetch(noted(), *question, RunContext())
    for count, candidate in enumerate(ahead, 1):
        if candidate.model is not None and count < 4:
            ahead.screening(candidate)
        assert len(given) == count


def test_an_examination_that_nobody_asks_for_is_left_out(question, here):
    ahead = Prefetch(drawn(question), *question, RunContext(workers=Recording(3)))
    asked = list(here)[::2]
    found = {c.number: ahead.screening(c) for c in ahead if c.number in asked}
    assert found == {number: here[number] for number in asked}


def test_a_fault_of_a_later_structure_is_raised_in_its_turn(question):
    class Fault(Exception):
        pass

    def faulty():
        for candidate in drawn(question):
            if candidate.number == 3:
                raise Fault
            yield candidate

    given = []

    def screened():
        ahead = Prefetch(faulty(), *question, RunContext(workers=Recording(8)))
        for candidate in ahead:
            given.append(candidate.number)
            if candidate.model is not None:
                ahead.screening(candidate)

    with pytest.raises(Fault):
        screened()
    assert given == [0, 1, 2]


def test_what_the_journal_has_is_not_examined_again(question, here, monkeypatch):
    journal = Memory()
    assert all_examined(question, RunContext(journal=journal)) == here
    # As a file would keep it.
    journal.values = json.loads(json.dumps(journal.values))
    monkeypatch.setattr(prefetch, "screen", None)
    workers = Recording(3)
    assert all_examined(question, RunContext(journal=journal, workers=workers)) == here
    assert workers.begun == []
    assert all_examined(question, RunContext(journal=journal)) == here


def test_what_is_no_record_of_an_examination():
    for wrong in (None, 1.0, [], [{}, None], [{"reason": "x"}, None], [[], None], {"a": 1}):
        assert screening_of(wrong) is None
