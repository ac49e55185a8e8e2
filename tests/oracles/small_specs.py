"""Small specs, quick to synthesise."""

from __future__ import annotations

TURNER = """\
module B  { role base; }
module JO { role joint; dof q: revolute z in [-180, 180] deg; }
module L  { role link; param length in [1, 2] m; const density = 1 kg/m; }
module EN { role effector; }
edge eps;

grammar Turner {
  start N;
  base:  N -> B;
  joint: N -> N eps JO;
  link:  N -> N eps L;
  tool:  N -> N eps EN;
  accept contains EN and starts with B eps JO;
}

semantics Turner {
  base  { this.frame = world; }
  joint { this.frame = N.frame * rot(z, JO.q); }
  link  { this.frame = N.frame * move(x, L.length);
          rod(frame: N.frame, axis: x, length: L.length, density: L.density); }
  tool  { this.frame = N.frame; effector(frame: N.frame); }
}

workspace Table {
  plane xy;
  bounds box [-1, 3] x [-1, 3] m;
  region S box [1.2, 1.9] x [-0.3, 0.3] m;
  obstacle O box [1.4, 2.5] x [1.4, 2.5] m;
  target T box [-0.3, 0.3] x [1.2, 1.9] m;
}

task Turn {
  robot Turner;
  workspace Table;
  start in S at rest;
  reach T;
  avoid O with effector;
  effort <= 10 N*m;
  horizon 10 steps of 0.2 s;
}
"""
"""One link of free length that turns by a right angle; nothing is in its way."""

MOTOR = (
    TURNER.replace(
        "module JO { role joint; dof q: revolute z in [-180, 180] deg; }",
        "module M { role joint; dof q: revolute z in [-180, 180] deg;\n"
        "  state current A; input voltage in [-24, 24] V;\n"
        "  der(current) = (voltage - 1.5 V/A * current - 0.8 V*s * rate(q)) / (0.3 V*s/A);\n"
        "  torque(q) = 0.8 N*m/A * current; }",
    )
    .replace("JO", "M")
    .replace("  effort <= 10 N*m;\n", "")
)
"""The same with a motor, which is the only thing that is driven."""

SLIDER = """\
module B  { role base; }
module P  { role joint; dof q: prismatic x in [0, 3] m; }
module M  { role link; const mass = 1 kg; }
module EN { role effector; }
edge eps;

grammar Slider {
  start N;
  base:  N -> B;
  slide: N -> N eps P;
  load:  N -> N eps M;
  tool:  N -> N eps EN;
  accept matches B eps P eps M eps EN;
}

semantics Slider {
  base  { this.frame = world; }
  slide { this.frame = N.frame * move(x, P.q); }
  load  { this.frame = N.frame; point(frame: N.frame, mass: M.mass); }
  tool  { this.frame = N.frame; effector(frame: N.frame); }
}

workspace Rail {
  plane xy;
  bounds box [-1, 4] x [-1, 1] m;
  region S box [0.1, 0.5] x [-0.2, 0.2] m;
  target T box [2, 2.5] x [-0.2, 0.2] m;
}

task Slide {
  robot Slider;
  workspace Rail;
  start in S;
  reach T;
  effort <= 10 N;
  horizon 10 steps of 0.2 s;
}
"""
"""A mass on a rail: the quickest spec that is found."""


def replaced(text: str, old: str, new: str) -> str:
    """The text with the one occurrence of ``old`` replaced."""
    assert text.count(old) == 1, (old, text.count(old))
    return text.replace(old, new)


BEYOND_REACH = replaced(
    replaced(
        replaced(
            TURNER,
            "region S box [1.2, 1.9] x [-0.3, 0.3] m;",
            "region S box [0.5, 0.8] x [-0.2, 0.2] m;",
        ),
        "target T box [-0.3, 0.3] x [1.2, 1.9] m;",
        "target T box [-0.3, 0.3] x [1.6, 1.9] m;",
    ),
    "  horizon 10",
    "  modules <= 4;\n  horizon 10",
)
"""Start and target at different distances from the joint: no robot of four modules can."""

