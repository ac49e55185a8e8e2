"""A small arm in space whose joints and links differ, quick to synthesise."""

from __future__ import annotations

SPATIAL = """\
// Two joints about z and y, links of different lengths along x, a turn between them, in space.
module B { role base; }
module Z { role joint; dof q: revolute z in [-150, 150] deg; }
module Y { role joint; dof q: revolute y in [-110, 110] deg rate in [-5, 5]; }
module L { role link; param length in [40, 70] cm; const mass = 1.5 kg; }
module S { role link; param length in [0.2, 0.35] m; const mass = 0.7 kg; }
module EN { role effector; const mass = 100 g; }
edge eps;

grammar Spatial {
  start N;
  base: N -> B;
  waist: N -> N eps Z;
  shoulder: N -> N eps Y;
  long: N -> N eps L;
  short: N -> N eps S;
  tool: N -> N eps EN;
  accept matches B eps Z eps L eps Y eps S eps EN;
}

semantics Spatial {
  base { this.frame = world * move(z, 0.3 m); }
  waist { this.frame = N.frame * rot(z, Z.q); }
  shoulder { this.frame = N.frame * rot(y, Y.q); }
  long {
    this.frame = N.frame * move(x, L.length) * rot(x, 30 deg);
    solid(frame: N.frame, mass: L.mass, com: (L.length / 2, 0, 0),
        inertia: (0.01 kg*m^2, 0.04 kg*m^2, 0.045 kg*m^2, 0, 0, 0));
  }
  short {
    this.frame = N.frame * move(x, S.length);
    solid(frame: N.frame, mass: S.mass, com: (S.length / 3, 0.02 m, 0),
        inertia: (0.004 kg*m^2, 0.009 kg*m^2, 0.01 kg*m^2, 0, 0, 0));
  }
  tool { this.frame = N.frame; point(frame: N.frame, mass: EN.mass); effector(frame: N.frame); }
}

workspace Room {
  space xyz;
  bounds box [-1.2, 1.2] x [-1.2, 1.2] x [-0.5, 1.2] m;
  region Tray box [0.6, 0.95] x [-0.2, 0.15] x [0.2, 0.5] m;
  obstacle Post box [0.2, 0.3] x [0.9, 1] x [0, 0.4] m;
  target Shelf box [-0.1, 0.35] x [0.5, 0.8] x [0.3, 0.6] m;
}

task Lift {
  robot Spatial;
  workspace Room;
  start in Tray at rest;
  reach Shelf;
  avoid Post with effector margin 1 cm;
  gravity (0, 0.5, -1.5) m/s^2;
  effort <= 12 N*m;
  horizon 8 steps of 0.1 s;
}
"""
