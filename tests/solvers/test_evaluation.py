"""Evaluations: the same bits whoever makes them, and none that the journal has."""

from __future__ import annotations

import json
from dataclasses import fields, replace

import numpy as np
import pytest

from solvers.execution.process_pool import ProcessPool
from solvers.execution.workers import InProcess
from solvers.parameters.parameter_search import parameter_space
from solvers.run_context import Memory
from solvers.search import evaluation
from solvers.search.evaluation import Evaluator, SolveRequest, outcome_of, record_of
from solvers.trajectory.path_following import PathProblem
from tests.oracles.planned_arm import THETAS, bits, evaluated, planned_arm


@pytest.fixture(scope="module")
def pool():
    workers = ProcessPool(2, patience=0.0)
    while not workers._is_ready(abs):
        pass
    yield workers
    workers.close()


def requests_of(outcome):
    """One with the parameters free, one with other entries, one released."""
    arm = planned_arm()
    start, entries = outcome.trajectory, arm.waypoints()[1]
    moved = (*entries[:1], entries[1] + 2, *entries[2:])
    box = parameter_space(arm.model).free_box(start.theta)
    return [
        SolveRequest(start, entries, box),
        SolveRequest(start, moved, radius=0.1),
        SolveRequest(start, released=True),
    ]


def test_the_same_bits_from_other_processes(pool):
    arm = planned_arm()
    here = [evaluated(*theta) for theta in THETAS]
    there = list(Evaluator(arm, pool).batch(THETAS))
    assert len({outcome.robustness for outcome in here}) == len(THETAS)
    assert [bits(outcome) for outcome in there] == [bits(outcome) for outcome in here]
    requests = requests_of(here[1])
    solved = [request.outcome(arm) for request in requests]
    assert len({outcome.robustness for outcome in solved}) == len(requests)
    found = Evaluator(arm, pool).solutions(requests)
    assert [bits(outcome) for outcome in found] == [bits(outcome) for outcome in solved]


def test_an_evaluation_is_the_best_over_all_seeds(pool):
    arm = planned_arm()
    for theta, outcomes in zip(THETAS, Evaluator(arm, pool).attempts(THETAS), strict=True):
        assert 1 < len(outcomes) <= len(arm.seeds(theta))
        assert evaluated(*theta).robustness == max(outcome.robustness for outcome in outcomes)


def counted(monkeypatch):
    solved = []
    outcome = SolveRequest.outcome

    def counting(request, path_problem):
        solved.append(request)
        return outcome(request, path_problem)

    monkeypatch.setattr(SolveRequest, "outcome", counting)
    return solved


class Text(Memory):
    """A journal that keeps what a file would: text."""

    def recall(self, key):
        return json.loads(self.values.get(key, "null"))

    def record(self, key, value):
        assert key not in self.values
        self.values[key] = json.dumps(value)


def test_what_is_recorded_is_not_done_again(monkeypatch):
    arm, journal = planned_arm(), Text()
    first = list(Evaluator(arm, InProcess(), journal, "a").batch(THETAS[:2]))
    assert [bits(outcome) for outcome in first] == [bits(evaluated(*t)) for t in THETAS[:2]]
    solved = counted(monkeypatch)
    again = list(Evaluator(arm, InProcess(), journal, "a").batch(THETAS[1::-1]))
    assert solved == []
    assert [bits(outcome) for outcome in again[::-1]] == [bits(outcome) for outcome in first]
    evaluator = Evaluator(arm, InProcess(), journal, "a")
    results = evaluator.batch([THETAS[0], THETAS[2], THETAS[1]])
    assert bits(next(results)) == bits(first[0])
    assert solved == []
    next(results)
    assert {request.start.theta.tobytes() for request in solved} == {THETAS[2].tobytes()}


def test_an_evaluation_is_recorded_as_soon_as_it_is_there():
    journal = Memory()
    results = Evaluator(planned_arm(), InProcess(), journal, "a").batch(THETAS)
    for count in (1, 2):
        next(results)
        assert len(journal.values) == count