GOOD_AS_IT_IS = replaced(
    TURNER,
    "  horizon 10",
    "  from B eps JO eps L eps EN fixed L.length = 150 cm;\n  horizon 10",
)
"""The turner's task, for a robot that there is and that can do it."""

WITHOUT_LINK = replaced(TURNER, "  horizon 10", "  from B eps JO eps EN;\n  horizon 10")
"""The same for a robot that has yet to get a link."""

TOO_SHORT = replaced(
    TURNER,
    "  horizon 10",
    "  modules <= 4;\n  from B eps JO eps L eps EN fixed L.length = 1 m;\n  horizon 10",
)
"""The same for a robot whose only link keeps a length with which it does not get there."""

CLOSED = replaced(
    TURNER,
    "  effort <= 10 N*m;\n",
    "  effort <= 10 N*m;\n"
    "  control feedback;\n"
    "  robust start 0.5 deg, 0.5 deg/s;\n"
    "  robust effort 1 % of bound;\n"
    "  robust measure 0.05 deg, 0.1 deg/s;\n"
    "  robust mass 2 %;\n",
)
"""The link with a controller, and with all kinds of disturbances."""

PLOTTER = """\
module PrecisionTurntableWithEncoder { role base; }
module ContinuousRotaryActuator { role joint; dof q: revolute z in [-180, 180] deg; }
module CarbonFibreForearmWithTwoHolders { role link; const reach = 1 m; const density = 1 kg/m; }
module FineLinerPenWithSpringLoadedTip { role effector; }
edge eps, '[', ']';

grammar Plotter {
  start Robot;
  whole: Robot -> PrecisionTurntableWithEncoder eps ContinuousRotaryActuator
         eps CarbonFibreForearmWithTwoHolders '[' inner:Pen ']' '[' outer:Pen ']';
  pen: Pen -> FineLinerPenWithSpringLoadedTip;
}

semantics Plotter {
  whole {
    this.turned = this.frame * rot(z, ContinuousRotaryActuator.q);
    rod(frame: this.turned, axis: x, length: CarbonFibreForearmWithTwoHolders.reach,
        density: CarbonFibreForearmWithTwoHolders.density);
    inner.at = this.turned * move(x, 0.7 m);
    outer.at = this.turned * move(x, CarbonFibreForearmWithTwoHolders.reach);
  }
  pen { effector(frame: this.at); }
}

workspace Sheet {
  plane xy;
  bounds box [-0.4, 1.2] x [-0.4, 1.2] m;
  region Ink box [0.58, 0.8] x [-0.1, 0.12] m;
  region Blotter box [0.86, 1.1] x [0.05, 0.2] m;
  target Page box [-0.15, 0.12] x [0.6, 0.78] m;
}

task Write {
  robot Plotter;
  workspace Sheet;
  start in Ink by effector 1 at rest;
  reach Page by effector 1;
  effort <= 10 N*m;
  horizon 10 steps of 0.2 s;
}
"""
"""Two effectors, the first of which is on the names of the regions that it leaves and reaches;
the names of the modules are long words."""

