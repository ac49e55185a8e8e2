"""Adapters to convex solvers, and what is done when one of them fails."""

from __future__ import annotations

import sys
from collections.abc import Callable
from concurrent.futures import Future
from dataclasses import dataclass, field, replace
from subprocess import run
from types import SimpleNamespace

import clarabel
import cvxpy as cp
import numpy as np
import piqp
import pytest
from scipy.optimize import linprog
from scipy.sparse import csc_matrix

from solvers.backends import portfolio
from solvers.backends.clarabel import Clarabel
from solvers.backends.conic import Cones, ConvexProgram, NotSolved, Optimum, Status
from solvers.backends.cvxpy_solvers import SolverNameError, solved, solver_called
from solvers.backends.piqp import ProximalInteriorPoint
from solvers.backends.portfolio import FINAL, WIDER, SolverPortfolio, UsualSolver
from solvers.execution import process_pool
from tests.conftest import ROOT

ALL = (ProximalInteriorPoint(), Clarabel(), Clarabel(scaled=False), SolverPortfolio())


def program(seed: int = 0, structure: object = None) -> ConvexProgram:
    """Linear, so that HiGHS solves it, too: feasible at a random point, unknowns in boxes."""
    rng = np.random.default_rng(seed)
    at = rng.uniform(-1, 1, 6)
    equal, less = rng.normal(size=(2, 6)), rng.normal(size=(4, 6))
    return ConvexProgram(
        np.zeros(6), rng.normal(size=6), csc_matrix(equal), equal @ at, csc_matrix(less),
        less @ at + rng.uniform(0, 0.5, 4), at - 1, at + rng.uniform(0.5, 2, 6), None, structure,
    )  # fmt: skip


@pytest.mark.parametrize("number", range(len(ALL)))
def test_linear_programs_one_after_the_other(number: int) -> None:
    """Of one structure, with other numbers each time; against HiGHS."""
    structure = object()
    for seed in range(5):
        asked = program(seed, structure)
        answer = ALL[number].solve(asked, 1e-9)
        assert isinstance(answer, Optimum)
        wanted = linprog(
            asked.linear, asked.less.toarray(), asked.less_right, asked.equal.toarray(),
            asked.equal_right, np.stack([asked.lower, asked.upper], axis=1),
        )  # fmt: skip
        assert answer.value == pytest.approx(wanted.fun, abs=1e-6)
        assert asked.violation(answer.point) < 1e-7


@pytest.mark.parametrize("number", range(len(ALL)))
def test_contradictions_and_descents_without_end(number: int) -> None:
    asked = program()
    nowhere = replace(asked, less_right=np.full(4, -100.0))
    answer = ALL[number].solve(nowhere, 1e-8)
    assert isinstance(answer, NotSolved)
    assert answer.status is Status.INFEASIBLE
    endless = replace(
        asked, less=csc_matrix((0, 6)), less_right=np.zeros(0),
        lower=np.full(6, -np.inf), upper=np.full(6, np.inf),
    )  # fmt: skip
    answer = ALL[number].solve(endless, 1e-8)
    assert isinstance(answer, NotSolved)
    assert answer.status is Status.UNBOUNDED


def test_a_kept_structure_survives_a_failure() -> None:
    structure = object()
    solver, asked = ProximalInteriorPoint(), program(1, structure)
    first = solver.solve(asked, 1e-9)
    infeasible = replace(asked, less_right=np.full(4, -100.0))
    assert isinstance(solver.solve(infeasible, 1e-9), NotSolved)
    broken = replace(asked, linear=np.full(6, np.nan))
    answer = solver.solve(broken, 1e-9)
    assert isinstance(answer, NotSolved) or asked.violation(answer.point) == np.inf
    again = solver.solve(asked, 1e-9)
    assert isinstance(first, Optimum)
    assert isinstance(again, Optimum)
    np.testing.assert_allclose(again.point, first.point, atol=1e-6)


def test_cones_are_for_clarabel() -> None:
    """The least x + 2y in a disc of radius 3 is -3 sqrt(5)."""
    cone = Cones(csc_matrix(-np.eye(3)[:, 1:]), np.array([3.0, 0.0, 0.0]), (3,))
    none = csc_matrix((0, 2)), np.zeros(0)
    free = np.full(2, np.inf)
    asked = ConvexProgram(np.zeros(2), np.array([1.0, 2.0]), *none, *none, -free, free, cone)
    answer = SolverPortfolio().solve(asked, 1e-9)
    assert isinstance(answer, Optimum)
    assert answer.value == pytest.approx(-3 * np.sqrt(5), abs=1e-6)
    assert isinstance(ProximalInteriorPoint().solve(asked, 1e-9), NotSolved)
    assert asked.violation(np.array([3.0, 3.0])) > 0.1


