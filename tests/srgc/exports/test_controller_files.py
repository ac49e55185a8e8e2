"""``srgc export --to controller``: C and Python compute the law, as closely as is stated."""

from __future__ import annotations

import re
import shlex
import shutil
import subprocess
from collections.abc import Callable, Sequence
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from random import Random
from typing import Any

import numpy as np
import pytest
from flint import arb

from solvers.verifier.certified_tube import certified_tube
from solvers.verifier.proofs.enclosure import EnclosureFailure
from solvers.verifier.verification import Outcome, verify_directory
from srgc.exports.exported_controller import exported_controller
from srgc.exports.law_rounding import DOUBLE, SINGLE, rounding_bounds
from srgc.results import found_design
from tests.oracles import pages, result_files
from tests.oracles.driven_claims import CASES, Driven
from tests.oracles.exported_controllers import (
    COMPILERS,
    WARNINGS,
    compiled,
    constants,
    law,
    module,
    single,
)
from tests.oracles.found_folders import claim_found
from tests.oracles.small_specs import TURNER, replaced
from tests.oracles.some_cases import examples
from tests.srgc.conftest import Ran

Export = Callable[..., Ran]
Result = Callable[[str], Path]
pytestmark = pytest.mark.usefixtures("tubes_once")

FILES = {"controller.c", "controller.py", "controller.npz"}
CLOSED = ("merged joints", "space, turning and sliding", "friction")
ALLOWANCE = "0.01"


def closed_loop(driven: Driven, path: Path) -> Path:
    """A folder that claims a random motion, with random small gains about it."""
    folder, rng = driven.folder(path), Random(5)

    def control(content: dict[str, Any]) -> None:
        n = len(driven.joints)
        start, size = [float(x) for x in content["start"]], driven.torque / 10

        def some(scale: float) -> str:
            return f"{rng.uniform(-scale, scale):.6f}"

        content["format"] = 4
        content["claims"] = [
            {
                "kind": "controller",
                "reference": [
                    [f"{x + rng.uniform(-0.1, 0.1):.9f}" for x in start] for _ in content["inputs"]
                ],
                "gains": [
                    [[some(size) for _ in range(2 * n)] for _ in range(n)]
                    for _ in content["inputs"]
                ],
                "rounding": [ALLOWANCE] * n,
            }
        ]

    result_files.alter(folder, control, sign=True)
    return folder


