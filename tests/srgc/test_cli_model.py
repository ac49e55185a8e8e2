from __future__ import annotations

import re

import pytest

from tests.oracles.small_specs import TURNER

TWO = "B eps JO eps L eps JO eps L eps EN"
STIFF = """\
  stiff { this.frame = N.frame * move(x, 2 * L.length); point(frame: this.frame, mass: 3); }
  tool  { this"""
TWIN = TURNER.replace("  tool:  N", "  stiff: N -> N eps L;\n  tool:  N").replace(
    "  tool  { this", STIFF
)
"""A link may be twice as long, too: a word with a link has two derivations."""


def sections(text: str) -> dict[str, list[str]]:
    found = re.findall(r"^(.+)\n-+\n((?:.+\n)*)", text, re.MULTILINE)
    return {title: body.splitlines() for title, body in found}


def test_the_two_link_arm(srgc, arm_file):
    """Correction 4.6 on the command line."""
    ran = srgc("model", arm_file, "--word", TWO, "--task", "PickAndPlace")
    assert (ran.status, ran.err) == (0, "")
    found = sections(ran.out)
    assert found["Mass matrix M"][1:] == [
        "M11 = l1^3/3 + l1^2*l2 + l2^3/3 + l1*l2^2*cos(q2)",
        "M12 = l2^3/3 + l1*l2^2*cos(q2)/2",
        "M22 = l2^3/3",
    ]
    assert found["Centrifugal and Coriolis forces c"] == [
        "c1 = -l1*l2^2*qd2*(2*qd1 + qd2)*sin(q2)/2",
        "c2 = l1*l2^2*qd1^2*sin(q2)/2",
    ]
    assert found["Positions of the effectors, in m"] == [
        "e1_x = l1*cos(q1) + l2*cos(q1 + q2)",
        "e1_y = l1*sin(q1) + l2*sin(q1 + q2)",
    ]
    assert found["Parameters"] == [
        "l1  length of L at 4  in [0.5, 5] m",
        "l2  length of L at 8  in [0.5, 5] m",
    ]
    assert found["Inputs"][1] == "u2  free input of q2, JO at 6  in [-10, 10] N*m"
    assert found["Coordinates"][0].startswith("q1  revolute z, JO at 2  in [-180, 180] deg")
    assert found["Equations of motion"][0] == "M(q)*qdd + c(q, qd) + g(q) = tau"


def test_merged_and_removed_joints_are_said(srgc, arm_file):
    word = "B eps JO eps JO eps L eps JO eps EN"
    found = sections(srgc("model", arm_file, "--word", word).out)
    assert found["Coordinates"] == [
        "q1  revolute z, JO at 2 and JO at 4 merged  in [-360, 360] deg, rate unbounded",
        "removed, since it moves nothing: JO at 8",
    ]


def test_dry_friction_is_said(srgc, arm_file, tmp_path):
    text = arm_file.read_text(encoding="utf-8")
    spec = tmp_path / "rubs.srg"
    driven = text.replace("[-180, 180] deg;", "[-180, 180] deg; drive q: coulomb 1.5 N*m;")
    spec.write_text(driven, encoding="utf-8")
    found = sections(srgc("model", spec, "--word", TWO).out)
    assert found["Coordinates"][1].endswith("rate unbounded, dry friction 1.5 N*m")
    assert found["Equations of motion"][-1] == (
        "less dry friction at q2: 1.5 N*m against qd2, less at rest"
    )


def test_gravity_and_bounds_are_those_of_the_task(srgc, spec):
    path = spec(TURNER.replace("reach T;", "reach T;\n  gravity (1, -9.81) m/s^2;"))
    word = "B eps JO eps L eps EN"
    without = srgc("model", path, "--word", word)
    assert "gravity             none, since no task is chosen" in without.out
    assert sections(without.out)["Gravitational forces g"] == ["none: g = 0"]
    assert sections(without.out)["Inputs"] == [
        "u1  free input of q1, JO at 2  in N*m, bounded by a task"
    ]
    ran = srgc("model", path, "--word", word, "--task", "Turn")
    assert sections(ran.out)["Gravitational forces g"] == [
        "for gravity (1, -9.81) m/s^2",
        "g1 = 4.905*l1^2*cos(q1) + l1^2*sin(q1)/2",
    ]
    norm = spec(TURNER.replace("effort <= 10 N*m", "effort <= 10 N*m norm 2"), "norm.srg")
    ran = srgc("model", norm, "--word", word, "--task", "Turn")
    assert sections(ran.out)["Inputs"] == [
        "u1  free input of q1, JO at 2  in N*m",
        "the Euclidean norm of the revolute free inputs is at most 10",
    ]


