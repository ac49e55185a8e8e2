"""Specifications made by Python against those that people have written: the same programs."""

from __future__ import annotations

import json
import pickle
from decimal import Decimal
from pathlib import Path

import numpy as np
import pytest

import srgc
from grammar_lang.diagnostics.diagnostic import Sink
from grammar_lang.formatting.formatter import canonical
from grammar_lang.parsing.parse import parse

ROOT = Path(__file__).parents[2]
SPECS = ROOT / "specs"


def planar_arm() -> srgc.Spec:
    """``specs/planar_arm.srg``: two links whose lengths differ."""
    modules = (
        srgc.Module("B", "base"),
        srgc.Module("JO", "joint").dof("q", "revolute", "z", between=("-180 deg", "180 deg")),
        srgc.Module("L", "link")
        .param("length", between=(0.5, 5), unit="m")
        .const("density", 1, "kg/m"),
        srgc.Module("EN", "effector"),
    )
    arm = (
        srgc.Grammar("PlanarArm", start="N")
        .production("base", "N -> B", "this.frame = world")
        .production("joint", "N -> N eps JO", "this.frame = N.frame * rot(z, JO.q);")
        .production(
            "link",
            "N -> N eps L",
            "this.frame = N.frame * move(x, L.length)",
            "rod(frame: N.frame, axis: x, length: L.length, density: L.density)",
        )
        .production("tool", "N -> N eps EN", "this.frame = N.frame", "effector(frame: N.frame)")
        .accept("contains EN and starts with B eps JO")
    )
    bench = (
        srgc.Workspace("Bench")
        .bounds(box=[(0, 5), ("0 m", "500 cm")])
        .region("S", box=[(0.8, 1.2), (1.0, 1.4)])
        .obstacle("O", polytope=["-x <= -1.7", "x <= 3", "-y <= -2", "y <= 3"])
        .target("T", box=[(3.5, 4.2), (3.8, 4.5)])
    )
    task = (
        srgc.Task("PickAndPlace", robot=arm, workspace=bench)
        .start_in("S")
        .reach("T")
        .avoid("O", subject="effector")
        .effort(10)
        .horizon(81, 0.125)
    )
    return srgc.Spec(*modules).edges("eps").add(arm, bench, task)


def l_shaped() -> srgc.Spec:
    """``specs/l_shaped.srg``: an arm in space of solids with gravity."""

    def cylinder(name: str) -> srgc.Module:
        return (
            srgc.Module(name, "link")
            .param("length", between=(10, 50), unit="cm")
            .const("radius", "2 cm")
            .const("mass", "2700 kg/m^3 * pi * radius^2 * length")
            .const("about_axis", "mass * radius^2 / 2")
            .const("across", "mass * (3 * radius^2 + length^2) / 12")
        )

    def solid(name: str, frame: str = "N.frame") -> str:
        return (
            f"solid(frame: {frame}, mass: {name}.mass, com: (0, 0, {name}.length / 2), "
            f"inertia: ({name}.across, {name}.across, {name}.about_axis, 0, 0, 0))"
        )

    joint = (
        srgc.Module("JO", "joint")
        .dof("q", "revolute", "z", between="[-170, 170] deg")
        .const("mass", 300, "g")
        .const("inertia", 5e-4, "kg*m^2")
    )
    half = "N.frame * move(z, LL.length) * rot(y, 90 deg)"
    family = (
        srgc.Grammar("Figure1", start="N")
        .production("base", "N -> B", "this.frame = world * move(z, B.height)")
        .production(
            "joint",
            "N -> N eps JO",
            "this.frame = N.frame * rot(z, JO.q)",
            "solid(frame: this.frame, mass: JO.mass, com: (0, 0, 0), "
            "inertia: (JO.inertia, JO.inertia, JO.inertia, 0, 0, 0))",
        )
        .production(
            "cylinder", "N -> N eps C", "this.frame = N.frame * move(z, C.length)", solid("C")
        )
        .production(
            "elbow",
            "N -> N eps LL",
            f"this.frame = {half} * move(z, LL.length)",
            solid("LL"),
            solid("LL", half),
        )
        .production(
            "tool",
            "N -> N eps EN",
            "this.frame = N.frame",
            "point(frame: N.frame, mass: EN.mass)",
            "effector(frame: N.frame)",
        )
        .accept("matches B eps JO eps LL (eps JO | eps C | eps LL)* eps EN")
    )
    room = (
        srgc.Workspace("Room", 3)
        .bounds(box=[(-1.5, 1.5), (-1.5, 1.5), (0, 2)])
        .region("Tray", "box [0.3, 0.5] x [0.1, 0.3] x [0.4, 0.6] m")
        .target("Shelf", box=[(-20, 0), (30, 50), (70, 90)], unit="cm")
        .obstacle("Post", box=[(0.1, 0.2), (0.4, 0.6), (0, 0.5)])
    )
    task = (
        srgc.Task("Lift", robot="Figure1", workspace="Room")
        .start_in("Tray")
        .reach("Shelf")
        .avoid("Post", subject="effector", margin="2 cm")
        .gravity((0, 0, -9.81))
        .effort("20 N*m")
        .horizon(20, "0.1 s")
        .modules(6)
    )
    effector = srgc.Module("EN", "effector").const("mass", "200 g")
    base = srgc.Module("B", "base").const("height", "30 cm")
    parts = srgc.Spec(base, joint, cylinder("C"), cylinder("LL"), effector, "edge eps;")
    return parts.add(family, room, task)