@pytest.fixture(params=CLOSED)
def folder(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    return closed_loop(CASES[request.param], tmp_path / "claimed")


def exported(srgc: Export, folder: Path) -> Path:
    target = folder.parent / "controller"
    ran = srgc("export", folder, "--to", "controller", "-o", target)
    assert (ran.status, ran.err) == (0, "")
    assert {Path(line).name for line in ran.out.splitlines()} == FILES | {"controller_single.c"}
    assert {path.name for path in target.iterdir()} == FILES | {"controller_single.c"}
    return target


def measured_states(folder: Path, count: int) -> list[tuple[int, list[float]]]:
    """States in the tube, among them corners of its boxes, with their samples."""
    rng, found = Random(2), list[tuple[int, list[float]]]()
    samples = certified_tube(folder).samples[:-1]
    for number in range(count):
        sample = rng.randrange(len(samples))
        share = (lambda: rng.choice((-1, 1))) if number % 3 else (lambda: rng.uniform(-1, 1))
        state = [low + (1 + share()) / 2 * (high - low) for low, high in samples[sample].tolist()]
        found.append((sample, state))
    return found


def stated(text: str) -> list[float]:
    """The bounds of rounding that the comments of a file state."""
    return [float(x) for x in re.findall(r"inputs\[\d+\]: (\S+) \S+ of ", text)]


# --- what is computed ----------------------------------------------------------------------------


@pytest.mark.parametrize("compiler", COMPILERS)
def test_c_and_python_are_the_same_to_the_last_bit(
    srgc: Export, folder: Path, compiler: str
) -> None:
    target, content = exported(srgc, folder), result_files.read(folder)
    task, sizes = content["task"], (len(content["start"]), len(content["inputs"][0]))
    source, python = target / "controller.c", module(target / "controller.py")
    runs = [compiled(compiler, source, task, sizes, *options) for options in ((), ("-O3",))]
    assert constants(compiler, source, task) == (content["steps"], float(Fraction(content["step"])))
    bounds = stated(source.read_text(encoding="ascii"))
    assert len(bounds) == sizes[1]
    for sample, measured in measured_states(folder, examples(100, 300)):
        held = python.controller(sample, measured)
        assert [run(sample, measured) for run in runs] == [held, held]
        exact = law(content, sample, [Fraction(x) for x in measured])
        assert all(abs(Fraction(u) - v) <= b for u, v, b in zip(held, exact, bounds, strict=True))
    for sample in (-1, content["steps"], 10**6, -(2**31)):
        assert runs[0](sample, [0.0] * sizes[0]) is None
        with pytest.raises(IndexError, match="there is no sample"):
            python.controller(sample, [0.0] * sizes[0])
    with pytest.raises(ValueError, match="measured quantities"):
        python.controller(0, [0.0])


@pytest.mark.parametrize("compiler", COMPILERS)
def test_single_precision(srgc: Export, folder: Path, compiler: str) -> None:
    """Bit by bit that of NumPy; off the law of what was measured, by no more than is stated."""
    target, content = exported(srgc, folder), result_files.read(folder)
    task, sizes = content["task"], (len(content["start"]), len(content["inputs"][0]))
    source = target / "controller_single.c"
    run = compiled(compiler, source, task, sizes)
    bounds = stated(source.read_text(encoding="ascii"))
    worst = [0.0] * sizes[1]
    for sample, measured in measured_states(folder, examples(100, 300)):
        rounded = [np.float32(x) for x in measured]
        held = run(sample, [float(x) for x in rounded])
        assert held == single(content, sample, rounded)
        exact = law(content, sample, [Fraction(x) for x in measured])
        off = [float(abs(Fraction(u) - v)) for u, v in zip(held, exact, strict=True)]
        assert all(x <= bound for x, bound in zip(off, bounds, strict=True))
        worst = [max(pair) for pair in zip(worst, off, strict=True)]
    # The bounds are none that any error would keep.
    assert all(x >= bound / 60 for x, bound in zip(worst, bounds, strict=True))
    assert all(bound < float(ALLOWANCE) for bound in bounds)


def test_an_npz_has_the_doubles_of_the_python_module(srgc: Export, folder: Path) -> None:
    target = exported(srgc, folder)
    python = module(target / "controller.py")
    with np.load(target / "controller.npz", allow_pickle=False) as file:
        arrays = dict(file)
    for name in ("planned", "reference", "gains"):
        np.testing.assert_array_equal(arrays[name], getattr(python, name.upper()))
    (claim,) = result_files.read(folder)["claims"]
    np.testing.assert_array_equal(arrays["rounding"], [float(x) for x in claim["rounding"]])
    assert arrays["period"].tolist() == [python.PERIOD]
    assert len(arrays["planned"]) == python.SAMPLES
    for array, names in (("measured", python.MEASURED), ("input", python.INPUTS)):
        pairs = zip(arrays[f"{array}_names"], arrays[f"{array}_units"], strict=True)
        assert tuple(f"{name} ({unit})" for name, unit in pairs) == names
    assert arrays["spec_sha256"][0] == result_files.read(folder)["spec_sha256"]


def test_what_quantities_are_called(srgc: Export, tmp_path: Path) -> None:
    case = CASES["space, turning and sliding"]
    target = exported(srgc, closed_loop(case, tmp_path / "claimed"))
    python = module(target / "controller.py")
    assert python.MEASURED == (
        "position of V_2 (rad)", "position of H_4 (rad)", "position of P_8 (m)",
        "rate of V_2 (rad/s)", "rate of H_4 (rad/s)", "rate of P_8 (m/s)",
    )  # fmt: skip
    assert python.INPUTS == ("V_2 (N*m)", "H_4 (N*m)", "P_8 (N)")
    text = (target / "controller.c").read_text(encoding="ascii")
    for number, name in enumerate(python.MEASURED):
        assert f" * measured[{number}]: {name}\n" in text
    assert " * inputs[2]: P_8 (N)\n" in text
    assert "-ffp-contract=off" in text
    assert "#pragma STDC FP_CONTRACT OFF" in text


def test_a_design_that_was_found(srgc: Export, result: Result) -> None:
    """Its proof allows for both precisions, noise included."""
    folder = result("closed")
    assert verify_directory(folder).outcome is Outcome.VALID
    target, content = exported(srgc, folder), result_files.read(folder)
    python, rng = module(target / "controller.py"), Random(9)
    (claim,) = content["claims"]
    allowed = [Fraction(text) for text in claim["rounding"]]
    noise = [np.pi / 180 * 0.05, np.pi / 180 * 0.1]
    for sample, state in measured_states(folder, 100):
        measured = [x + rng.uniform(-1, 1) * e for x, e in zip(state, noise, strict=True)]
        exact = law(content, sample, [Fraction(x) for x in measured])
        for held in (
            python.controller(sample, measured),
            single(content, sample, [np.float32(x) for x in measured]),
        ):
            assert all(
                abs(Fraction(u) - v) <= most
                for u, v, most in zip(held, exact, allowed, strict=True)
            )


@pytest.mark.parametrize("compiler", COMPILERS)
def test_a_loop_begins_again(srgc: Export, result: Result, compiler: str) -> None:
    """Behind the last sample comes the first of the loop; before the first there is none."""
    folder = result("looped")
    target, content = exported(srgc, folder), result_files.read(folder)
    first = next(claim["first"] for claim in content["claims"] if claim["kind"] == "loop")
    steps, sizes = content["steps"], (len(content["start"]), len(content["inputs"][0]))
    run = compiled(compiler, target / "controller.c", content["task"], sizes)
    python, measured = module(target / "controller.py"), [0.1 * k for k in range(sizes[0])]
    for sample in range(first, steps):
        for rounds in (1, 2, 1000):
            again = sample + rounds * (steps - first)
            assert run(again, measured) == run(sample, measured)
            assert python.controller(again, measured) == python.controller(sample, measured)
    assert run(-1, measured) is None


# --- open loops ----------------------------------------------------------------------------------


@pytest.mark.parametrize("compiler", COMPILERS)
@pytest.mark.parametrize("spec", ["turner", "motor"])
def test_inputs_of_an_open_loop(srgc: Export, made: Result, tmp_path: Path, spec, compiler) -> None:
    folder, target = made(spec) / "out", tmp_path / "controller"
    assert srgc("export", folder, "--to", "controller", "-o", target).status == 0
    assert {path.name for path in target.iterdir()} == FILES
    content, python = result_files.read(folder), module(target / "controller.py")
    run = compiled(compiler, target / "controller.c", content["task"], (2, 1))
    for sample, row in enumerate(content["inputs"]):
        held = [float(text) for text in row]
        assert run(sample, [np.nan, np.nan]) == python.controller(sample) == held
    assert run(10, [0, 0]) is None
    unit = "M_2.voltage (V)" if spec == "motor" else "JO_2 (N*m)"
    assert (unit,) == python.INPUTS
    with np.load(target / "controller.npz") as arrays:
        assert arrays["planned"].tolist() == [[float(x) for x in row] for row in content["inputs"]]
        assert {"gains", "reference", "rounding"}.isdisjoint(arrays)
    for name in ("controller.c", "controller.py"):
        text = (target / name).read_text(encoding="utf-8")
        assert "fixed in advance: an open loop. It measures nothing." in text


def test_a_quotient_is_a_decimal(srgc: Export, tmp_path: Path) -> None:
    folder = CASES["a slide alone"].folder(tmp_path / "claimed")
    result_files.alter(folder, lambda c: c["inputs"].__setitem__(0, ["1/3"]), sign=True)
    result_files.alter(folder, lambda c: c["inputs"].__setitem__(1, ["-2"]), sign=True)
    target = tmp_path / "controller"
    assert srgc("export", folder, "--to", "controller", "-o", target).status == 0
    text = (target / "controller.c").read_text(encoding="ascii")
    assert "{0.3333333333333333},\n    {-2.0},\n" in text
    assert "The doubles nearest to them differ\n * by at most " in text


EDGE = "*/??/**//**/???/ä\\"
HOSTILE = TURNER.replace("edge eps;", f'edge "{EDGE}";').replace(" eps ", f' "{EDGE}" ')
"""An edge that ends a comment, or begins one, or is a line that goes on in the next one."""


@pytest.mark.parametrize("compiler", COMPILERS)
def test_a_comment_stays_one(srgc: Export, tmp_path: Path, compiler: str) -> None:
    word = ["B", EDGE, "JO", EDGE, "L", EDGE, "EN"]
    folder = claim_found(tmp_path / "claimed", HOSTILE, word, ["1.5"])
    target = tmp_path / "controller"
    assert srgc("export", folder, "--to", "controller", "-o", target).status == 0
    compiled(compiler, target / "controller.c", "Turn", (2, 1))
    module(target / "controller.py")


PAGE = Path(__file__).parents[3] / "docs" / "how-to" / "controller.md"


@pytest.mark.skipif(shutil.which("gcc") is None, reason="gcc is not installed")
def test_the_program_of_the_page(
    srgc: Export, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    case = CASES["friction"]
    text = replaced(replaced(case.text, "task Turn", "task Held"), "of 0.2 s", "of 0.1 s")
    folder = closed_loop(replace(case, text=text), tmp_path / "claimed")
    assert srgc("export", folder, "--to", "controller", "-o", tmp_path / "held").status == 0
    monkeypatch.chdir(tmp_path)
    blocks = pages.blocks(PAGE.read_text(encoding="utf-8"))
    (number,) = (i for i, block in enumerate(blocks) if block.kind == "sh")
    Path("main.c").write_text(blocks[number - 1].body, encoding="utf-8")
    subprocess.run([*shlex.split(blocks[number].body), *WARNINGS], check=True)
    ran = subprocess.run(["./main"], capture_output=True, text=True, check=True)
    assert ran.stdout == blocks[number + 1].body


# --- ROS 2 has no gains --------------------------------------------------------------------------


def test_a_message_says_what_it_is_not(srgc: Export, folder: Path, made: Result) -> None:
    assert (
        "# the gains of its feedback are not in here;" in srgc("export", folder, "--to", "ros2").out
    )
    slider = srgc("export", made("slider") / "out", "--to", "ros2").out
    assert "# open loop: efforts are held from point to point" in slider


# --- what is not covered -------------------------------------------------------------------------


def refused(ran: Ran, reason: str, status: int = 2) -> None:
    assert (ran.status, ran.out) == (status, "")
    assert reason in ran.err
    assert ran.err.count("\n") == 1


def allowing(folder: Path, allowances: Sequence[str] | None) -> Path:
    def change(content: dict[str, Any]) -> None:
        (claim,) = content["claims"]
        if allowances is None:
            del claim["rounding"]
        else:
            claim["rounding"] = allowances

    result_files.alter(folder, change, sign=True)
    return folder


@pytest.fixture
def arm(tmp_path: Path) -> Path:
    return closed_loop(CASES["merged joints"], tmp_path / "claimed")


def test_single_precision_is_left_out_where_the_proof_does_not_allow_for_it(
    srgc: Export, arm: Path, tmp_path: Path
) -> None:
    target = tmp_path / "controller"
    ran = srgc("export", allowing(arm, ["0.01", "1/100000000"]), "--to", "controller", "-o", target)
    assert ran.status == 0
    assert {path.name for path in target.iterdir()} == FILES
    assert ran.err.startswith("note: no controller_single.c: in single precision, rounding may")
    assert "the input JO_8 by" in ran.err
    assert "allows for 1e-08 N*m" in ran.err
    said = ran.err.removeprefix("note: ").rstrip()
    for name in ("controller.c", "controller.py"):
        assert f"There is {said}.\n" in (target / name).read_text(encoding="utf-8")
    everything = srgc("export", arm, "--to", "all", "-o", tmp_path / "all")
    assert everything.err == ran.err
    assert "controller.c" in everything.out
    assert "controller_single.c" not in everything.out


def test_what_an_earlier_export_left_is_named(srgc: Export, arm: Path) -> None:
    target = exported(srgc, arm)
    earlier = (target / "controller_single.c").read_bytes()
    allowing(arm, ["1/100000000"] * 2)
    for form in ("controller", "all"):
        ran = srgc("export", arm, "--to", form, "-o", target)
        assert ran.status == 0
        assert f"note: {target / 'controller_single.c'} is of an earlier export" in ran.err
    assert (target / "controller_single.c").read_bytes() == earlier
    assert srgc("export", arm, "--to", "mujoco", "-o", target) == Ran(
        0, "".join(f"{target / name}\n" for name in REPLAYED), ""
    )


REPLAYED = ("gains.csv", "replay.py", "robot.xml", "torques.csv", "trajectory.csv")


@pytest.mark.parametrize(
    ("allowances", "reason"),
    [
        (None, "the certificate states no allowance for rounding"),
        (["0", "0.01"], "in doubles, rounding may change the input JO_2_JO_4 by"),
        (["0.01", "0." + 20 * "0" + "1"], "in doubles, rounding may change the input JO_8 by"),
        (["0.01"], "does not fit the robot"),
        ([], "does not fit the robot"),
        (["0.01", "-1"], "an allowance for rounding is negative"),
    ],
)
def test_without_an_allowance_there_is_no_controller(
    srgc: Export, arm: Path, tmp_path: Path, allowances: list[str] | None, reason: str
) -> None:
    target = tmp_path / "controller"
    refused(srgc("export", allowing(arm, allowances), "--to", "controller", "-o", target), reason)
    assert not target.exists()
    ran = srgc("export", arm, "--to", "all", "-o", tmp_path / "all")
    assert ran.status == 0
    assert "note: no controller.c: " in ran.err
    assert (tmp_path / "all" / "gains.csv").exists()
    assert not (tmp_path / "all" / "controller.c").exists()


@pytest.mark.parametrize(
    ("gain", "planned", "measured", "finite"),
    [
        ("1" + 60 * "0", "1", 1.0, (True, False)),
        ("1", "1" + 60 * "0", 1.0, (True, False)),
        ("1", "1", 1e60, (True, False)),
        ("0", "1", 1e60, (True, False)),
        ("1" + 20 * "0", "1", 1e20, (True, False)),
        ("1" + 299 * "0", "1", 1e20, (False, False)),
        ("1", "1", float("inf"), (False, False)),
        ("0." + 60 * "0" + "1", "1", 1e-60, (True, True)),
    ],
)
def test_what_is_beyond_a_precision_has_no_bound(
    arm: Path, gain: str, planned: str, measured: float, finite: tuple[bool, bool]
) -> None:
    def change(content: dict[str, Any]) -> None:
        (claim,) = content["claims"]
        claim["gains"][2][0][1] = gain
        content["inputs"][2][0] = planned

    result_files.alter(arm, change, sign=True)
    controller = exported_controller(found_design.found_design(arm))
    states = [[arb(measured) for _ in controller.measured] for _ in range(controller.samples + 1)]
    for precision, due in zip((DOUBLE, SINGLE), finite, strict=True):
        bounds = rounding_bounds(controller, states, precision)
        assert bounds[0].is_finite() is due


def test_gains_of_another_shape(srgc: Export, arm: Path, tmp_path: Path) -> None:
    """As many numbers as are due, in other rows."""

    def change(content: dict[str, Any]) -> None:
        (claim,) = content["claims"]
        claim["gains"] = [[[*a, *b]] for a, b in claim["gains"]]

    result_files.alter(arm, change, sign=True)
    for form in ("controller", "mujoco"):
        ran = srgc("export", arm, "--to", form, "-o", tmp_path / form)
        refused(ran, "the controller of the certificate does not fit the robot")


def test_without_a_tube(
    srgc: Export, arm: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fails(_folder: Path) -> None:
        raise EnclosureFailure(0.75)

    monkeypatch.setattr(found_design, "certified_tube", fails)
    ran = srgc("export", arm, "--to", "controller", "-o", tmp_path / "controller")
    refused(ran, "no enclosure of the motion beyond 0.75 s", 4)
    ran = srgc("export", arm, "--to", "all", "-o", tmp_path / "all")
    assert ran.status == 0
    assert "note: no controller.c: no enclosure of the motion" in ran.err


def test_a_robot_without_inputs(srgc: Export, tmp_path: Path) -> None:
    text = replaced(TURNER, " and starts with B eps JO", "")
    folder = claim_found(tmp_path / "pole", text, "B eps L eps EN", ["1.5"])
    ran = srgc("export", folder, "--to", "controller", "-o", tmp_path / "controller")
    refused(ran, "the robot has no inputs, so there is nothing to control")