def test_another_question_is_not_answered_from_the_journal(monkeypatch):
    arm, journal = planned_arm(), Text()
    (outcome,) = Evaluator(arm, InProcess(), journal, "a").batch(THETAS[:1])
    request = requests_of(outcome)[1]
    list(Evaluator(arm, InProcess(), journal, "a").solutions([request]))
    solved = []

    def seeds(path_problem, theta):
        solved.append(theta)
        return [outcome.trajectory]

    monkeypatch.setattr(PathProblem, "seeds", seeds)
    monkeypatch.setattr(SolveRequest, "outcome", lambda *_: solved.append(None) or outcome)
    others = [
        Evaluator(arm, InProcess(), journal, "b").batch(THETAS[:1]),
        Evaluator(arm, InProcess(), journal, "a").batch([np.nextafter(THETAS[0], 9)]),
        Evaluator(arm, InProcess(), journal, "a").batch(THETAS[:1], evaluation.SURVEY.__class__(
            *[getattr(evaluation.SURVEY, f.name) + 1 for f in fields(evaluation.SURVEY)])),
        Evaluator(replace(arm, margin=3e-3), InProcess(), journal, "a").batch(THETAS[:1]),
        Evaluator(replace(arm, substeps=4), InProcess(), journal, "a").batch(THETAS[:1]),
        Evaluator(replace(arm, insets=np.full((2, 2, 2), 0.1)), None, journal, "a").batch(
            THETAS[:1]
        ),
    ]  # fmt: skip
    for other in others:
        solved.clear()
        list(other)
        assert solved
    evaluator = Evaluator(arm, InProcess(), journal, "a")
    for changed in (
        replace(request, radius=0.2), replace(request, released=True),
        replace(request, box=(THETAS[0], THETAS[0])), replace(request, entries=None),
        replace(request, start=replace(request.start, u=request.start.u + 1e-15)),
    ):  # fmt: skip
        solved.clear()
        list(evaluator.solutions([changed]))
        assert solved == [None]
    solved.clear()
    list(evaluator.solutions([request]))
    assert solved == []


def test_a_record_has_every_bit_and_nothing_else_passes_for_one():
    outcome = evaluated(*THETAS[0])
    odd = replace(outcome, robustness=-0.1, fictitious=np.array([5e-324, -0.0, 1e308]))
    for one in (outcome, odd):
        text = json.dumps(record_of(one), allow_nan=False)
        assert bits(outcome_of(json.loads(text))) == bits(one)
    record = record_of(outcome)
    for wrong in (
        None, 1.5, [record], {}, {**record, "more": 1}, {**record, "trajectory": 1.0},
        {**record, "trajectory": {"trajectory": [1.0, 2.0, 3.0]}},
        {**record, "fictitious": {"float64": "AAAA", "shape": [7]}},
        {**record, "fictitious": {"float64": "?", "shape": [1]}},
    ):  # fmt: skip
        assert outcome_of(wrong) is None


class Here:
    """Does jobs here, as others would be asked to."""

    width = 2

    def map(self, function, jobs):
        return map(function, jobs)


@pytest.mark.parametrize("counts", [(2, 0, 0, 1), (0, 3, 0), (0,), (1, 2), (0, 0, 2)])
def test_parameters_without_seeds_have_no_outcomes(monkeypatch, counts):
    outcome = evaluated(*THETAS[0])
    thetas = [np.array([number, 1.0]) for number in range(len(counts))]

    def seeds(path_problem, theta):
        start = outcome.trajectory
        return [replace(start, theta=theta)] * counts[int(theta[0])]

    monkeypatch.setattr(evaluation, "_hopeful", seeds)

    def solved(request, _path_problem):
        return replace(outcome, trajectory=request.start)

    monkeypatch.setattr(SolveRequest, "outcome", solved)
    for workers in (InProcess(), Here()):
        found = list(Evaluator(planned_arm(), workers).attempts(thetas))
        assert [len(outcomes) for outcomes in found] == list(counts)
        for theta, outcomes in zip(thetas, found, strict=True):
            assert all((one.trajectory.theta == theta).all() for one in outcomes)
