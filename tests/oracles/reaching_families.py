"""Random families and places in random distance, with what an independent search says of robots."""

from __future__ import annotations

import random

from tests.oracles.random_kits import RandomKit

CHAIN = """
module Base {{ role base; }}
module J {{ role joint; dof q: revolute {turn} in [-180, 180] deg; }}
module P {{ role joint; dof d: prismatic {slide} in [0, {stroke}] m; }}
module L {{ role link; param length in [{low}, {high}] m; const density = 1 kg/m; }}
module K {{ role link; param length in [{long}, {longest}] m; const density = 2 kg/m; }}
module E {{ role effector; }}
edge eps;
grammar G {{
  start N;
  {grammar}
  accept {accept};
}}
semantics G {{
{semantics}
}}
"""
FROM_BELOW = (
    """base: N -> Base; joint: N -> N eps J; slide: N -> N eps P; short: N -> N eps L;
  long: N -> N eps K; tool: N -> N eps E;""",
    """  base {{ this.frame = world{raised}; }}
  joint {{ this.frame = N.frame * rot({turn}, J.q); }}
  slide {{ this.frame = N.frame * move({slide}, P.d); point(frame: N.frame, mass: 1 kg); }}
  short {{
    this.frame = N.frame * move(x, L.length);
    rod(frame: N.frame, axis: x, length: L.length, density: L.density);
  }}
  long {{
    this.frame = N.frame * move(x, K.length);
    rod(frame: N.frame, axis: x, length: K.length, density: K.density);
  }}
  tool {{ this.frame = N.frame; effector(frame: N.frame); }}""",
)
FROM_ABOVE = (
    """base: N -> Base eps A; joint: A -> J eps A; slide: A -> P eps A; short: A -> L eps A;
  long: A -> K eps A; fork: A -> E A; tool: A -> E;""",
    """  base {{ A.at = world{raised}; }}
  joint {{ A.at = this.at * rot({turn}, J.q); }}
  slide {{ A.at = this.at * move({slide}, P.d); point(frame: this.at, mass: 1 kg); }}
  short {{
    A.at = this.at * move(x, L.length);
    rod(frame: this.at, axis: x, length: L.length, density: L.density);
  }}
  long {{
    A.at = this.at * move(x, K.length);
    rod(frame: this.at, axis: x, length: K.length, density: K.density);
  }}
  fork {{ A.at = this.at * rot({turn}, 40 deg); effector(frame: this.at); }}
  tool {{ effector(frame: this.at); }}""",
)
TASK = """
workspace W {{
  {dimension};
  bounds box {bounds} m;
  region S box {start} m;
  target T {target};
}}
task Go {{
  robot G; workspace W; start in S at rest; reach T;
  effort <= 100 N*m; effort <= 100 N; modules <= {modules}; horizon 10 steps of 0.1 s;
}}
"""


def reaching_family(seed: int) -> str:
    """A chain written from below or from above, or a kit, and a target near or far."""
    choose = random.Random(seed)
    plane = choose.random() < 0.5
    low, long = choose.uniform(0.2, 0.5), choose.uniform(1.5, 3)
    if choose.random() < 0.7:
        grammar, semantics = choose.choice([FROM_BELOW, FROM_ABOVE])
        words = {
            "turn": "z" if plane else choose.choice("zzyx"),
            "slide": "x" if plane else choose.choice("xz"),
            "stroke": f"{choose.uniform(0.1, 0.6):.3f}",
            "raised": "" if plane or choose.random() < 0.5 else " * move(z, 0.4 m)",
            "low": f"{low:.3f}",
            "high": f"{low + choose.uniform(0.0, 0.4):.3f}",
            "long": f"{long:.3f}",
            "longest": f"{long + choose.uniform(0, 0.5):.3f}",
            "accept": choose.choice([
                "contains E", "contains E and count(K) == 1",
                "contains E and count(K) <= 1 and count(P) == 0",
                "count(K) >= 1 and count(E) == 1 and ends with E",
                "starts with Base eps J and contains E", "count(L) >= 1 or count(K) >= 1",
            ]),
        }  # fmt: skip
        text = CHAIN.format(
            grammar=grammar.format(**words), semantics=semantics.format(**words), **words
        )
        reach, modules = 0.9 * long, 5
    else:
        kit = RandomKit(seed)
        plane, text, reach, modules = kit.plane, kit.text, 0.8, 5
    return text + _task(choose, plane=plane, reach=reach, modules=modules)


def _task(choose: random.Random, *, plane: bool, reach: float, modules: int) -> str:
    """Somewhere within the reach of some, a box or a tilted polytope."""
    size = 2 if plane else 3
    centre = [choose.uniform(-reach, reach) / size**0.5 for _ in range(size)]
    if not plane and choose.random() < 0.6:
        centre[2] = 0.0
    half = choose.uniform(0.05, 0.6)
    target = "box " + " x ".join(f"[{c - half:.4f}, {c + half:.4f}]" for c in centre) + " m"
    if plane and choose.random() < 0.5:
        x, y = centre
        target = (
            f"polytope {{ x + 2*y <= {x + 2 * y + half:.4f}; -x - 2*y <= {half - x - 2 * y:.4f}; "
            f"2*x - y <= {2 * x - y + half:.4f}; y - 2*x <= {half + y - 2 * x:.4f}; }} m"
        )
    far = 20 * reach
    return TASK.format(
        dimension="plane xy" if plane else "space xyz",
        bounds=" x ".join([f"[{-far:.1f}, {far:.1f}]"] * size),
        start=" x ".join([f"[{-far / 2:.1f}, {far / 2:.1f}]"] * size),
        target=target,
        modules=modules,
    )