def test_every_kind_of_joint_has_its_bound(srgc, arm_file):
    word = "B eps R eps P eps L eps EN"
    ran = srgc("model", arm_file.parent / "prismatic.srg", "--word", word, "--task", "Store")
    assert sections(ran.out)["Inputs"] == [
        "u1  free input of q1, R at 2  in [-20, 20] N*m",
        "u2  free input of q2, P at 4  in [-40, 40] N",
    ]
    assert sections(ran.out)["Coordinates"][1].endswith("in [0, 0.6] m, rate in [-1.5, 1.5] m/s")


def test_modules_with_dynamics_of_their_own(srgc, arm_file):
    word = "B eps M eps L eps JO eps L eps EN"
    ran = srgc("model", arm_file.parent / "motor_arm.srg", "--word", word, "--task", "Sort")
    found = sections(ran.out)
    assert found["Inputs"] == [
        "u1  voltage of M at 2          in [-24, 24] V",
        "u2  free input of q2, JO at 6  in [-6, 6] N*m",
    ]
    assert found["Dynamics of the modules"] == [
        "s1  state current of M at 2  starts at 0 A",
        "M at 2: q is q1, voltage is u1, current is s1",
        "  current' = (voltage - 1.5 * current - 0.8 * rate(q)) / 0.3",
        "  torque(q) = 0.8 * current",
        "JO at 6: q is q2, u is u2",
        "  torque(q) = u - 0.3 * rate(q)",
    ]
    assert found["Equations of motion"][1:] == [
        "tau1 = torque(q) of M at 2",
        "tau2 = torque(q) of JO at 6",
    ]
    assert "in [-4, 4] rad/s" in found["Coordinates"][0]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--word", "B eps X"], "error: `X` is not a symbol of the words\n"),
        (["--word", "B eps L eps EN"], "error: the word `B eps L eps EN` is not accepted\n"),
        (["--word", ""], "error: the empty word is not accepted\n"),
        (["--word", TWO, "--derivation", "2"],
         "error: the word has 1 derivation: there is no --derivation 2\n"),
        (["--word", TWO, "--grammar", "Nope"],
         "error: there is no grammar `Nope`; the file has: PlanarArm\n"),
        (["--word", TWO, "--task", "Nope"],
         "error: there is no task `Nope`; the file has: PickAndPlace\n"),
        (["--word", TWO, "--workspace", "Nope"],
         "error: there is no workspace `Nope`; the file has: Bench\n"),
    ],
)  # fmt: skip
def test_wrong_choices(srgc, arm_file, arguments, message):
    ran = srgc("model", arm_file, *arguments)
    assert (ran.status, ran.out, ran.err) == (2, "", message)


def test_missing_and_wrong_options(srgc, arm_file, spec, tmp_path):
    assert srgc("model", arm_file).status == 2
    assert srgc("model", arm_file, "--word", TWO, "--format", "pdf").status == 2
    assert srgc("model", arm_file, "--word", TWO, "--derivation", "0").status == 2
    ran = srgc("model", arm_file, "--word", TWO, "-o", tmp_path / "no" / "model.tex")
    assert (ran.status, ran.out, ran.err.count("\n")) == (2, "", 1)
    assert srgc("model", spec("module {"), "--word", "B").status == 5


def test_an_ambiguous_word(srgc, spec):
    path, word = spec(TWIN), "B eps JO eps L eps EN"
    first = srgc("model", path, "--word", word)
    assert first.status == 0
    assert first.err == "note: the word has several derivations: --derivation 2 shows the next\n"
    assert "e1_x = l1*cos(q1)" in first.out
    second = srgc("model", path, "--word", word, "--derivation", "2")
    assert (second.status, second.err) == (0, "")
    assert "e1_x = 2*l1*cos(q1)" in second.out
    assert "M11 = 12*l1^2" in second.out
    third = srgc("model", path, "--word", word, "--derivation", "3")
    assert third.status == 2
    assert third.err == "error: the word has 2 derivations: there is no --derivation 3\n"