def serial_kit() -> srgc.Spec:
    """``specs/serial_kit.srg``: a grammar from the ports of a kit of the library."""
    arm = srgc.Grammar.from_ports(
        "Arm",
        start="Std_Plate",
        modules=["Std_Roll40", "Std_Drive40", "Std_Tube", "Std_Gripper"],
    ).accept(
        "count(Std_Drive40) == 2 and count(Std_Roll40) == 1 and not contains Std_Tube Std_Tube"
    )
    bench = (
        srgc.Workspace("Bench", dimension=3)
        .bounds(box=[(-0.8, 0.8), (-0.8, 0.8), (0, 1)])
        .region("Table", box=[(0.3, 0.45), (-0.1, 0.1), (0.2, 0.35)])
        .target("Shelf", box=[(-0.1, 0.1), (0.35, 0.5), (0.2, 0.4)])
        .obstacle("Post", box=[(0.2, 0.25), (0.2, 0.25), (0, 0.3)])
    )
    task = (
        srgc.Task("Serve", robot=arm, workspace=bench)
        .start_in("Table")
        .reach("Shelf", at_rest=True)
        .avoid("self", "Post", margin="5 mm")
        .gravity((0, 0, -9.81))
        .horizon(15, "0.1 s")
        .modules(7)
    )
    return srgc.Spec().include("serial.srg", std=True).add(arm, bench, task)


@pytest.mark.parametrize(
    "build", [planar_arm, l_shaped, serial_kit], ids=lambda each: each.__name__
)
def test_a_built_specification_is_the_program_that_is_written_by_hand(build):
    built, spec = srgc.load(build()).ir, build()
    written = srgc.load(SPECS / f"{build.__name__}.srg").ir
    for part in ("modules", "terminals", "grammars", "workspaces", "tasks", "missions"):
        assert getattr(built, part) == getattr(written, part), part
    text = spec.to_srg()
    assert text == str(spec) == canonical(text, Sink())
    sink = Sink()
    assert parse(text, sink).items == spec.items
    assert not sink.found
    assert srgc.check(spec).ok


def test_the_notebook_builds_the_specification_of_the_tutorial():
    book = json.loads((ROOT / "notebooks" / "tutorial_in_python.ipynb").read_text(encoding="utf-8"))
    sources = ["".join(cell["source"]) for cell in book["cells"] if cell["cell_type"] == "code"]
    [whole] = [place for place, source in enumerate(sources) if source.startswith("spec = ")]
    names: dict[str, object] = {}
    for source in sources[: whole + 1]:
        exec(source, names)
    built = srgc.load(names["spec"]).ir
    written = srgc.load(ROOT / "srgc" / "starters" / "planar.srg").ir
    for part in ("modules", "terminals", "grammars", "workspaces", "tasks"):
        assert getattr(built, part) == getattr(written, part), part


