"""``srgc.evolve``: what the command does, with numbers of Python and with results as values."""

from __future__ import annotations

import json
from collections.abc import Callable
from decimal import Decimal
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

import srgc as public
from srgc.results.rebuilding import Price, asked_rebuilding
from tests.srgc.conftest import Ran
from tests.srgc.test_evolve import LIMBS, packed

Run = Callable[..., Ran]
__all__ = ["packed"]

FAR = (
    LIMBS.replace("[0.5, 1.5] m", "[1.1, 1.5] m")
    .replace("[0.8, 1] x", "[1.1, 1.3] x")
    .replace("[-0.1, 0.2] x [0.8, 1] m", "[-0.1, 0.2] x [1.1, 1.3] m")
)
"""Limbs of 1.1 m at least, longer than that of the arm that packs, and a place that needs one."""


@pytest.fixture(scope="module")
def program() -> public.api.program.Program:
    return public.load(text=LIMBS)


@pytest.mark.parametrize(
    ("price", "known"),
    [
        (2, "2"),
        (0, "0"),
        (0.1, "1/10"),
        (0.1 + 0.2, "30000000000000004/100000000000000000"),
        (1e-7, "1/10000000"),
        (Fraction(1, 3), "1/3"),
        (Decimal("0.25"), "1/4"),
        ("0.5", "1/2"),
        ("1/3", "1/3"),
        (np.float64(0.75), "3/4"),
        (np.int64(3), "3"),
    ],
)
def test_prices_are_the_decimals_that_they_show(
    price: Price, known: str, program: public.api.program.Program
) -> None:
    asked = asked_rebuilding(
        program.ir, add=price, remove=1, change=0, free=("Limb.length",), changes=price
    )
    assert asked.prices.add == asked.most == Fraction(known)


@pytest.mark.parametrize(
    "price",
    [
        -1, -0.5, float("nan"), float("inf"), True, "x", "-1", 10**5000, 10**12, 1e12, 1e-300,
        Decimal("1E+1000000"), Decimal("1E-1000000"), Decimal("NaN"), Fraction(1, 10**40), [1],
    ],
    ids=lambda price: type(price).__name__,
)  # fmt: skip
def test_what_is_no_price_is_refused(
    price: Price, program: public.api.program.Program, tmp_path: Path
) -> None:
    for name in ("add", "remove", "change", "changes"):
        with pytest.raises(
            public.SrgcError, match=f"^`{name}` takes a number of at least 0"
        ) as caught:
            public.evolve(tmp_path, program, **{name: price})  # type: ignore[arg-type]
        assert len(str(caught.value)) < 200


@pytest.mark.parametrize(
    ("options", "arguments"),
    [
        (("--add=-1",), {"add": "-1"}),
        (("--changes=9e9",), {"changes": "9e9"}),
        (("--free=Arm.length",), {"free": "Arm.length"}),
        (("--free=Limb.width",), {"free": ["Limb.width"]}),
        (("--free=Limb",), {"free": ("Limb",)}),
        (("--change=3",), {"change": 3}),
    ],
    ids=str,
)
def test_messages_are_those_of_the_command(
    options: tuple[str, ...],
    arguments: dict[str, Price],
    program: public.api.program.Program,
    srgc: Run,
    tmp_path: Path,
) -> None:
    """But for the names of what is given."""
    spec = tmp_path / "spec.srg"
    spec.write_text(LIMBS, encoding="utf-8")
    ran = srgc("evolve", tmp_path, spec, "-o", tmp_path / "next", *options)
    assert ran.status == 2
    with pytest.raises(public.SrgcError) as caught:
        public.evolve(tmp_path, program, **arguments)  # type: ignore[arg-type]
    said = ran.err
    for name in ("add", "changes", "change", "free"):
        said = said.replace(f"--{name} ", f"`{name}` ").replace(f"--{name}\n", f"`{name}`\n")
    assert said == f"error: {caught.value}\n"


def test_without_a_robot_there_is_a_code(
    program: public.api.program.Program, tmp_path: Path
) -> None:
    (tmp_path / "design.json").write_text(json.dumps({"verdict": "unknown"}), encoding="utf-8")
    with pytest.raises(public.SrgcError, match="has no robot: its verdict is unknown") as caught:
        public.evolve(tmp_path, program)
    assert caught.value.code is not None
    assert caught.value.code.value == "SRG0735"


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ({"task": "Pick"}, "there is no task `Pick`; the file has: Pack"),
        ({"jobs": 0}, "`jobs` and `cells` count from 1"),
        ({"seed": -1}, "`seed` is not negative"),
        ({"time_limit": 0}, "`time_limit` is a positive number"),
    ],
)
def test_other_arguments_are_those_of_a_synthesis(
    arguments: dict[str, object],
    said: str,
    program: public.api.program.Program,
    tmp_path: Path,
) -> None:
    with pytest.raises(public.SrgcError, match=said):
        public.evolve(tmp_path, program, **arguments)  # type: ignore[arg-type]


def test_a_step_is_not_written_over_its_robot(
    packed: Path, program: public.api.program.Program
) -> None:
    with pytest.raises(public.SrgcError, match=r"name another place as `output`$"):
        public.evolve(packed / "out", program, output=packed / "out" / "next")


def test_a_robot_is_rebuilt_and_again(packed: Path, tmp_path: Path) -> None:
    """The limb is exchanged, at the prices of both; then there is nothing left to be changed."""
    before, far = public.open_result(packed / "out"), public.load(text=FAR)
    found = public.evolve(
        before, far, "Pack", output=tmp_path / "far", add=2, remove=Fraction(1, 2)
    )
    assert (found.verdict, found.cost, found.least) == ("found", 2.5, 2.5)
    assert found.folder == tmp_path / "far"
    assert found.differs == {"Limb": ("parameter length",)}
    assert "differs:     module Limb (parameter length)" in str(found).splitlines()
    [step] = found.steps
    assert step is not None
    assert (step.added, step.removed) == (((1, "Limb"),), ((1, "Limb"),))
    again = public.evolve(found, far)
    assert again.differs == {}
    assert (again.cost, again.tasks) == (0, ("Pack",))
    assert again.design["history"] == 2
    assert again.verify().valid
    kept = again.save(tmp_path / "kept")
    assert public.verify(kept, expect="found").valid


def test_a_free_parameter_changes(packed: Path) -> None:
    found = public.evolve(
        packed / "out", public.load(text=FAR), free="Limb.length", change=Decimal("0.25")
    )
    assert (found.verdict, found.cost) == ("found", 0.25)
    [step] = found.steps
    assert step is not None
    assert step.changed == ("1.length",)
    assert found.folder != packed


def test_within_a_bound_that_is_too_small_there_is_no_robot(packed: Path) -> None:
    """To exchange the limb costs 2."""
    found = public.evolve(packed / "out", public.load(text=FAR), changes=1.5)
    assert (found.verdict, found.designs) == ("impossible", {})
    with pytest.raises(public.SrgcError, match="its verdict is impossible"):
        public.evolve(found, public.load(text=FAR))
