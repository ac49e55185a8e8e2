import signal
import threading

import pytest

from compiler.encodings.reachability_smt import refutation_script
from solvers.backends.smt import solve_script
from solvers.verdict import Fails, Holds, Reason, Unknown
from tests.oracles.arms import planar_arm
from tests.oracles.questions import question

CIRCLE = """(set-logic QF_NRA)
(declare-fun x () Real)
(declare-fun y () Real)
(assert (= (+ (* x x) (* y y)) 1.0))
(assert (= (* x y) {}))
(check-sat)
"""
# Four links with the positions of the joints as unknowns: too hard for the budget given.
HARD = "(set-logic QF_NRA)\n" + "".join(
    f"(declare-fun l{j} () Real)(assert (and (<= 0.5 l{j}) (<= l{j} 1)))\n"
    + "".join(
        f"(declare-fun {p}x{j} () Real)(declare-fun {p}y{j} () Real)\n"
        f"(assert (= (+ (* {p}x{j} {p}x{j}) (* {p}y{j} {p}y{j})) (* l{j} l{j})))\n"
        for p in "st"
    )
    for j in range(4)
) + """(assert (<= 0.8 (+ sx0 sx1 sx2 sx3) 1.2))
(assert (<= 1.0 (+ sy0 sy1 sy2 sy3) 1.4))
(assert (<= 3.5 (+ tx0 tx1 tx2 tx3) 4.2))
(assert (<= 3.8 (+ ty0 ty1 ty2 ty3) 4.5))
(check-sat)
"""  # fmt: skip


def test_three_answers():
    assert solve_script(CIRCLE.format("(/ 1 2)")) == Holds(None)
    assert solve_script(CIRCLE.format("(/ 51 100)")) == Fails(None)
    answer = solve_script(HARD, resources=50_000)
    assert isinstance(answer, Unknown)
    assert answer.reason is Reason.RESOURCE_LIMIT


def test_answers_repeat():
    script = refutation_script(planar_arm(3), question())
    assert {str(solve_script(script)) for _ in range(3)} == {str(Holds(None))}
    assert solve_script(HARD, resources=50_000) == solve_script(HARD, resources=50_000)


@pytest.mark.parametrize("text", ["(assert", "(assert (= x 1.0))"])
def test_what_is_no_script_is_an_error(text):
    with pytest.raises(ValueError, match="not an SMT-LIB 2 script"):
        solve_script(text)


def test_an_interruption_is_no_answer():
    """z3 takes the signal for itself, and answers "unknown"."""
    timer = threading.Timer(0.5, signal.raise_signal, [signal.SIGINT])
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        solve_script(HARD, resources=50_000_000)
    timer.join()


def test_a_budget_is_positive():
    with pytest.raises(ValueError, match="budget"):
        solve_script(CIRCLE.format(1), resources=0)
