from __future__ import annotations

import json
import re

import pytest

from tests.oracles import result_files
from tests.oracles.small_specs import SLIDER

TASKS = {"turner": "Turn", "slider": "Slide"}


@pytest.mark.parametrize("spec", ["turner", "slider"])
def test_a_result_is_valid_with_margins(srgc, made, spec):
    ran = srgc("verify", made(spec) / "out")
    assert (ran.status, ran.err) == (0, "")
    lines = ran.out.splitlines()
    assert lines[0] == "valid: found, level validated"
    digest = result_files.read(made(spec) / "out", "design.json")["spec_sha256"]
    about = [f"task: {TASKS[spec]}", f"spec: {spec}.srg", f"sha256: {digest}", "control: open loop"]
    assert lines[1:5] == about
    assert lines[-1].startswith("next:    srgc report")
    assert all(len(line) <= 80 for line in lines)
    # A margin may be on a second line, farther to the right.
    shown = "\n".join(lines[5:-1]).replace("\n    ", " ").splitlines()
    assert all(line.startswith("  holds ") and " at " in line for line in shown)
    assert [line.split()[1] for line in shown if " margin " not in line] == ["start"]
    for name in ("effort (N", "target T", "start S", "bounds", "cell path", "range of "):
        assert any(f"  {name}" in line for line in shown)


@pytest.mark.parametrize(
    ("spec", "control"),
    [("turner", "open loop"), ("closed", "feedback"), ("beyond_reach", None)],
)
def test_what_drives_the_robot_is_told(srgc, made, spec, control):
    """By the search that found it as by the verifier."""
    told = [
        line for line in srgc("verify", made(spec) / "out").out.splitlines() if "control" in line
    ]
    assert told == ([] if control is None else [f"control: {control}"])
    found = (made(spec) / "stdout").read_text(encoding="utf-8").splitlines()
    said = [line.partition(",")[0] for line in found if line.startswith("control")]
    assert said == told
    answer = json.loads(srgc("verify", made(spec) / "out", "--json").out)
    assert answer["control"] == control
    assert result_files.read(made(spec) / "out", "design.json")["control"] == control


@pytest.mark.parametrize(
    ("spec", "verdict", "task"),
    [("turner", "found", "Turn"), ("beyond_reach", "impossible", "Turn")],
)
def test_what_is_expected(srgc, made, spec, verdict, task):
    folder = made(spec) / "out"
    other = {"found": "impossible", "impossible": "found"}[verdict]
    asked = ("--task", task, "--expect", verdict)
    assert srgc("verify", folder, *asked).out == srgc("verify", folder).out
    last = {"found": "next:    srgc report", "impossible": "next:    srgc why"}[verdict]
    assert srgc("verify", folder).out.splitlines()[-1].startswith(last)
    for options, said in (
        (("--task", "Easy"), f"the certificate is about task `{task}`, not `Easy`"),
        (("--expect", other), f"the certificate says {verdict}, not {other}"),
        (("--task", task, "--expect", other), f"the certificate says {verdict}, not {other}"),
        (("--task", task.lower()), f"the certificate is about task `{task}`, not `{task.lower()}`"),
    ):
        ran = srgc("verify", folder, *options)
        assert ran.status == 6
        assert ran.out.splitlines()[:2] == [f"not as expected: {said}", f"task: {task}"]
        assert "valid" not in ran.out
        answer = json.loads(srgc("verify", folder, *options, "--json").out)
        assert (answer["outcome"], answer["verdict"]) == ("not as expected", verdict)
        assert (answer["task"], answer["findings"]) == (task, [])


def test_a_claim_that_is_not_expected_is_not_judged(srgc, result):
    """It may be false; but an altered certificate is refused before one reads what it is about."""
    folder = result("turner")
    result_files.alter(folder, lambda c: c["inputs"][4].__setitem__(0, "10.5"), sign=True)
    assert srgc("verify", folder, "--task", "Easy").status == 6
    assert srgc("verify", folder, "--task", "Turn").status == 1
    result_files.alter(folder, lambda c: c.update(task="Easy"), sign=False)
    assert srgc("verify", folder, "--task", "Easy").status == 1
    (folder / "certificate.json").unlink()
    assert srgc("verify", folder, "--expect", "found").status == 4


def test_the_spec_it_is_about(srgc, result, made, spec):
    folder = result("turner")
    assert srgc("verify", folder, "--spec", made("turner") / "turner.srg").status == 0
    other = spec(SLIDER)
    ran = srgc("verify", folder, "--spec", other)
    assert ran.status == 1
    assert ran.out.startswith(f"refuted: the certificate is not about {other}")


