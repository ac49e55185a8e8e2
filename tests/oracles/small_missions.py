"""Missions of arms with a link or two, quick to solve; what each comes to is seen by eye.

An arm of one link reaches one distance: ``Long`` needs 1 m, ``Short`` 0.5 m, ``Wide`` two links;
``Lost`` is beyond all of them.
"""

from __future__ import annotations

HEAD = """\
module B { role base; const price = 1; }
module JO { role joint; dof q: revolute z in [-170, 170] deg; const price = 2; }
module L { role link; param length in {0.5, 1} m; const density = 1 kg/m; const price = 10; }
module EN { role effector; const price = 1; }
edge eps;

grammar Arm {
  start N;
  base: N -> B;
  joint: N -> N eps JO;
  link: N -> N eps L;
  tool: N -> N eps EN;
  accept matches B (eps JO eps L)+ eps EN;
}

semantics Arm {
  base { this.frame = world; }
  joint { this.frame = N.frame * rot(z, JO.q); }
  link {
    this.frame = N.frame * move(x, L.length);
    rod(frame: N.frame, axis: x, length: L.length, density: L.density);
  }
  tool { this.frame = N.frame; effector(frame: N.frame); }
}
"""


def _workspace(name: str, near: float, far: float, bounds: float = 2) -> str:
    """From the right of the base to above it, at distances from ``near`` to ``far``."""
    side = f"[-{bounds}, {bounds}]"
    return (
        f"workspace {name} {{ plane xy; bounds box {side} x {side} m;\n"
        f"  region S box [{near}, {far}] x [-0.2, 0.2] m;\n"
        f"  target T box [-0.2, 0.2] x [{near}, {far}] m; }}\n"
    )


def _task(name: str, workspace: str, modules: int, more: str = "") -> str:
    return (
        f"task {name} {{ robot Arm; workspace {workspace}; start in S at rest; reach T;\n"
        f"  effort <= 10 N*m; horizon 12 steps of 0.1 s; modules <= {modules}; {more}}}\n"
    )


ONE_LINK = "B eps JO eps L eps EN"
SHOP = (
    HEAD
    + _workspace("At1m", 0.9, 1.1)
    + _workspace("AtHalf", 0.4, 0.6)
    + _workspace("AtOneAndAHalf", 1.3, 1.6)
    + _workspace("AtSeven", 6.8, 7.2, 8)
    + _task("Long", "At1m", 4)
    + _task("Again", "At1m", 4)
    + _task("Short", "AtHalf", 4)
    + _task("Wide", "AtOneAndAHalf", 6)
    + _task("Lost", "AtSeven", 4)
    + _task("Kept", "AtOneAndAHalf", 6, f"from {ONE_LINK}; ")
    + """
mission Retune { tasks Long, Short; reconfigure add 2, remove 1, change 1/2; free L.length; }
mission Swap { tasks Long, Again, Short; reconfigure add 2, remove 1; }
mission Grow { tasks Long, Wide, Again; reconfigure; }
mission Both { tasks Long, Again; one robot; minimize sum(price) then modules; }
mission Nobody { tasks Long, Lost; one robot; }
mission Bound { tasks Long, Short; reconfigure; changes <= 1; }
mission Before { tasks Kept; reconfigure; }
"""
)
MISSIONS = ("Retune", "Swap", "Grow", "Both", "Nobody", "Bound", "Before")
"""Their names; ``made("mission_grow")`` is the result of the third."""
