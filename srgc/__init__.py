"""Compile modular-robot grammars to robots that are proved to do their task.

The names in ``__all__`` are the public interface; everything else may change between versions.
``import srgc`` loads this file only: a name is loaded when it is first used, and heavy libraries by
the call that needs them.
"""

TYPE_CHECKING = False
if TYPE_CHECKING:
    from srgc.api.builder.grammar import Grammar as Grammar
    from srgc.api.builder.module import Module as Module
    from srgc.api.builder.spec import Spec as Spec
    from srgc.api.builder.task import Task as Task
    from srgc.api.builder.workspace import Workspace as Workspace
    from srgc.api.evolution import evolve as evolve
    from srgc.api.export import export as export
    from srgc.api.graph import graph as graph
    from srgc.api.opened import open_result as open_result
    from srgc.api.program import check as check
    from srgc.api.program import load as load
    from srgc.api.program import words as words
    from srgc.api.robot import robot as robot
    from srgc.api.synthesis import plan as plan
    from srgc.api.synthesis import synthesize as synthesize
    from srgc.api.synthesis import why as why
    from srgc.api.verification import verify as verify
    from srgc.faults import SrgcError as SrgcError

__version__: str

_HOMES = {
    "Grammar": "srgc.api.builder.grammar",
    "Module": "srgc.api.builder.module",
    "Spec": "srgc.api.builder.spec",
    "SrgcError": "srgc.faults",
    "Task": "srgc.api.builder.task",
    "Workspace": "srgc.api.builder.workspace",
    "check": "srgc.api.program",
    "evolve": "srgc.api.evolution",
    "export": "srgc.api.export",
    "graph": "srgc.api.graph",
    "load": "srgc.api.program",
    "open_result": "srgc.api.opened",
    "plan": "srgc.api.synthesis",
    "robot": "srgc.api.robot",
    "synthesize": "srgc.api.synthesis",
    "verify": "srgc.api.verification",
    "why": "srgc.api.synthesis",
    "words": "srgc.api.program",
}

__all__ = [
    "Grammar",
    "Module",
    "Spec",
    "SrgcError",
    "Task",
    "Workspace",
    "check",
    "evolve",
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


if not TYPE_CHECKING:  # type checkers see only the names imported above

    def __getattr__(name: str) -> object:
        """Load a public name when it is first used."""
        if name == "__version__":
            from srgc.version import VERSION

            return VERSION
        if name not in _HOMES:
            raise AttributeError(f"module 'srgc' has no attribute {name!r}")
        from importlib import import_module

        found: object = getattr(import_module(_HOMES[name]), name)
        globals()[name] = found
        return found


def __dir__() -> list[str]:
    """The public names."""
    return sorted(__all__)