def test_a_nonterminal_that_derives_itself(srgc, spec):
    path = spec(TURNER.replace("  base:  N", "  again: N -> N;\n  base:  N").replace(
        "semantics Turner {", "semantics Turner {\n  again { this.frame = N.frame; }"
    ))  # fmt: skip
    ran = srgc("model", path, "--word", "B eps JO eps L eps EN")
    assert ran.status == 0
    assert ran.err == "note: a nonterminal of the grammar derives itself: one derivation is shown\n"


def test_a_robot_without_joints(srgc, spec):
    path = spec(TURNER.replace(" and starts with B eps JO", ""))
    ran = srgc("model", path, "--word", "B eps L eps EN")
    found = sections(ran.out)
    assert found["Coordinates"] == ["none: the robot is rigid"]
    assert found["Equations of motion"] == ["none"]
    assert found["Positions of the effectors, in m"] == ["e1_x = l1", "e1_y = 0"]
    assert "Mass matrix M" not in found
    assert srgc("model", path, "--word", "B eps L eps EN", "--format", "smt2").status == 0
    assert srgc("model", path, "--word", "B eps L eps EN", "--format", "latex").status == 0


def test_a_family_without_semantics(srgc, spec):
    path = spec("module B { role base; } grammar G { start N; base: N -> B; }")
    ran = srgc("model", path, "--word", "B")
    assert (ran.status, ran.out, ran.err.count("\n")) == (2, "", 1)


def test_a_robot_that_is_not_defined(srgc, spec):
    path = spec(
        TURNER.replace("move(x, L.length)", "move(x, (1 m) * (1 / (L.length / L.length - 1)))")
    )
    for form in ("text", "latex", "smt2"):
        ran = srgc("model", path, "--word", "B eps JO eps L eps EN", "--format", form)
        assert (ran.status, ran.out) == (2, "")
        assert ran.err.startswith("error: a divisor in the rules is zero: ")


def test_the_plane_or_space(srgc, spec):
    """By the workspaces; without any, in the plane if the robot stays there."""
    word = ("--word", "B eps JO eps L eps EN")
    families = TURNER[: TURNER.index("workspace")]
    plane = srgc("model", spec(families), *word).out
    assert "moves in            the plane" in plane
    tilted = families.replace("dof q: revolute z", "dof q: revolute y").replace(
        "rot(z, JO.q)", "rot(y, JO.q)"
    )
    space = srgc("model", spec(tilted, "tilted.srg"), *word).out
    assert "moves in            space" in space
    assert "e1_z = -l1*sin(q1)" in space
    hall = "workspace Hall { space xyz; bounds box [0, 1] x [0, 1] x [0, 1] m; }\n"
    both = spec(
        families + hall + TURNER[TURNER.index("workspace") : TURNER.index("task")], "both.srg"
    )
    refused = srgc("model", both, *word)
    assert refused.status == 2
    assert "--workspace" in refused.err
    assert "e1_z = 0" in srgc("model", both, *word, "--workspace", "Hall").out
    assert "e1_z" not in srgc("model", both, *word, "--workspace", "Table").out


def test_formats_and_files(srgc, arm_file, tmp_path):
    for form in ("text", "latex", "smt2"):
        ran = srgc("model", arm_file, "--word", TWO, "--format", form)
        assert (ran.status, ran.err) == (0, "")
        target = tmp_path / f"model.{form}"
        quiet = srgc("model", arm_file, "--word", TWO, "--format", form, "-o", target)
        assert (quiet.status, quiet.out) == (0, "")
        assert target.read_text(encoding="utf-8") == ran.out
    latex = (tmp_path / "model.latex").read_text(encoding="utf-8")
    assert r"M_{22} &= \frac{\ell_{2}^{3}}{3}" in latex
    script = (tmp_path / "model.smt2").read_text(encoding="utf-8")
    assert script.startswith("(set-logic QF_NRA)\n")
    assert "(define-fun M_1_2 () Real " in script


def test_equations_of_many_degrees_of_freedom_are_left_out(srgc, spec):
    long = "B" + " eps JO eps L" * 9 + " eps EN"
    path = spec(TURNER)
    short = srgc("model", path, "--word", long)
    assert "left out for 9 degrees of freedom: --whole writes them" in short.out
    assert "M11" not in short.out
    assert "positive definite" in short.out
    assert "M11" in srgc("model", path, "--word", long, "--whole").out
