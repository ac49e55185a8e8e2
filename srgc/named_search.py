"""Which search of parameters a run is asked to use."""

from __future__ import annotations

from solvers.search.configuration_search import SEARCHES
from srgc.session import UsageFault


def named_search(name: str | None) -> str | None:
    """The search of that name; None for the usual one.

    Raises:
        UsageFault: there is no such search.
    """
    if name is None or name.lower() == SEARCHES[0]:
        return None
    if name.lower() not in SEARCHES:
        known = " and ".join(f"`{each}`" for each in SEARCHES)
        raise UsageFault(f"there is no parameter search `{name}`; known are {known}")
    return name.lower()