# --- quantities -----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("value", "unit", "written"),
    [
        (0.1, "m", "0.1 m"),
        (1 / 3, None, "0.3333333333333333"),
        (Decimal("1e-7"), "kg*m^2", "0.0000001 kg*m^2"),
        (np.float64(-2.5), "A", "-2.5 A"),
        (np.int64(3), None, "3"),
        ("2 * radius", None, "2 * radius"),
        ("0.50 m", None, "0.5 m"),
        ((0, 0, "4 cm"), "m", "(0 m, 0 m, 4 cm)"),
        ((0, 0, 4), "cm", "(0, 0, 4) cm"),
    ],
)
def test_quantities_are_texts_with_units_or_numbers(value, unit, written):
    module = srgc.Module("M", "link").const("k", value, unit)
    assert str(module) == f"module M {{ role link; const k = {written}; }}\n"


def test_all_statements_of_a_module():
    module = (
        srgc.Module("Motor", "joint")
        .named('the "main" motor')
        .param("length", choices=[0.6, "90 cm"], unit="m")
        .param("gain", choices=["60 cm", "90 cm"])
        .dof("q", "revolute", "-y", between=(-1, 1), rate="90 deg/s", accel=3, effort=12)
        .dof(
            "d",
            "prismatic",
            "x",
            between="[0, 60] cm",
            rate=(-1, 2),
            effort="40 N",
            named="slide-1",
        )
        .drive("q", gear=100, rotor=2e-5, viscous="0.5 N*m*s")
        .state("i", unit="A", initial=0)
        .input("v", between=(-12, 12), unit="V")
        .der("i", "v / 1 V*s/A")
        .torque("q", "i * 2 N*m/A")
        .port("in", "Flange", "male")
        .frame("turned", "in * rot(y, q)")
        .body("solid", frame="turned", mass="2 kg", com=(0, 0, 0.1), inertia=(1, 1, 1, 0, 0, 0))
        .body("visual", frame="in", file="motor.stl", scale="1 mm")
        .statement("port out: Flange; const price = 3;")
    )
    lines = [line.strip() for line in str(module).splitlines()]
    assert lines[1:-1] == [
        "role joint;",
        """named 'the "main" motor';""",
        "param length in {0.6 m, 90 cm};",
        "param gain in {60, 90} cm;",
        (
            "dof q: revolute -y in [-1, 1] rad rate in [-90, 90] deg/s accel <= 3 rad/s^2 "
            "effort <= 12 N*m;"
        ),
        'dof d: prismatic x in [0, 60] cm rate in [-1, 2] m/s effort <= 40 N named "slide-1";',
        "drive q: gear 100 rotor 0.00002 kg*m^2 viscous 0.5 N*m*s;",
        "state i A = 0 A;",
        "input v in [-12, 12] V;",
        "der(i) = v / 1 V*s/A;",
        "torque(q) = i * 2 N*m/A;",
        "port in: Flange male;",
        "frame turned = in * rot(y, q);",
        "solid(frame: turned, mass: 2 kg, com: (0, 0, 0.1), inertia: (1, 1, 1, 0, 0, 0));",
        'visual(frame: in, file: "motor.stl", scale: 1 mm);',
        "port out: Flange;",
        "const price = 3;",
    ]


