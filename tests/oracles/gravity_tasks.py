"""Tasks under gravity that unstable motions fulfil; feasible by construction."""

from __future__ import annotations

PLANAR = """\
module Base { role base; }
module Limb { role link; dof q: revolute z in [-150, 150] deg; param length in [0.319, 0.629] m; }
module Hand { role effector; }
grammar Arm { start Robot; hand: Robot -> Limbs Hand;
  limb: Limbs -> Limbs Limb; base: Limbs -> Base; accept count(Limb) == 3; }
semantics Arm {
  base { this.tip = world; }
  hand { point(frame: Limbs.tip, mass: 0.5 kg); effector(frame: Limbs.tip); }
  limb { this.tip = Limbs.tip * rot(z, Limb.q) * move(x, Limb.length);
         rod(frame: this.tip, axis: -x, length: Limb.length, density: 1 kg/m); }
}
workspace Place {
  plane xy;
  bounds box [-1.8305, 1.8305] x [-1.8305, 1.8305] m;
  region Home box [1.2368, 1.4125] x [0.21709, 0.39282] m;
  target Goal box [0.4177, 0.59343] x [0.73274, 0.90846] m;
  obstacle O1 hull (0.90472, 0.23337), (0.90964, 0.20722), (1.1518, 0.13238),
    (1.17, 0.32961), (0.91135, 0.26631) m;
  obstacle O2 hull (0.98714, 0.69814), (1.0506, 0.66878), (1.0135, 0.7173), (1.0037, 0.71437) m;
  obstacle O3 hull (1.127, 0.84272), (1.157, 0.56982), (1.3985, 0.62839),
    (1.4157, 0.76956), (1.3798, 0.82754), (1.2115, 0.88118) m;
  obstacle O4 box [0.58821, 0.73952] x [-0.06958, 0.13193] m;
}
task T {
  robot Arm; workspace Place;
  start in Home;
  reach Goal;
  avoid O1, O2, O3, O4 with body margin 0.01 m;
  effort <= 21.0 N*m;
  horizon 80 steps of 0.05 s;
  gravity (0, -9.81) m/s^2;
  modules <= 5;
}
"""
"""Three links of lengths near 0.54, 0.57 and 0.35 m; peak 16.4 N*m, static 16.2."""

SPATIAL = """\
module Base { role base; }
module Turn { role joint; dof q: revolute z in [-160, 160] deg; }
module Limb { role link; dof q: revolute y in [-140, 140] deg; param length in [0.265, 0.966] m; }
module Hand { role effector; }
grammar Arm { start Robot; hand: Robot -> Limbs Hand;
  limb: Limbs -> Limbs Limb; base: Limbs -> Base Turn; }
semantics Arm {
  base { this.tip = world * move(z, 0.5 m) * rot(z, Turn.q); }
  hand { point(frame: Limbs.tip, mass: 0.5 kg); effector(frame: Limbs.tip); }
  limb { this.tip = Limbs.tip * rot(y, Limb.q) * move(x, Limb.length);
         rod(frame: this.tip, axis: -x, length: Limb.length, density: 1.5 kg/m); }
}
workspace Place {
  space xyz;
  bounds box [-2.0787, 2.0787] x [-2.0787, 2.0787] x [0, 2.5787] m;
  region Home box [0.35135, 0.60719] x [-0.2102, 0.04564] x [1.6618, 1.9177] m;
  target Goal box [-0.69817, -0.44233] x [0.70512, 0.96096] x [1.4141, 1.67] m;
  obstacle O1 box [-0.19138, 0.06207] x [0.04821, 0.53276] x [1.3635, 1.7396] m;
}
task T {
  robot Arm; workspace Place;
  start in Home;
  reach Goal;
  avoid O1 with body margin 1 cm;
  effort <= 43.2 N*m;
  horizon 60 steps of 0.05 s;
  gravity (0, 0, -9.81) m/s^2;
  modules <= 6;
}
"""
"""A turning base and two links in space; peak 21.6 N*m."""
