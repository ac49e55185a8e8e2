"""Compile modular-robot grammars to robots that are proved to do their task.

The public face; everything else may change between versions.  ``import srgc`` loads nothing but
this file: a name is loaded when it is first used, and heavy libraries by the call that needs them.
"""

TYPE_CHECKING = False
if TYPE_CHECKING:
    from srgc.faults import SrgcError as SrgcError
    from srgc.public.explanation import why as why
    from srgc.public.export import export as export
    from srgc.public.findings import check as check
    from srgc.public.graph import graph as graph
    from srgc.public.plan import plan as plan
    from srgc.public.program import load as load
    from srgc.public.result import open_result as open_result
    from srgc.public.robot import robot as robot
    from srgc.public.synthesis import synthesize as synthesize
    from srgc.public.verification import verify as verify
    from srgc.public.words import words as words

_HOMES = {
    "SrgcError": "srgc.faults",
    "check": "srgc.public.findings",
    "export": "srgc.public.export",
    "graph": "srgc.public.graph",
    "load": "srgc.public.program",
    "open_result": "srgc.public.result",
    "plan": "srgc.public.plan",
    "robot": "srgc.public.robot",
    "synthesize": "srgc.public.synthesis",
    "verify": "srgc.public.verification",
    "why": "srgc.public.explanation",
    "words": "srgc.public.words",
}

__all__ = [
    "SrgcError",
    "check",
    "export",
    "graph",
    "load",
    "open_result",
    "plan",
    "robot",
    "synthesize",
    "verify",
    "why",
    "words",
]


if not TYPE_CHECKING:  # for a type checker there are no other names than those above

    def __getattr__(name: str) -> object:
        """A public name, when it is first used."""
        if name not in _HOMES:
            raise AttributeError(f"module 'srgc' has no attribute {name!r}")
        from importlib import import_module

        found: object = getattr(import_module(_HOMES[name]), name)
        globals()[name] = found
        return found


def __dir__() -> list[str]:
    """The public names."""
    return sorted(__all__)