def test_all_shapes_and_clauses():
    place = (
        srgc.Workspace("W", 3)
        .bounds("ball (0, 0, 0) m radius 2 m")
        .region("A", ball=(0, 0, 1), radius="10 cm")
        .obstacle("B", capsule=[(0, 0, 0), (0, 0, 1)], radius=5, unit="cm")
        .obstacle("C", hull=[(0, 0, 0), (1, 0, 0), (0, 1, 0), "(0, 0, 1) m"])
        .target("D", polytope=["x <= 1", "x >= 0"], unit="cm")
        .statement('obstacles from "hall.json" in mm;')
    )
    assert [line.strip() for line in str(place).splitlines()][1:-1] == [
        "space xyz;",
        "bounds ball (0, 0, 0) m radius 2 m;",
        "region A ball (0, 0, 1) m radius 10 cm;",
        "obstacle B capsule (0, 0, 0) cm, (0, 0, 1) cm radius 5 cm;",
        "obstacle C hull (0, 0, 0) m, (1, 0, 0) m, (0, 1, 0) m, (0, 0, 1) m;",
        "target D polytope { x <= 1; x >= 0; } cm;",
        'obstacles from "hall.json" in mm;',
    ]
    task = (
        srgc.Task("T", robot="R", workspace=place)
        .start_in("A", effector=2, held=True)
        .start_at(("30 deg", 0))
        .reach("D", poses="aligned z to (0, 0, -1) within 5 deg", rates=0.1, hold=2)
        .avoid("self", "B", margin=0.01, excepted=[("Hand", srgc.Module("Tube", "link"))])
        .effort(40, "N", norm=2)
        .horizon(10, 0.2, at_most=True)
        .payload(2)
        .satisfy("always not B until D")
        .control("feedback")
        .minimize("sum(price) within 5 %", "mass")
        .statement("robust mass 5 %; repeat;")
    )
    assert [line.strip() for line in str(task).splitlines()][3:-1] == [
        "start in A by effector 2 at rest held;",
        "start at (30 deg, 0);",
        "reach D aligned z to (0, 0, -1) within 5 deg rates <= 0.1 for 2 s;",
        "avoid self, B with body, margin 0.01 m, except Hand Tube;",
        "effort <= 40 N norm 2;",
        "horizon at most 10 steps of 0.2 s;",
        "payload 2 kg;",
        "satisfy always not B until D;",
        "control feedback;",
        "minimize sum(price) within 5 % then mass;",
        "robust mass 5 %;",
        "repeat;",
    ]


# --- values ---------------------------------------------------------------------------------------


def test_parts_are_values():
    link = srgc.Module("L", "link")
    longer = link.const("length", "1 m")
    assert str(link) == "module L { role link; }\n"
    assert link == srgc.Module("L", "link") != longer
    assert len({link, srgc.Module("L", "link"), longer}) == 2
    assert pickle.loads(pickle.dumps(longer)) == longer
    assert repr(longer) == "<Module: module L>"
    assert "<span" in longer._repr_html_()
    spec = srgc.Spec(link, "edge a;")
    assert spec.add(longer) == srgc.Spec(spec, longer)
    assert str(spec) == "module L { role link; }\nedge a;\n"


def test_a_block_is_written_for_every_production_or_for_none():
    bare = srgc.Grammar("G", start="S").production("a", "S -> A")
    assert "semantics" not in str(bare)
    full = bare.production("b", "S -> empty").production("c", "S -> '['", "this.frame = world")
    [semantics] = [item for item in full.items if hasattr(item, "blocks")]
    assert [block.label.text for block in semantics.blocks] == ["a", "b", "c"]


def test_a_specification_is_saved_and_checked(tmp_path):
    path = planar_arm().save(tmp_path / "arm.srg")
    assert path.read_text(encoding="utf-8") == str(planar_arm())
    assert srgc.check(path).ok
    assert srgc.words(planar_arm(), limit=1) == srgc.words(path, limit=1) == ["B eps JO eps EN"]
    assert srgc.plan(str(path)).paths == srgc.plan(planar_arm()).paths
    assert not srgc.check(srgc.Spec(srgc.Module("M", "link").const("k", "1 m + 1 s"))).ok


# --- faults ---------------------------------------------------------------------------------------

