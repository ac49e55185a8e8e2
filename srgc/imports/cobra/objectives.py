"""Convert cost functions of CoBRA to ``minimize``."""

from __future__ import annotations

from collections.abc import Iterator

from srgc.faults import UsageFault

COSTS = {
    "cyc": ("time", ""),
    "mechEnergy": ("energy", ""),
    "linkMechEnergy": ("energy", "with friction and rotors"),
    "mass": ("mass", ""),
    "numJ": ("modules", "which counts modules, not joints"),
    "effort": ("effort", "which is the largest share of a bound, not an integral"),
    "qDist": ("", "a distance of joint angles"),
    "fulfillN": ("", "all goals are asked for"),
    "fulfillP": ("", "all goals are asked for"),
}
"""Maps the abbreviation of a cost to its objective here, and to a remark on it."""


def objectives(described: str, remarks: list[str]) -> list[str]:
    """The objectives of a description such as ``cyc_1,mass_0.5``, in its order.

    Raises:
        UsageFault: a cost is unknown, or its weight is not a number.
    """
    found = list[str]()
    for name, weight in _costs(described):
        if name not in COSTS:
            raise UsageFault(f"unknown cost `{name[:40]}`; known are {', '.join(COSTS)}")
        objective, said = COSTS[name]
        if said:
            became = f"became `{objective}`, " if objective else "is left out: "
            remarks.append(f"cost {name} {became}{said}")
        if objective and objective not in found:
            found.append(objective)
        if weight < 0:
            remarks.append(f"cost {name}: its negative weight")
    if len(found) > 1:
        remarks.append("the weights of costs: one counts after the other")
    return found


def _costs(described: str) -> Iterator[tuple[str, float]]:
    for part in filter(None, described.replace(" ", "").split(",")):
        name, _, weight = part.partition("_")
        try:
            yield name, float(weight or 1)
        except ValueError:
            raise UsageFault(f"cost {part[:40]}: {weight[:40]!r} is no weight") from None