PAIR = """\
module B { role base; }
module J { role joint; dof q: revolute z in [-170, 170] deg rate in [-3, 3] rad/s; }
module L { role link; const length = 1.3 m; const density = 1 kg/m; }
module K { role link; const length = 0.9 m; const density = 1.5 kg/m; }
module E { role effector; }
edge eps;
grammar Pair {
  start N;
  base: N -> B; turn: N -> N eps J; upper: N -> N eps L; fore: N -> N eps K; hand: N -> N eps E;
  accept matches B eps J eps L eps J eps K eps E;
}
semantics Pair {
  base { this.frame = world; }
  turn { this.frame = N.frame * rot(z, J.q); }
  upper { this.frame = N.frame * move(x, L.length);
          rod(frame: N.frame, axis: x, length: L.length, density: L.density); }
  fore { this.frame = N.frame * move(x, K.length);
         rod(frame: N.frame, axis: x, length: K.length, density: K.density); }
  hand { this.frame = N.frame; effector(frame: N.frame); }
}
workspace Table {
  plane xy;
  bounds box [-3, 3] x [-3, 3] m;
  region S box [1.4, 1.7] x [1.1, 1.4] m;
  obstacle O box [1.2, 1.5] x [1.9, 2.2] m;
  target T polytope { 3*x + 4*y <= 10.3; 3*x + 4*y >= 7; 4*x - 3*y <= -2.1; 4*x - 3*y >= -5.4; } m;
}
task Turn {
  robot Pair;
  workspace Table;
  start in S at rest;
  reach T rates <= 0.5 rad/s;
  avoid O with effector;
  effort <= 10 N*m;
  horizon 12 steps of 0.1 s;
  control feedback;
  robust start 0.2 deg, 0.2 deg/s;
  robust effort 0.3 % of bound;
  robust measure 0.02 deg, 0.05 deg/s;
  robust mass 0.1 %;
  robust mass 0.2 % of L;
}
"""
"""Two links of 1.3 m and 0.9 m with a controller and all kinds of disturbances."""

LOOPED = replaced(
    replaced(
        SLIDER,
        "  reach T;\n",
        "  satisfy always (eventually T and eventually S);\n  repeat;\n"
        "  robust start 1 mm, 1 mm/s;\n  robust effort 1 % of bound;\n",
    ),
    "horizon 10 steps",
    "horizon 16 steps",
)
"""The mass goes to and fro for ever."""

WINDING = (
    TURNER.replace(" in [-180, 180] deg; }", "; }")
    .replace(
        "accept contains EN and starts with B eps JO;", "accept matches B eps JO eps L eps EN;"
    )
    .replace("bounds box [-1, 3] x [-1, 3] m;", "bounds box [-3, 3] x [-3, 3] m;")
    .replace(
        "  obstacle O box [1.4, 2.5] x [1.4, 2.5] m;\n",
        "  region W box [-1.9, -1.2] x [-0.3, 0.3] m;\n"
        "  region D box [-0.3, 0.3] x [-1.9, -1.2] m;\n"
        "  obstacle O polytope { 3*x + 4*y <= 3; 3*x + 4*y >= -3; 4*x - 3*y <= 3;"
        " 4*x - 3*y >= -3; } m;\n",
    )
    .replace(
        "  reach T;\n",
        "  satisfy always (eventually T and eventually W and eventually D and eventually S);\n"
        "  repeat;\n  robust start 0.2 deg, 0.2 deg/s;\n  robust effort 0.3 % of bound;\n",
    )
    .replace("horizon 10 steps of 0.2 s", "horizon 40 steps of 0.1 s")
)
"""One link that visits four regions about its base for ever: a joint without range winds."""

QUICK_TURN = """
module Foot { role base; port out: F; frame out = in; }
module Hip { role joint; dof q: revolute z in [-170, 170] deg rate in [-1, 1] rad/s;
  port in: F; port out: G; frame out = in * rot(z, q); }
module Tip { role effector; port in: G; point(frame: in * move(x, 0.5 m), mass: 1 kg);
  effector(frame: in * move(x, 0.5 m)); }
grammar Arm from ports { start Foot; with Hip, Tip; }
workspace W { plane xy; bounds box [-1, 1] x [-1, 1] m;
  region A box [0.45, 0.55] x [-0.05, 0.05] m; target B box [0.3, 0.45] x [0.3, 0.45] m; }
task Turn { robot Arm; workspace W; start in A at rest; reach B; effort <= 10 N*m;
  horizon 10 steps of 0.1 s; control feedback; modules <= 3; robust start 1 deg, 1 deg/s;
  robust measure 0.2 deg, 3 deg/s; robust effort 1 % of bound; }
"""
"""Errors of measurements change the rate by more than 0.2 rad/s, a tenth of its range."""
