"""Random tasks in clutter: a carriage on two slides, little force, and obstacles in the plane.

Obstacles are convex with three to five corners, and turned anyhow.  The bound on forces is a part
of what a way from rest to rest along an axis takes: some tasks cannot be done, in others a few ways
are short enough, and in a few all are.
"""

from __future__ import annotations

import math
import random

ROBOT = """\
module B { role base; }
module PX { role joint; dof q: prismatic x in [0, 10] m; }
module PY { role joint; dof q: prismatic y in [0, 10] m; }
module W { role link; const mass = 2 kg; }
module EN { role effector; }
edge eps;

grammar Gantries {
  start N;
  base: N -> B;
  along: N -> N eps PX;
  across: N -> N eps PY;
  weight: N -> N eps W;
  tool: N -> N eps EN;
  accept matches B eps PX eps W eps PY eps W eps EN;
}

semantics Gantries {
  base { this.frame = world; }
  along { this.frame = N.frame * move(x, PX.q); }
  across { this.frame = N.frame * move(y, PY.q); }
  weight { this.frame = N.frame; point(frame: N.frame, mass: W.mass); }
  tool { this.frame = N.frame; effector(frame: N.frame); }
}
"""
TASK = """
workspace Hall {
  plane xy;
  bounds box [0, 10] x [0, 10] m;
  region S box [0.4, 1] x [0.4, 1] m;
  target T box [9, 9.6] x [9, 9.6] m;
OBSTACLES
}

task Go {
  robot Gantries;
  workspace Hall;
  start in S at rest;
  reach T;
  avoid NAMES with effector;
  effort <= FORCE N;
  horizon STEPS steps of STEP s;
}
"""
WAY, MASS, ROOM = 8.0, 3.0, 0.9


def cluttered_task(seed: int) -> str:
    """A specification; the same seed has the same one."""
    rng = random.Random(seed)
    obstacles = list[str]()
    for _ in range(rng.randint(12, 22)):
        x, y, size = rng.uniform(1, 9), rng.uniform(1, 9), rng.uniform(0.5, 1.6)
        if min(math.hypot(x - at, y - at) for at in (0.7, 9.3)) < size + ROOM:
            continue
        count, first = rng.choice([3, 4, 4, 5]), rng.uniform(0, math.tau)
        angles = [first + math.tau * corner / count for corner in range(count)]
        lengths = [size * rng.uniform(0.7, 1) for _ in angles]
        corners = ", ".join(
            f"({x + length * math.cos(angle):.2f}, {y + length * math.sin(angle):.2f})"
            for angle, length in zip(angles, lengths, strict=True)
        )
        obstacles.append(f"  obstacle O{len(obstacles)} hull {corners} m;")
    time, steps = rng.choice([3, 4, 5]), rng.choice([12, 16, 20])
    force = 4 * MASS * WAY / time**2 * rng.uniform(0.65, 1.0)
    text = TASK.replace("OBSTACLES", "\n".join(obstacles))
    text = text.replace("NAMES", ", ".join(f"O{k}" for k in range(len(obstacles))))
    text = text.replace("FORCE", f"{force:.2f}").replace("STEPS", f"{steps}")
    return ROBOT + text.replace("STEP", f"{time / steps:.4f}")
