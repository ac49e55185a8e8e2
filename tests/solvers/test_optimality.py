"""What is said of objectives, of which a part is proved."""

from __future__ import annotations

from fractions import Fraction

import pytest

from compiler.objectives.least_values import Amount
from grammar_lang import ir
from solvers.search.objective_result import ObjectiveResult, Optimality
from srgc.text_reports.synthesis_report import gap_advice

PRICE = Amount(ir.Objective("sum", Fraction(1, 10), "price"), {}, exact=True)
MASS = Amount(ir.Objective("mass"), {}, exact=False)
TIME = Amount(ir.Objective("time"), {}, exact=False)
EFFORT = Amount(ir.Objective("effort"), {}, exact=False)


def result(
    value: str,
    least: str,
    reached: str | None = None,
    undecided: int = 0,
    *,
    more: bool = False,
    other: bool = False,
    amount: Amount = PRICE,
) -> ObjectiveResult:
    numbers = map(Fraction, (value, least, value if reached is None else reached))
    return ObjectiveResult(amount, *numbers, undecided, more, other)


SAID = {
    "least price 100": result("100", "100"),
    "least price 0": result("0", "0"),
    "price 100; no robot has less than 80 (gap 25 %)": result("100", "80"),
    "price 100; no robot has less than 8 (gap 1200 %)": result("100", "8"),
    "price 110 (least price 100)": result("110", "100", "100"),
    "price 100": result("100", "0"),
    "least price 100, unless the undecided robot does it for less": result(
        "100", "90", undecided=1
    ),
    "least price 100, unless one of 2 undecided robots does it for less": result(
        "100", "90", undecided=2
    ),
    "least price 100, unless a robot that was not tried does it for less": result(
        "100", "90", more=True
    ),
    "least price 100, unless the undecided robot, or one that was not tried, does it for less": (
        result("100", "90", undecided=1, more=True)
    ),
    # A robot is known that has less: what was not tried is not all that may.
    "price 110 (least price 100, unless one of 3 undecided robots does it for less)": result(
        "110", "90", "100", undecided=3
    ),
    "price 110 (least price 100, unless a robot that was not tried does it for less)": result(
        "110", "0", "100", more=True
    ),
    # Robots that were found may have less: nothing is the least.
    "price 50; no robot has less than 40 (gap 25 %)": result("50", "40", other=True),
    "price 5; no robot has less than 4 (gap 25 %); perhaps the undecided robot does it for less": (
        result("5", "4", undecided=1, other=True)
    ),
    "price 100; perhaps a robot that was not tried does it for less": result(
        "100", "0", more=True, other=True
    ),
    "least mass 1/3 kg": result("1/3", "1/3", amount=MASS),
    "effort 25 %": result("1/4", "0", amount=EFFORT),
}


@pytest.mark.parametrize("said", SAID)
def test_words(said: str) -> None:
    assert SAID[said].text == said
    assert SAID[said].is_least is (said.startswith("least") and "unless" not in said)


def test_several_objectives_and_a_bound_that_no_one_asked_for() -> None:
    objectives = result("5", "5"), result("2", "2", amount=MASS)
    of_all = Optimality(objectives, 8, by_default=False, records=(), dearer=(), lemmas=())
    assert of_all.text == "least price 5; then least mass 2 kg"
    few = Optimality(objectives, 12, by_default=True, records=(), dearer=(), lemmas=())
    assert few.text == "least price 5; then least mass 2 kg, of robots with up to 12 modules"


def test_what_may_close_a_gap() -> None:
    def advice(*objectives: ObjectiveResult, free: bool = True) -> str | None:
        found = Optimality(objectives, None, by_default=False, records=(), dearer=(), lemmas=())
        return gap_advice(found, free=free)

    decide = "more `--paths` or `--evaluations` may decide the undecided robots"
    narrow = "narrower ranges of parameters bring the bound closer; another `--seed` may find less"
    assert advice(result("100", "100")) is None
    assert advice(result("102", "100", amount=MASS)) is None
    assert advice(result("103", "100", amount=MASS)) == narrow
    assert advice(result("103", "100", amount=MASS), free=False) is None
    assert advice(result("103", "100", undecided=1)) == decide
    assert advice(result("3", "2", undecided=1, amount=MASS)) == f"{decide}; {narrow}"
    assert advice(result("1/4", "0", amount=EFFORT), result("3", "3", amount=MASS)) is None
    assert advice(result("3", "2", amount=TIME)) is None


def test_gaps() -> None:
    assert result("100", "80").gap == Fraction(1, 4)
    assert result("100", "0").gap is None
