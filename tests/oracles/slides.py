"""Masses that a force slides from one interval into another, with the least force by hand."""

from __future__ import annotations

from math import sqrt

FINAL_RATE = 1e-3
"""What the language takes for rest at the end, in m/s."""


def least_force(mass: float, way: float, time: float, *, stops: bool) -> float:
    """The least bound F on |u| that lets m x'' = u go a way from rest in a time.

    Best is full force one way, then, if it has to stop, the other way: with a = F / m and a final
    rate v, the way is v T / 2 + a T^2 / 4 - v^2 / (4 a); else it is a T^2 / 2.
    """
    if not stops:
        return 2 * mass * way / time**2
    v, t = FINAL_RATE, time
    rest = way - v * t / 2
    return mass * (rest + sqrt(rest**2 + v**2 * t**2 / 4)) / (t**2 / 2)


def slides(
    masses: str, *, kinds: str = "Slide", effort: str = "effort <= 20 N;", end: str = "at rest",
    modules: str = "modules <= 3;", steps: int = 20,
    goal: str = "1.1, 1.4", travel: str = "[0, 2] m",
) -> str:  # fmt: skip
    """A base, one joint of some kinds and a hand; ``masses`` declares a mass per kind."""
    joints, rules, semantics = [], [], []
    for kind, mass in zip(kinds.split(), masses.split(";"), strict=True):
        where = f" in {travel}" if travel else ""
        joints.append(f"module {kind} {{ role joint; dof q: prismatic x{where}; {mass.strip()}; }}")
        rules.append(f"r{kind}: P -> P e {kind};")
        semantics.append(
            f"r{kind} {{ this.at = P.at * move(x, {kind}.q); "
            f"point(frame: this.at, mass: {kind}.mass); }}"
        )
    return f"""
module Base {{ role base; }}
{" ".join(joints)}
module Hand {{ role effector; }}
edge e;
grammar Cart {{
  start P; base: P -> Base; {" ".join(rules)} hand: P -> P e Hand;
  accept matches Base e ({" | ".join(kinds.split())}) e Hand;
}}
semantics Cart {{
  base {{ this.at = world; }}
  {" ".join(semantics)}
  hand {{ this.at = P.at; effector(frame: P.at); }}
}}
workspace Track {{
  plane xy; bounds box [-1, 3] x [-1, 1] m;
  region Home box [0.1, 0.3] x [-0.1, 0.1] m; target Goal box [{goal}] x [-0.1, 0.1] m;
}}
task Go {{
  robot Cart; workspace Track; start in Home at rest; reach Goal {end};
  {effort} {modules} horizon {steps} steps of 0.1 s;
}}
"""
