from __future__ import annotations

import math
import subprocess
import sys
from fractions import Fraction

import pytest

from solvers.verifier.verification import Outcome, verify_directory
from tests.oracles import result_files
from tests.oracles.result_files import alter, alter_spec, read
from tests.oracles.turning_link import one_link_tips

FIELDS = [
    "format", "kind", "task", "spec", "spec_sha256", "word", "derivation", "parameters",
    "effector", "steps", "step", "start", "inputs", "path", "effort_peak", "robustness", "cuts",
    "digest",
]  # fmt: skip


def last_digit(text):
    """The decimal with its last digit changed by one."""
    return text[:-1] + str(int(text[-1]) ^ 1)


def put(*keys_and_value):
    *keys, last, value = keys_and_value

    def change(content):
        for key in keys:
            content = content[key]
        content[last] = value(content[last]) if callable(value) else value

    return change


def both(*changes):
    def change(content):
        for one in changes:
            one(content)

    return change


ALTERED = {
    "format": put("format", 1),
    "kind": put("kind", "impossible"),
    "task": put("task", "Other"),
    "spec": put("spec", "other.srg"),
    "spec_sha256": put("spec_sha256", last_digit("00")),
    "word": put("word", 4, "JO"),
    "a shorter word": put("word", lambda w: w[:-2]),
    "derivation": put("derivation", 0, "link"),
    "a length by its smallest digit": put("parameters", 0, "value", last_digit),
    "a length by much": put("parameters", 0, "value", "1.9"),
    "a parameter's name": put("parameters", 0, "name", "width"),
    "a parameter's symbol": put("parameters", 0, "symbol", 2),
    "effector": put("effector", 1),
    "cuts": put("cuts", [[0, ["1", "0"], "1"]]),
    "steps": put("steps", 9),
    "step": put("step", "0.2"),
    "start": put("start", 0, last_digit),
    "a start rate": put("start", 1, "0.1"),
    "one input's last digit": put("inputs", 3, 0, last_digit),
    "one input": put("inputs", 3, 0, "11"),
    "path": put("path", 0, 5, "O"),
    "effort_peak": put("effort_peak", last_digit),
    "robustness": put("robustness", last_digit),
    "digest": put("digest", lambda text: ("0" if text[0] != "0" else "1") + text[1:]),
}


@pytest.mark.parametrize("name", ALTERED)
def test_altered_with_the_old_digest(result, name):
    folder = result("turner")
    alter(folder, ALTERED[name], sign=False)
    report = verify_directory(folder)
    assert report.outcome is Outcome.REFUTED
    assert report.reason is not None
    assert "altered" in report.reason


def test_every_field_is_covered(made):
    content = read(made("turner") / "out")
    assert sorted(content) == sorted(FIELDS)
    for field in FIELDS:
        assert any(name.startswith(field) for name in ALTERED) or field in ("parameters", "inputs")


