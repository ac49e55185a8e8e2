"""Two rods in the plane that have a quarter turn to do: 0.6 m of 1 kg/m, 0.45 m of 2 kg/m."""

from __future__ import annotations

SPEC = """\
module B { role base; }
JOINTS
module Upper { role link; const length = 0.6 m; }
module Fore { role link; const length = 0.45 m; }
module E { role effector; }
grammar Pair { start N; all: N -> B Big Upper Small Fore E; }
semantics Pair {
  all {
    this.one = rot(z, Big.q);
    this.two = this.one * move(x, Upper.length) * rot(z, Small.q);
    rod(frame: this.one, axis: x, length: Upper.length, density: 1 kg/m);
    rod(frame: this.two, axis: x, length: Fore.length, density: 2 kg/m);
    effector(frame: this.two * move(x, Fore.length));
  }
}
workspace Table {
  plane xy;
  bounds box [-3, 3] x [-3, 3] m;
  region S box [0.7, 0.9] x [0.1, 0.4] m;
  target T box [-0.3, 0.2] x [0.6, 0.9] m;
}
task Turn { robot Pair; workspace Table; start in S at rest; TASK }
"""


def rod_pair(joints: str, task: str) -> str:
    """A specification with these modules ``Big`` and ``Small``, and further clauses of the task."""
    return SPEC.replace("JOINTS", joints).replace("TASK", task)
