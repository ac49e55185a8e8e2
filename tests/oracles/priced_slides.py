"""Slides of which each has a mass and a price, and what of them is best, by hand.

A force of 20 N does not move 60 kg by 0.8 m within 2 s and stop them (``least_force``); it does
that with all others.
"""

from __future__ import annotations

from tests.oracles.slides import slides
from tests.oracles.small_specs import replaced

KINDS = {"Block": (60, 5), "Heavy": (4, 10), "Light": (2, 30), "Worse": (4.5, 40)}
"""In the order of prices: the mass in kg, which is that of the robot, and the price."""
FRONT = ("Heavy", "Light")
DOMINATED = "Worse"
"""By ``Heavy``, and by ``Light``."""


def word(kind: str) -> str:
    """The robot with a kind of slide."""
    return f"Base e {kind} e Hand"


def priced_slides(minimize: str = "minimize sum(price) then mass;") -> str:
    """The task, with this clause."""
    masses = "; ".join(f"const mass = {mass} kg" for mass, _ in KINDS.values())
    text = slides(masses, kinds=" ".join(KINDS))
    for kind, (mass, price) in KINDS.items():
        before, after = text.split(f"module {kind} ", 1)
        given = f"const mass = {mass} kg;"
        text = f"{before}module {kind} {replaced(after, given, f'{given} const price = {price};')}"
    for plain in ("role base;", "role effector;"):
        text = replaced(text, plain, f"{plain} const price = 0;")
    return replaced(text, "modules <= 3;", f"modules <= 3; {minimize}")