FALSE = {
    "of another format": (put("format", 1), "not of format 3"),
    "a format that only equals": (put("format", True), "not of format 3"),
    "a kind without its fields": (put("kind", "impossible"), "`modules` is missing"),
    "no kind": (put("kind", "sure"), "unknown kind"),
    "no such task": (put("task", "Other"), "no task `Other`"),
    "no such spec": (put("spec", "other.srg"), "`other.srg` is missing"),
    "a spec elsewhere": (put("spec", "../certificate.json"), "is missing"),
    "another spec's digest": (put("spec_sha256", "00" * 32), "spec has been altered"),
    "a word that is not derived": (put("word", 4, "JO"), "does not derive the word"),
    "no derivation": (put("derivation", 0, "claw"), "is not one of the grammar"),
    "an unfinished derivation": (put("derivation", lambda d: d[:-1]), "is not one of the grammar"),
    "a word not accepted": (
        both(
            put("derivation", ["link", "joint", "base"]),
            put("word", ["B", "eps", "JO", "eps", "L"]),
        ),
        "the word is not accepted: B eps JO eps L",
    ),
    "a word with the joint elsewhere": (
        both(
            put("derivation", ["tool", "joint", "link", "base"]),
            put("word", ["B", "eps", "L", "eps", "JO", "eps", "EN"]),
        ),
        "the word is not accepted",
    ),
    "another robot of the family": (
        both(
            put("derivation", ["tool", "link", "joint", "link", "joint", "base"]),
            put("word", ["B", "eps", "JO", "eps", "L", "eps", "JO", "eps", "L", "eps", "EN"]),
        ),
        "not 10 rows of 2",
    ),
    "a robot without a joint that moves": (
        both(
            put("derivation", ["tool", "joint", "base"]),
            put("word", ["B", "eps", "JO", "eps", "EN"]),
            put("parameters", []),
            put("start", []),
            put("inputs", [[]] * 10),
            put("effort_peak", "0"),
            put("robustness", "0"),
        ),
        "",
    ),
    "a length just above its range": (
        put("parameters", 0, "value", "2.000000000000001"),
        "`L.length` = 2.000000000000001 at symbol 4 is outside its range",
    ),
    "a length below its range": (put("parameters", 0, "value", "0.99"), "outside its range"),
    "a negative length": (put("parameters", 0, "value", "-1.5"), "outside its range"),
    "a length by much": (put("parameters", 0, "value", "1.9"), "violated"),
    "a length that is no number": (put("parameters", 0, "value", "nan"), "not an exact number"),
    "a length without end": (put("parameters", 0, "value", "1e999999999"), "not an exact number"),
    "a parameter of another name": (
        put("parameters", 0, "name", "width"), "not those of the robot",
    ),
    "a parameter of another module": (put("parameters", 0, "symbol", 2), "not those of the robot"),
    "a parameter too few": (put("parameters", []), "not those of the robot"),
    "a parameter too many": (put("parameters", lambda p: p + p), "not those of the robot"),
    "no such effector": (put("effector", 1), "no effector 2"),
    "a negative effector": (put("effector", -1), "no effector 0"),
    "another number of steps": (put("steps", 9), "horizon"),
    "another step": (put("step", "0.25"), "horizon"),
    "a step that divides by zero": (put("step", "1/0"), "divides by zero"),
    "a start too short": (put("start", lambda s: s[:1]), "1 coordinates and 1 rates"),
    "a start elsewhere": (put("start", 0, "0.9"), "start S: violated at 0 s"),
    "a start in motion": (put("start", 1, "0.001"), "start rates: violated at 0 s"),
    "a start turns away": (put("start", 0, "6283185.3"), "violated"),
    "an input above the bound": (put("inputs", 3, 0, "10.000001"), "effort (N*m): violated at 0.6"),
    "an input below the bound": (put("inputs", 9, 0, "-11"), "effort (N*m): violated at 1.8 s"),
    "an enormous input": (put("inputs", 0, 0, "9" * 300), "effort (N*m): violated"),
    "an input too few": (put("inputs", lambda rows: rows[:-1]), "not 10 rows of 1"),
    "two inputs for one joint": (put("inputs", 0, ["0", "0"]), "not 10 rows of 1"),
    "a peak too low": (put("effort_peak", "0.1"), "`effort_peak` is "),
    "a peak off by its last digit": (put("effort_peak", last_digit), "`effort_peak` is "),
    "a robustness too high": (put("robustness", "9.9"), "`robustness` is "),
    "a robustness off by its last digit": (put("robustness", last_digit), "`robustness` is "),
    "a path through the obstacle": (
        put("path", 0, 5, "O"),
        "the path of effector 1 goes through `O` at sample 5",
    ),
    "a path through an unknown cell": (put("path", 0, 5, "Q"), "unknown cell `Q`"),
    "a path from elsewhere": (put("path", 0, 0, "T"), "starts in `T`"),
    "a path to elsewhere": (put("path", 0, 10, "S"), "does not end in the target"),
    "a path not followed": (put("path", 0, 5, "S"), "is not in `S`"),
    "a path too short": (put("path", 0, lambda names: names[:-1]), "not 11 cells per effector"),
    "a path for two": (put("path", lambda rows: rows * 2), "not 11 cells per effector"),
    "no path": (put("path", []), "not 11 cells per effector"),
    "texts for lists": (put("word", "B"), "list of strings"),
    "numbers for texts": (put("inputs", 0, 0, 0.5), "list of strings"),
}  # fmt: skip


