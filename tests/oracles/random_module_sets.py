"""Random module sets in CoBRA's schema: joints and connectors at any pose, of any gender."""

from __future__ import annotations

import math
import random
from typing import Any

import numpy as np

from compiler.arrays import Array

DATE = "2026-01-01"


def pose(rng: random.Random) -> list[list[float]]:
    """A shift within 30 cm and a rotation: any, or one about coordinate axes by right angles."""
    found = np.eye(4)
    found[:3, :3] = _rotation(rng)
    found[:3, 3] = [round(rng.uniform(-0.3, 0.3), 4) for _ in range(3)]
    return found.tolist()


def _rotation(rng: random.Random) -> Array:
    if rng.random() < 0.4:
        axes = [rng.randrange(3) for _ in range(2)]
        angles = [rng.randrange(4) * math.pi / 2 for _ in range(2)]
    else:
        axes, angles = [2, 1, 0], [rng.uniform(-math.pi, math.pi) for _ in range(3)]
    found = np.eye(3)
    for axis, angle in zip(axes, angles, strict=True):
        turn = np.eye(3)
        i, j = (axis + 1) % 3, (axis + 2) % 3
        turn[i, i] = turn[j, j] = math.cos(angle)
        turn[i, j], turn[j, i] = -math.sin(angle), math.sin(angle)
        found = found @ turn
    return found


def connector(
    name: str, gender: str, rng: random.Random, kind: str = "flange", size: Any = 8
) -> dict[str, Any]:
    """A connector at a random pose."""
    return {"ID": name, "gender": gender, "type": kind, "size": [size], "pose": pose(rng)}


def body(name: str, rng: random.Random, *connectors: dict[str, Any]) -> dict[str, Any]:
    """A body with a mass, and moments of inertia that a real one could have."""
    turn, mass = _rotation(rng), round(rng.uniform(0.2, 3), 3)
    a, b, c = (rng.uniform(0.05, 0.3) for _ in range(3))
    moments = np.diag([b * b + c * c, a * a + c * c, a * a + b * b]) * mass / 12
    inertia = turn @ moments @ turn.T
    inertia = (inertia + inertia.T) / 2
    return {
        "ID": name,
        "mass": mass,
        "r_com": [round(rng.uniform(-0.2, 0.2), 4) for _ in range(3)],
        "inertia": inertia.tolist(),
        "collision": [{"type": "sphere", "parameters": {"r": 0.05}, "pose": pose(rng)}],
        "connectors": list(connectors),
    }


def joint(name: str, parent: str, child: str, kind: str, rng: random.Random) -> dict[str, Any]:
    """A joint at random poses, with or without a rotor."""
    far = math.inf if rng.random() < 0.3 else 100.0
    geared = rng.random() < 0.5
    return {
        "ID": name,
        "type": kind,
        "parent": parent,
        "child": child,
        "poseParent": pose(rng),
        "poseChild": pose(rng),
        "limits": {
            "positionLower": -far,
            "positionUpper": far,
            "velocity": rng.choice([math.inf, 2.5]),
            "acceleration": rng.choice([math.inf, 7.0]),
            "peakTorque": rng.choice([math.inf, 80.0]),
        },
        "gearRatio": 120.0 if geared else 1.0,
        "motorInertia": 3e-5 if geared else 0.0,
        "frictionCoulomb": rng.choice([0.0, 1.5]),
        "frictionViscous": rng.choice([0.0, 4.0]),
    }


def module(name: str, bodies: list[Any], joints: list[Any]) -> dict[str, Any]:
    """A module with a header."""
    header: dict[str, Any] = {"ID": name, "name": f"{name} of nobody", "date": DATE}
    header |= {"author": ["nobody"], "email": ["a@b.c"], "affiliation": ["none"], "cost": 1.0}
    return {"header": header, "bodies": bodies, "joints": joints}


def module_set(seed: int, near: str = "f", far: str = "m") -> dict[str, Any]:
    """A base, modules of one to three joints, links and a tool, in any order.

    ``near`` is the gender of the end towards the base, whose ID it is, too; ``far`` of the other.
    """
    rng = random.Random(seed)
    ground = connector("ground", "f", rng, "base", 1)
    made = [module("base", [body("foot", rng, ground, connector("far", far, rng))], [])]
    made += [_chain(f"joint{number}", number + 1, near, far, rng) for number in range(3)]
    for number in range(2):
        ends = [connector("near", near, rng), connector("far", far, rng)]
        rng.shuffle(ends)
        made.append(module(f"link{number}", [body("tube", rng, *ends)], []))
    grip = body("grip", rng, connector("tip", "m", rng, "eef"), connector("near", near, rng))
    made.append(module("tool", [grip], []))
    rng.shuffle(made)
    return {"ignore_collisions": "rigid_via_joint", "modules": made}


def _chain(name: str, joints: int, near: str, far: str, rng: random.Random) -> dict[str, Any]:
    """Bodies in a row; of several joints one is fixed."""
    bodies = [body(f"{name}_body{i}", rng) for i in range(joints + 1)]
    bodies[0]["connectors"].append(connector("near", near, rng))
    bodies[-1]["connectors"].append(connector("far", far, rng))
    kinds = [rng.choice(["revolute", "revolute", "prismatic"]) for _ in range(joints)]
    made = [
        joint(f"{name}_joint{i}", f"{name}_body{i}", f"{name}_body{i + 1}", kind, rng)
        for i, kind in enumerate(kinds)
    ]
    if joints > 1:
        made[rng.randrange(joints)]["type"] = "fixed"
    rng.shuffle(made)
    return module(name, bodies, made)


def joints_of(made: dict[str, Any]) -> int:
    """How many joints of a module move."""
    return sum(each["type"] != "fixed" for each in made["joints"])