LINK = srgc.Module("L", "link")
GRAMMAR = srgc.Grammar("G", start="S")
PLACE = srgc.Workspace("W")
TASK = srgc.Task("T", robot=GRAMMAR, workspace=PLACE)


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda: srgc.Module("my link", "link"), "`name` is a name, not 'my link'"),
        (lambda: srgc.Module("L", 3), "`role` is a text, not 3"),
        (lambda: LINK.named("a\nb"), "`text` is a text on one line"),
        (lambda: LINK.const("k", "1 parsec"), "`value`: .*unknown unit `parsec`.*'1 parsec'"),
        (lambda: LINK.const("k", "1 m; const j = 2"), "`value` is one expression"),
        (lambda: LINK.const("k", "1; } module N { role link"), "`value` is one expression"),
        (lambda: LINK.const("k", float("nan")), "`value` is a finite number"),
        (lambda: LINK.const("k", True), "`value` is a finite number"),
        (lambda: LINK.const("k", 1, "parsec"), "`unit`: "),
        (lambda: LINK.const("k", 1, ""), '`unit` is a unit, as "m/s"'),
        (lambda: LINK.param("p"), "give `between` or `choices`"),
        (lambda: LINK.param("p", between=3), "`between` is a lowest and a highest value"),
        (lambda: LINK.param("p", between="{1, 2} m"), "`between` is a lowest and a highest"),
        (lambda: LINK.param("p", choices=0.5), "`choices` is values in a list"),
        (lambda: LINK.dof("q", "round", "z"), '`kind` is "revolute" or "prismatic"'),
        (lambda: LINK.dof("q", "revolute", "w"), "`axis` is one of x, y, z"),
        (lambda: LINK.dof("q", "revolute", "z", rate="fast!"), "`rate`: "),
        (lambda: LINK.drive("q"), "give one of `gear`"),
        (lambda: LINK.port("in", "F", "neuter"), '`gender` is "male", "female"'),
        (lambda: LINK.body("rod", mass=[1]), "`mass` is a finite number"),
        (lambda: LINK.statement("rod"), "`text`: "),
        (lambda: GRAMMAR.production("p", "S to A"), "`rule`: "),
        (lambda: GRAMMAR.production("p", "S -> A", "frame = world"), "`statements`: "),
        (lambda: GRAMMAR.production("p", "S -> A", 3), "`statements` is a text, not 3"),
        (lambda: GRAMMAR.accept("count(A) about 3"), "`condition`: "),
        (lambda: srgc.Grammar.from_ports("G", start="A", modules="B"), "`modules` are modules or"),
        (lambda: PLACE.target("T", box=[(0, 1)], hull=[(0, 0)]), "give one shape"),
        (lambda: PLACE.target("T", box=[1, 2]), "`box` is a lowest and a highest value"),
        (lambda: PLACE.target("T", ball=(0, 0)), "`radius`: a ball has one"),
        (lambda: PLACE.target("T", sphere=(0, 0)), "no argument `sphere`"),
        (lambda: PLACE.target("T", "cube [0, 1] m"), "`shape`: "),
        (lambda: srgc.Workspace("W", 4), "`dimension` is 2 or 3"),
        (lambda: TASK.reach("T", hold=1), "`hold` goes with `at_rest` or `rates`"),
        (lambda: TASK.reach("T", poses="at rest"), "`poses` are poses of an effector alone"),
        (TASK.avoid, "`regions` are one or more"),
        (lambda: TASK.avoid("O", subject="hand"), '`subject` is "body" or "effector"'),
        (lambda: TASK.horizon(0, 1), "`steps` is a whole number from 1 on"),
        (lambda: TASK.modules(2.5), "`most` is a whole number|`most` is"),
        (lambda: TASK.satisfy("always"), "`formula`: "),
        (lambda: TASK.minimize("mass then time"), "`objectives`: each is an objective"),
        (lambda: TASK.control("closed"), '`loop` is "feedback" or "open loop"'),
        (lambda: TASK.gravity(9.81), "`vector` is coordinates"),
        (lambda: srgc.Spec(3), "`parts` are parts of a specification"),
        (lambda: srgc.Spec("modul L {}"), "`parts`: "),
        (lambda: srgc.Spec().edges("'\""), "`names` are symbols"),
        (lambda: srgc.Spec().include(""), "`path` is the path of a file"),
    ],
)
def test_faults_name_the_argument(call, said):
    with pytest.raises(srgc.SrgcError, match=said) as caught:
        call()
    assert caught.value.__cause__ is None