@pytest.mark.parametrize("name", FALSE)
def test_a_false_claim_with_a_fitting_digest(result, name):
    change, reason = FALSE[name]
    folder = result("turner")
    before = read(folder)
    assert alter(folder, change, sign=True) != before
    report = verify_directory(folder)
    assert report.outcome is Outcome.REFUTED, report
    assert report.reason is not None
    assert reason in report.reason
    assert "\n" not in report.reason


def efforts(content):
    """Peak and robustness stated again, exactly."""
    peak = max(abs(Fraction(text)) for (text,) in content["inputs"])
    content["effort_peak"], content["robustness"] = decimal(peak), decimal(10 - peak)


def decimal(value):
    text = f"{value.numerator * 10**40 // value.denominator:041d}"
    assert value.numerator * 10**40 % value.denominator == 0
    return f"{text[:-40]}.{text[-40:]}"


def test_a_target_missed(result):
    folder = result("turner")
    alter(folder, both(put("inputs", 5, 0, "0.2"), efforts), sign=True)
    report = verify_directory(folder)
    assert report.outcome is Outcome.REFUTED
    assert report.reason is not None
    assert "violated" in report.reason
    assert any(f.name == "target T" and f.status.value == "fails" for f in report.conditions)


def test_a_change_that_keeps_the_claim_true(result):
    folder = result("turner")
    (folder / "design.json").unlink()
    content = read(folder)
    sizes = [abs(Fraction(row[0])) for row in content["inputs"]]
    idle = sizes.index(min(sizes))
    longer = put("inputs", idle, 0, lambda text: f"{text}000000001" if "." in text else "0.00001")
    alter(folder, longer, sign=True)
    assert verify_directory(folder).outcome is Outcome.VALID
    alter(folder, put("parameters", 0, "value", lambda text: text + "1"), sign=True)
    assert verify_directory(folder).outcome is Outcome.VALID
    alter(folder, put("step", "1/5"), sign=True)
    assert verify_directory(folder).outcome is Outcome.VALID


SPEC_CHANGES = {
    "a tighter bound": ("effort <= 10 N*m", "effort <= 0.1 N*m", "effort (N*m): violated"),
    "another robustness": ("effort <= 10 N*m", "effort <= 9 N*m", "`robustness` is "),
    "a moved target": ("[-0.3, 0.3] x [1.2, 1.9]", "[-0.9, -0.4] x [1.2, 1.9]", ""),
    "an obstacle on the way": ("[1.4, 2.5] x [1.4, 2.5]", "[0.7, 1.0] x [0.7, 1.0]", ""),
    "another range": ("[1, 2] m", "[1.5, 2] m", "outside its range"),
    "another horizon": ("10 steps", "11 steps", "horizon"),
    "a joint limit": ("[-180, 180] deg", "[-180, 70] deg", "range of JO.q: violated"),
    "a heavier link": ("1 kg/m", "3 kg/m", "violated"),
    "narrow bounds": ("[-1, 3] x [-1, 3]", "[-1, 1.21] x [-1, 3]", ""),
    "another language": ("and starts with B eps JO", "and ends with L", "the word is not accepted"),
    "fewer modules": ("horizon 10", "modules <= 3; horizon 10", "the task allows 3"),
    "an error": ("start N;", "start M;", "the spec has errors"),
    "another task": ("task Turn", "task Twist", "no task `Turn`"),
}


