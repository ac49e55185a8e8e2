"""Large specifications, as a plant with many cells would write them: valid, of any size."""

from __future__ import annotations

FORMULA_EVERY = 4
"""So many tasks have one formula: its check is a proof by a SAT solver, most of a task's time."""

_CELL = """\
// --- cell {n}: {product} ---

module Base{n} {{ role base; }}
module Shoulder{n} {{
  role joint;
  dof angle: revolute z in [-{turn}, {turn}] deg;
}}
module Elbow{n} {{
  role joint;
  param friction in [0.{friction}, 0.5] N*m*s/rad;
  dof angle: revolute z in [-150, 150] deg rate in [-2, 2] rad/s;
  torque(angle) = u - friction*rate(angle);
}}
module Slide{n} {{
  role joint;
  dof travel: prismatic x in [0, 0.{travel}] m;
}}
module Tube{n} {{
  role link;
  param length in [0.{short}, {long}] m;
  const diameter = {diameter} mm;
  const density = 2700 kg/m^3 * pi * (diameter/2)^2;
}}
module Bracket{n} {{
  role link;
  param offset in {{5, 10, {offset}}} cm;
  const mass = 0.{mass} kg;
}}
module {tool}{n} {{ role effector; const mass = 350 g; }}

/* The arm of cell {n}: a base, then joints and links in any order,
   and one tool at the end. */
grammar Arm{n} {{
  start Robot{n};
  whole:    Robot{n} -> Chain{n} flange {tool}{n};
  base:     Chain{n} -> Base{n};
  shoulder: Chain{n} -> Chain{n} flange Shoulder{n};
  elbow:    Chain{n} -> Chain{n} flange Elbow{n};
  slide:    Chain{n} -> Chain{n} flange Slide{n};
  tube:     Chain{n} -> Chain{n} flange Tube{n};
  bracket:  Chain{n} -> Chain{n} flange Bracket{n};
  accept starts with Base{n} flange Shoulder{n} and count(Slide{n}) <= 1;
  accept not contains Bracket{n} flange Bracket{n};
}}

semantics Arm{n} {{
  whole    {{ this.frame = Chain{n}.frame; point(frame: this.frame, mass: {tool}{n}.mass);
             effector(frame: this.frame); }}
  base     {{ this.frame = world; }}
  shoulder {{ this.frame = Chain{n}.frame * rot(z, Shoulder{n}.angle); }}
  elbow    {{ this.frame = Chain{n}.frame * rot(z, Elbow{n}.angle); }}
  slide    {{ this.frame = Chain{n}.frame * move(x, Slide{n}.travel); }}
  tube     {{
    this.frame = Chain{n}.frame * move(x, Tube{n}.length);
    rod(frame: Chain{n}.frame, axis: x, length: Tube{n}.length, density: Tube{n}.density);
  }}
  bracket  {{
    this.frame = Chain{n}.frame * move((0, Bracket{n}.offset, 0)) * rot(z, 90 deg);
    point(frame: this.frame, mass: Bracket{n}.mass);
  }}
}}

workspace Hall{n} {{
  plane xy;
  bounds box [0, 6] x [0, {depth}] m;
  region Rack box [0.{rack}, 1.2] x [1, 1.4] m;          // where {product} come in
  region Aisle polytope {{ x >= 1.5; y >= 0.2; 2*x + y <= 4.5; }} m;
  obstacle Pillar polytope {{ -x <= -1.7; x <= 3; -y <= -2; y <= 3; }} m;
  obstacle Press hull (4.5, 0), (5.5, 0), (5.5, 1), (5, 1.{press}), (4.5, 1) m;
  target Tray box [3.5, 4.2] x [3.8, 4.5] m;             // and where they go
}}

task Feed{n} {{
  robot Arm{n};
  workspace Hall{n};
  start in Rack at rest;
  reach Tray at rest;
  avoid Pillar, Press with body, margin 2 cm;
  effort <= {effort} N*m;
  effort <= 200 N;
  horizon {steps} steps of 0.125 s;
  gravity (0, -9.81) m/s^2;
  modules <= 9;
{aisle}
}}

"""
_VISITED = "  satisfy eventually[0 s, 5 s] Aisle;"
_AVOIDED = "  avoid Aisle with effector;"
_PRODUCTS = ("bearing shells", "gear wheels", "valve bodies", "axle stubs", "cover plates")
_TOOLS = ("Gripper", "Suction", "Magnet")


def _cell(n: int) -> str:
    return _CELL.format(
        n=n,
        product=_PRODUCTS[n % 5],
        tool=_TOOLS[n % 3],
        turn=150 + n % 30,
        friction=1 + n % 4,
        travel=3 + n % 6,
        short=3 + n % 7,
        long=2 + n % 4,
        diameter=40 + n % 50,
        offset=15 + n % 6,
        mass=2 + n % 7,
        depth=5 + n % 2,
        rack=6 + n % 4,
        press=1 + n % 5,
        effort=10 + n % 90,
        steps=60 + n % 40,
        aisle=_AVOIDED if n % FORMULA_EVERY else _VISITED,
    )


def large_spec(size: int) -> str:
    """A specification without errors of at least ``size`` bytes, and less than a cell more."""
    parts = ["edge flange;\n\n"]
    length = len(parts[0])
    while length < size:
        parts.append(_cell(len(parts)))
        length += len(parts[-1])
    return "".join(parts)
