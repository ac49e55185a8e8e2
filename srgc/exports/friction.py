"""What of the modules' own dynamics other formats can hold: viscous friction, and nothing else."""

from __future__ import annotations

from compiler.rigid_links.viscous_friction import viscous_friction
from srgc.results.found_design import FoundDesign


def dampings(design: FoundDesign) -> tuple[float, ...]:
    """The viscous friction of every degree of freedom that has no other dynamics of its own."""
    found = [0.0] * len(design.model.dofs)
    for own in design.model.own:
        for dof, damping in (viscous_friction(own, design.stated) or {}).items():
            found[dof] = float(damping)
    return tuple(found)


def left_out(design: FoundDesign) -> str | None:
    """The modules whose dynamics URDF and MJCF do not hold, or None where there are none."""
    others = [own for own in design.model.own if viscous_friction(own, design.stated) is None]
    modules = sorted({(own.symbol, own.module) for own in others})
    if not modules:
        return None
    names = ", ".join(f"{module} (symbol {symbol})" for symbol, module in modules)
    return f"the dynamics of their own of {names}"