@pytest.mark.parametrize(
    "point",
    [np.full(6, np.nan), np.full(6, np.inf), np.full(6, 1e300), np.zeros(5), np.zeros((6, 1))],
)
def test_what_is_no_point_breaks_a_program_infinitely(point: np.ndarray) -> None:
    alternating = point * np.where(np.arange(point.size) % 2, 1, -1).reshape(point.shape)
    for each in (point, alternating):
        assert not program().violation(each) < 1e-3


# --- statuses by name ----------------------------------------------------------------------------

CLARABEL = {
    "AlmostSolved": Status.INACCURATE,
    "MaxIterations": Status.ITERATION_LIMIT,
    "MaxTime": Status.TIME_LIMIT,
    "NumericalError": Status.NUMERICS,
    "InsufficientProgress": Status.NUMERICS,
    "PrimalInfeasible": Status.INFEASIBLE,
    "DualInfeasible": Status.UNBOUNDED,
    "AlmostPrimalInfeasible": Status.NUMERICS,
    "AlmostDualInfeasible": Status.NUMERICS,
    "Unsolved": Status.FAILED,
    "of a later version": Status.FAILED,
}


@pytest.mark.parametrize("name", sorted(CLARABEL))
def test_clarabel_by_name(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """The point is perfect; the name says that it is none."""
    honest = Clarabel().solve(program(), 1e-8)
    assert isinstance(honest, Optimum)
    solution = SimpleNamespace(x=honest.point, obj_val=honest.value, status=name)
    stub = SimpleNamespace(solve=lambda: solution)
    monkeypatch.setattr(clarabel, "DefaultSolver", lambda *_arguments: stub)
    assert Clarabel().solve(program(), 1e-8) == NotSolved(CLARABEL[name], name)


@pytest.mark.parametrize("name", sorted(set(piqp.Status.__members__) - {"PIQP_SOLVED"}))
def test_piqp_by_name(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    class Stub:
        settings = SimpleNamespace()

        def setup(self, **_program):
            pass

        def solve(self):
            return piqp.Status.__members__[name]

    monkeypatch.setattr(piqp, "SparseSolver", Stub)
    answer = ProximalInteriorPoint().solve(program(), 1e-8)
    assert isinstance(answer, NotSolved)
    assert answer.detail == name
    told = {"INFEASIBLE": (Status.INFEASIBLE, Status.UNBOUNDED)}
    assert (answer.status in FINAL) == (name.rsplit("_", maxsplit=1)[-1] in told)


@pytest.mark.parametrize(
    ("name", "status"),
    [
        ("infeasible", Status.INFEASIBLE),
        ("unbounded", Status.UNBOUNDED),
        ("optimal_inaccurate", Status.INACCURATE),
        ("infeasible_inaccurate", Status.NUMERICS),
        ("user_limit", Status.ITERATION_LIMIT),
        ("solver_error", Status.NUMERICS),
        ("something else", Status.FAILED),
    ],
)
def test_cvxpy_by_name(name: str, status: Status, monkeypatch: pytest.MonkeyPatch) -> None:
    x = cp.Variable(value=1.0)
    problem = cp.Problem(cp.Minimize(x), [x >= 1])
    monkeypatch.setattr(cp.Problem, "solve", lambda *_a, **_k: None)
    monkeypatch.setattr(cp.Problem, "status", name)
    assert solved(problem, "CLARABEL", 1e-8) == NotSolved(status, name)


@pytest.mark.parametrize("value", [np.nan, np.inf, 0.5])
def test_an_optimum_of_cvxpy_that_is_none(value: float, monkeypatch: pytest.MonkeyPatch) -> None:
    x = cp.Variable()
    problem = cp.Problem(cp.Minimize(x), [x >= 1])
    assert solved(problem, "CLARABEL", 1e-8) is None
    monkeypatch.setattr(cp.Problem, "solve", lambda *_a, **_k: x.save_value(np.array(value)))
    assert solved(problem, "CLARABEL", 1e-8) == NotSolved(Status.NOT_CREDIBLE)


def test_solvers_by_their_names() -> None:
    assert solver_called("clarabel") == solver_called("CLARABEL") == "CLARABEL"
    with pytest.raises(SolverNameError, match=r"no solver `simplex` here; there are: own, .*SCS"):
        solver_called("simplex")
    with pytest.raises(SolverNameError, match="does not solve a small quadratic program"):
        solver_called("scipy")


# --- the policy ----------------------------------------------------------------------------------


@dataclass
class Scripted:
    """Gives prepared answers; notes what it was asked with."""

    answers: list[object]
    asked: list[float] = field(default_factory=list)

    def solve(self, _program: ConvexProgram, tolerance: float) -> Optimum | NotSolved:
        self.asked.append(tolerance)
        answer = self.answers.pop(0)
        if isinstance(answer, BaseException):
            raise answer
        return answer


GOOD = Clarabel().solve(program(), 1e-9)
OWN_FAILURES = [status for status in Status if status not in FINAL]


@pytest.mark.parametrize("status", OWN_FAILURES)
def test_after_a_failure_of_its_own_another_solver_is_asked(status: Status) -> None:
    first, second, third = Scripted([NotSolved(status)]), Scripted([GOOD]), Scripted([])
    assert SolverPortfolio((first, second, third)).solve(program(), 1e-8) is GOOD
    assert (first.asked, second.asked, third.asked) == ([1e-8], [1e-8], [])


@pytest.mark.parametrize("status", sorted(FINAL, key=lambda status: status.value))
def test_what_holds_for_every_solver_is_asked_once(status: Status) -> None:
    first, second = Scripted([NotSolved(status)]), Scripted([])
    assert SolverPortfolio((first, second)).solve(program(), 1e-8) == NotSolved(status)
    assert second.asked == []


def test_a_wider_tolerance_comes_last() -> None:
    failures = [NotSolved(Status.NUMERICS), RuntimeError("panic"), Optimum(np.zeros(6) + 9, 0.0)]
    stubs = [Scripted([failure, GOOD]) for failure in failures]
    assert SolverPortfolio(stubs).solve(program(), 1e-8) is GOOD
    assert [stub.asked for stub in stubs] == [[1e-8, 1e-8 * WIDER], [1e-8], [1e-8]]


def test_what_none_solves_is_not_solved() -> None:
    stubs = [Scripted([NotSolved(Status.NUMERICS), NotSolved(Status.INACCURATE)]) for _ in "abc"]
    assert SolverPortfolio(stubs).solve(program(), 1e-8) == NotSolved(Status.INACCURATE)
    assert SolverPortfolio(()).solve(program(), 1e-8) == NotSolved(Status.FAILED, "no solver")


@pytest.mark.parametrize("stop", [KeyboardInterrupt(), SystemExit(3)])
def test_an_interrupt_is_none_of_its_business(stop: BaseException) -> None:
    with pytest.raises(type(stop)):
        SolverPortfolio((Scripted([stop]),)).solve(program(), 1e-8)


def test_another_process_gives_the_same_answers(monkeypatch: pytest.MonkeyPatch) -> None:
    """Bit by bit, also where solvers go on from what they know of a structure."""
    structures = object(), object()
    asked = [program(seed, structures[seed % 3 == 0]) for seed in range(8)]
    here = SolverPortfolio(), SolverPortfolio()
    apart = UsualSolver(), UsualSolver()
    expected, found = list[object](), list[object]()
    for number, each in enumerate(asked):
        expected.append(here[number % 2].solve(each, 1e-9))
        monkeypatch.setattr(portfolio, "LARGE", 6)
        found.append(apart[number % 2].solve(each, 1e-9))
        monkeypatch.undo()
    assert [_bits(answer) for answer in found] == [_bits(answer) for answer in expected]
    assert all(isinstance(answer, Optimum) for answer in found)


def test_the_other_process_ends_in_silence() -> None:
    """With portfolios that are there to the end."""
    text = (
        "from solvers.backends import portfolio\n"
        "from tests.solvers.test_convex_solvers import program\n"
        "portfolio.LARGE = 6\n"
        "solver = portfolio.UsualSolver()\n"
        "print(solver.solve(program(), 1e-8).value)\n"
    )
    ended = run([sys.executable, "-c", text], cwd=ROOT, capture_output=True, check=True)
    answer = SolverPortfolio().solve(program(), 1e-8)
    assert isinstance(answer, Optimum)
    assert float(ended.stdout) == answer.value
    assert ended.stderr == b""


def test_portfolios_that_are_gone_are_forgotten(monkeypatch: pytest.MonkeyPatch) -> None:
    """In this process instead of the other one, to look at what it keeps."""
    kept = dict[int, object]()
    monkeypatch.setattr(portfolio, "_KEPT", kept)
    monkeypatch.setattr(portfolio, "LARGE", 6)
    monkeypatch.setattr(process_pool, "ProcessPool", lambda _: InThisProcess())
    monkeypatch.setattr(portfolio, "_OTHER", portfolio._OtherProcess())
    for seed in range(3):
        assert isinstance(UsualSolver().solve(program(seed), 1e-8), Optimum)
        assert len(kept) == 1


class InThisProcess:
    """A pool that does its jobs at once."""

    width = 1

    def start(self, function: Callable[[object], object], job: object) -> Future[object]:
        done = Future[object]()
        done.set_result(function(job))
        return done

    def is_lost(self, _error: BaseException) -> bool:
        return False

    def is_alive(self) -> bool:
        return True

    def close(self) -> None:
        """Nothing is there to be ended."""


def _bits(answer: object) -> object:
    return answer.point.tobytes() if isinstance(answer, Optimum) else answer


def test_a_failure_in_one_line() -> None:
    assert NotSolved(Status.FAILED, "two\n  lines").text == "solver failed (two lines)"
    assert NotSolved(Status.NUMERICS).text == "numerical error"
    assert len(NotSolved(Status.FAILED, "x" * 10_000).text) < 300