@pytest.mark.parametrize("name", SPEC_CHANGES)
def test_the_spec_changed(result, name):
    old, new, reason = SPEC_CHANGES[name]
    folder = result("turner")
    alter_spec(folder, old, new, sign=False)
    report = verify_directory(folder)
    assert report.outcome is Outcome.REFUTED
    assert report.reason is not None
    assert "the spec has been altered" in report.reason
    value = result_files.spec_digest({"turner.srg": (folder / "spec" / "turner.srg").read_bytes()})
    alter(folder, put("spec_sha256", value), sign=True)
    report = verify_directory(folder)
    assert report.outcome is Outcome.REFUTED
    assert report.reason is not None
    assert reason in report.reason
    assert "design.json" not in report.reason


def test_a_comment_more_is_another_spec_and_a_true_claim(result):
    folder = result("turner")
    alter_spec(folder, "edge eps;", "edge eps; // as in the paper", sign=True)
    report = verify_directory(folder)
    assert report.reason == "design.json and certificate.json differ in `spec_sha256`"
    (folder / "design.json").unlink()
    assert verify_directory(folder).outcome is Outcome.VALID


def test_a_file_more_is_another_spec(result):
    folder = result("turner")
    (folder / "spec" / "more.srg").write_text("// nothing")
    assert "altered" in str(verify_directory(folder).reason)


def test_the_spec_missing(result):
    folder = result("turner")
    (folder / "spec" / "turner.srg").unlink()
    report = verify_directory(folder)
    assert report.outcome is Outcome.REFUTED
    assert "`turner.srg` is missing" in str(report.reason)


def test_the_margins_are_those_of_an_independent_calculation(made):
    folder = made("turner") / "out"
    content, report = read(folder), verify_directory(folder)
    tips = one_link_tips(content, 100)
    length = float(content["parameters"][0]["value"])
    gap = min(math.hypot(max(1.4 - x, 0), max(1.4 - y, 0)) for x, y in tips)
    (x0, y0), (x1, y1) = tips[0], tips[-1]
    margins = {f.name: f.margin for f in report.conditions}
    expected = {
        "start S": min(x0 - 1.2, 1.9 - x0, y0 + 0.3, 0.3 - y0),
        "target T": min(x1 + 0.3, 0.3 - x1, y1 - 1.2, 1.9 - y1),
        "range of JO.q": min(math.pi - abs(math.atan2(y, x)) for x, y in tips),
        "bounds": min(min(x + 1, 3 - x, y + 1, 3 - y) for x, y in tips),
        "effort (N*m)": 10 - max(abs(float(text)) for (text,) in content["inputs"]),
        "mass matrix positive definite": length**3 / 3,
    }
    for name, value in expected.items():
        # A margin is a lower bound, at most a fiftieth below the true one.
        assert value * 0.97 - 1e-9 <= margins[name] <= value + 1e-9, name
    # Facets separate points only up to the square root of two of the distance to a corner.
    assert 0 < margins["clearance of effector to O"] <= gap + 1e-9


@pytest.mark.parametrize("bounds", ["polytope { x <= 4 }", "polytope { x <= 3; -x <= -3 }"])
def test_a_spec_whose_bounds_are_unbounded_or_flat_is_refused(result, bounds):
    folder = result("turner")
    alter_spec(folder, "bounds box [-1, 3] x [-1, 3] m", f"bounds {bounds} m", sign=True)
    report = verify_directory(folder)
    assert report.outcome is Outcome.REFUTED
    assert report.reason.startswith("the spec has errors")


@pytest.mark.parametrize("arguments", [(), ("a", "b"), ("--help",)])
def test_as_a_module_it_says_how_it_is_used(arguments):
    finished = subprocess.run(
        [sys.executable, "-m", "solvers.verifier", *arguments],
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    usage = "usage: python -m solvers.verifier DIR\n"
    assert (finished.returncode, finished.stdout, finished.stderr) == (2, "", usage)


def test_as_a_module_it_verifies(result, tmp_path):
    for folder, status, said in (
        (result("turner"), 0, "valid: found, task Turn, spec "),
        (tmp_path, 4, "undecided: "),
    ):
        finished = subprocess.run(
            [sys.executable, "-m", "solvers.verifier", folder],
            capture_output=True, text=True, check=False,
        )  # fmt: skip
        assert (finished.returncode, finished.stderr) == (status, "")
        assert finished.stdout.startswith(said)