def test_usage(srgc, result, tmp_path):
    for arguments in ((tmp_path / "none",), (result("slider"), "--spec", tmp_path / "none.srg")):
        ran = srgc("verify", *arguments)
        assert (ran.status, ran.out) == (2, "")
        assert ran.err.count("\n") == 1
    ran = srgc("verify", result("turner") / "design.json")
    assert ran.status == 2


def test_nothing_to_verify(srgc, tmp_path, result):
    ran = srgc("verify", tmp_path)
    assert ran.status == 4
    assert "nothing to verify" in ran.out
    folder = result("turner")
    (folder / "certificate.json").unlink()
    (folder / "certificate.json").mkdir()
    assert srgc("verify", folder).status == 4


def test_a_search_that_was_interrupted_goes_on(srgc, tmp_path):
    """`why` has nothing to say of it yet, so it is not the next step."""
    (tmp_path / "journal.jsonl").write_text("")
    ran = srgc("verify", tmp_path)
    assert ran.status == 4
    assert ran.out.endswith("next:    the `srgc synth` that began it goes on from there\n")
    (tmp_path / "design.json").write_text("{}")
    assert "next:    srgc why" in srgc("verify", tmp_path).out


def test_a_false_claim_is_refuted_with_its_reason(srgc, result):
    folder = result("turner")
    result_files.alter(folder, lambda c: c["inputs"][4].__setitem__(0, "10.5"), sign=True)
    ran = srgc("verify", folder)
    assert ran.status == 1
    assert ran.out.startswith("refuted: effort (N*m): violated at 0.8 s\n")


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"{}",
        b"[]",
        b"null",
        b"3",
        b'"text"',
        b"\xff\xfe\x00\x01",
        b"\x7fELF" + bytes(range(256)),
        b"{" * 100_000,
        b"[" * 100_000 + b"]" * 100_000,
        b'{"digest": ' + b"9" * 5000 + b"}",
        b'{"digest": "", "x": "\\ud800"}',
        b'{"digest": NaN}',
        b'{"digest": "", "digest": ""}',
        b"\xef\xbb\xbf{}",
    ],
)
def test_garbage_is_refused_in_one_line(srgc, result, content):
    folder = result("slider")
    (folder / "certificate.json").write_bytes(content)
    ran = srgc("verify", folder)
    assert (ran.status, ran.err) == (1, "")
    assert ran.out.startswith("refuted: the certificate ")
    _, last = ran.out.splitlines()
    assert last == "next:    do not rely on it; run `srgc synth` into another folder"


def test_a_certificate_cut_anywhere_is_refused(srgc, result):
    folder = result("slider")
    content = (folder / "certificate.json").read_bytes()
    for length in range(0, len(content.rstrip()), 97):
        (folder / "certificate.json").write_bytes(content[:length])
        assert srgc("verify", folder).status == 1


def test_layout_is_no_content(srgc, result):
    folder = result("slider")
    content = result_files.read(folder)
    shuffled = dict(sorted(content.items(), reverse=True))
    (folder / "certificate.json").write_text(json.dumps(shuffled, indent=7), encoding="utf-8")
    assert srgc("verify", folder).status == 0


def test_names_of_a_certificate_start_no_line(srgc, result):
    """What anybody may have written is shown in one line, without control characters."""
    folder = result("turner")
    result_files.alter(folder, lambda c: c.update(task="a\nvalid: found\x1b[31m"), sign=True)
    ran = srgc("verify", folder)
    assert ran.status == 1
    heads = [line.split(":")[0] for line in ran.out.splitlines()]
    assert heads == ["refuted", "task", "spec", "sha256", "next"]
    assert "\x1b" not in ran.out
    ran = srgc("verify", folder, "--task", "b\nvalid: found")
    assert ran.status == 6
    assert not any(line.startswith("valid") for line in ran.out.splitlines())


@pytest.mark.parametrize(("spec", "unit"), [("turner", "kg*m^2"), ("slider", "kg")])
def test_quantities_of_all_joints_have_their_one_unit(srgc, made, spec, unit):
    said = srgc("verify", made(spec) / "out").out
    assert re.search(rf"mass matrix positive definite  margin \S+ {re.escape(unit)}  at", said)
    assert "(SI)" not in said
    found = json.loads(srgc("verify", made(spec) / "out", "--json").out)["findings"]
    rates = "rad/s" if spec == "turner" else "m/s"
    assert {one["unit"] for one in found if "rates" in one["name"]} == {rates}
