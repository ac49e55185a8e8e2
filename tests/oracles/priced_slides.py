"""Slides of which each has a mass and a price, and what of them is best, by hand.

A force of 20 N does not move 60 kg by 0.8 m within 2 s and stop them (``least_force``); it does
that with all others.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TypeAlias

from tests.oracles.slides import slides
from tests.oracles.small_specs import replaced

Kinds: TypeAlias = Mapping[str, tuple[float, int]]
KINDS: Kinds = {"Block": (60, 5), "Heavy": (4, 10), "Light": (2, 30), "Worse": (4.5, 40)}
"""In the order of prices: the mass in kg, which is that of the robot, and the price."""
FRONT = ("Heavy", "Light")
DOMINATED = "Worse"
"""By ``Heavy``, and by ``Light``."""


def word(kind: str) -> str:
    """The robot with a kind of slide."""
    return f"Base e {kind} e Hand"


def priced_slides(minimize: str = "minimize sum(price) then mass;", among: Kinds = KINDS) -> str:
    """The task with this clause, of robots with one of some kinds of slides."""
    masses = "; ".join(f"const mass = {mass} kg" for mass, _ in among.values())
    text = slides(masses, kinds=" ".join(among))
    for kind, (_, price) in among.items():
        head = f"module {kind} {{ role joint;"
        text = replaced(text, head, f"{head} const price = {price};")
    for plain in ("role base;", "role effector;"):
        text = replaced(text, plain, f"{plain} const price = 0;")
    return replaced(text, "modules <= 3;", f"modules <= 3; {minimize}")
