"""The form of each clause: for each item, an example for every word that begins a clause.

A message about a clause that cannot be parsed shows its form; one about an unknown clause lists the
words.  ``MEANT`` maps words that newcomers try to those of the language.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Final

FORMS: Final[Mapping[str, Mapping[str, str]]] = MappingProxyType(
    {
        "module": {
            "role": "role link;",
            "named": 'named "upper_arm_link";',
            "param": "param length in [0.5, 2] m;",
            "const": "const density = 1 kg/m;",
            "dof": "dof q: revolute z in [-90, 90] deg;",
            "drive": "drive q: gear 100 rotor 1e-5 kg*m^2;",
            "state": "state i A = 0;",
            "input": "input u in [-24, 24] V;",
            "der": "der(i) = (u - R*i) / L;",
            "torque": "torque(q) = k * i;",
            "frame": "frame out = in * move(x, length);",
            "port": "port out: Flange male;",
        },
        "grammar": {
            "start": "start N;",
            "with": "with Drive, Hand;",
            "accept": "accept contains Hand;",
        },
        "semantics": {"let": "let turned = N.frame * rot(z, J.q);"},
        "workspace": {
            "plane": "plane xy;",
            "space": "space xyz;",
            "bounds": "bounds box [0, 5] x [0, 5] m;",
            "region": "region S box [0, 1] x [0, 1] m;",
            "obstacle": "obstacle O ball (2, 2) m radius 0.5 m;",
            "target": "target T box [3, 4] x [3, 4] m;",
            "obstacles": 'obstacles from "map.yaml";',
        },
        "task": {
            "robot": "robot Arm;",
            "workspace": "workspace Bench;",
            "start": "start in S at rest;",
            "reach": "reach T at rest;",
            "avoid": "avoid O with effector;",
            "effort": "effort <= 10 N*m;",
            "horizon": "horizon 10 steps of 0.2 s;",
            "slack": "slack 1 cm;",
            "gravity": "gravity (0, -9.81) m/s^2;",
            "modules": "modules <= 5;",
            "bounds": "bounds with body;",
            "from": "from B eps L;",
            "satisfy": "satisfy eventually T;",
            "robust": "robust effort 5 %;",
            "control": "control feedback;",
            "repeat": "repeat;",
            "payload": "payload 0.5 kg;",
            "carry": "carry 0.5 kg from A to B;",
            "minimize": "minimize mass then time;",
        },
        "mission": {
            "tasks": "tasks Morning, Noon;",
            "one": "one robot;",
            "reconfigure": "reconfigure add 2, remove 1;",
            "free": "free L.length;",
            "changes": "changes <= 3;",
            "minimize": "minimize changes;",
        },
    }
)

ITEMS: Final[Mapping[str, str]] = MappingProxyType(
    {
        "include": 'include "modules.srg";',
        "edge": "edge eps;",
        "module": "module L { role link; }",
        "grammar": "grammar Arm { start N; base: N -> B; }",
        "semantics": "semantics Arm { base { this.frame = world; } }",
        "workspace": "workspace Bench { plane xy; bounds box [0, 5] x [0, 5] m; }",
        "task": "task Fetch { robot Arm; workspace Bench; reach T; }",
        "mission": "mission Day { tasks Morning, Noon; one robot; }",
    }
)
"""An example of each item, by its first word."""

OTHERS: Final[Mapping[str, str]] = MappingProxyType(
    {
        "module": "or a body such as `rod(…);`",
        "grammar": "or a production such as `base: N -> B;`",
        "semantics": "an attribute such as `this.frame = world;`, or a body such as `rod(…);`",
    }
)
"""The other statements of an item, which begin with a name."""

BLOCK: Final = "base { this.frame = world; }"
"""A block of a semantics."""

MEANT: Final[Mapping[str, Mapping[str, str]]] = MappingProxyType(
    {
        "module": {
            **dict.fromkeys(
                ("let", "var", "double", "float", "int", "constant", "number"), "const"
            ),
            **dict.fromkeys(("joint", "axis", "revolute", "prismatic", "hinge"), "dof"),
            **dict.fromkeys(("parameter", "variable", "choose"), "param"),
            **dict.fromkeys(("base", "link", "effector", "type", "kind"), "role"),
            **dict.fromkeys(("motor", "actuator"), "drive"),
            **dict.fromkeys(("connector", "interface"), "port"),
        },
        "grammar": {
            **dict.fromkeys(("axiom", "root", "initial"), "start"),
            **dict.fromkeys(("constraint", "require", "where"), "accept"),
            **dict.fromkeys(("use", "modules", "import"), "with"),
        },
        "semantics": dict.fromkeys(("const", "var", "def"), "let"),
        "workspace": {
            **dict.fromkeys(("area", "zone", "place", "room"), "region"),
            **dict.fromkeys(("wall", "block", "avoid"), "obstacle"),
            **dict.fromkeys(("goal", "reach"), "target"),
            **dict.fromkeys(("limits", "size", "box"), "bounds"),
            **dict.fromkeys(("map", "image"), "obstacles"),
            "dimension": "plane",
        },
        "task": {
            **dict.fromkeys(("goal", "target", "end", "move", "go", "visit", "at"), "reach"),
            **dict.fromkeys(("time", "duration", "steps", "dt"), "horizon"),
            **dict.fromkeys(("torque", "force"), "effort"),
            **dict.fromkeys(("obstacle", "obstacles", "not"), "avoid"),
            **dict.fromkeys(("grammar", "arm"), "robot"),
            **dict.fromkeys(("world", "scene", "environment"), "workspace"),
            **dict.fromkeys(("initial", "init", "begin"), "start"),
            **dict.fromkeys(("minimise", "optimize", "optimise", "objective", "cost"), "minimize"),
            **dict.fromkeys(("always", "eventually", "formula"), "satisfy"),
            **dict.fromkeys(("load", "mass"), "payload"),
            "length": "modules",
        },
        "mission": {
            **dict.fromkeys(("same", "single"), "one"),
            **dict.fromkeys(("rebuild", "add", "remove"), "reconfigure"),
            "minimise": "minimize",
        },
    }
)
