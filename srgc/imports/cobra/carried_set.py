"""The modules for the robot of a task: from a set of Timor, a spec, or the library."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from srgc.faults import UsageFault
from srgc.imports.cobra.base_place import GroundPort
from srgc.imports.module_set import Module, ModuleSet

LIBRARY = "timor.srg"
OF_LIBRARY = ("Std_Timor_Base", "Std_Timor_J2", "Std_Timor_I", "Std_Timor_L", "Std_Timor_Eef")
"""Revolute joints and tubes; the prismatic joint is left out, as it has no effort limit."""
MESH = re.compile(r'file: "([^"\n]*)"')
"""A mesh that a spec names, which has to be copied together with the spec."""
MALE_TO = {"female": "male", "male": "female", "": ""}


@dataclass(frozen=True, slots=True)
class CarriedSet:
    """The modules that a task is written with.

    Attributes:
        head: an ``include``; empty if ``modules`` are written.
        listed: the modules of the grammar, beginning with the base.
        ground: the port that carries the base.
        unbounded: the kinds of joints of which at least one has no effort limit.
        modules: the modules to write with the task.
        files: the files to write next to it.
        accel: whether any joint has an acceleration limit.
    """

    head: str
    listed: Sequence[str]
    ground: GroundPort
    unbounded: frozenset[str] = frozenset()
    modules: ModuleSet = field(default_factory=ModuleSet)
    files: Mapping[str, bytes] = field(default_factory=dict)
    accel: bool = False


def carried_set(given: Path | None, *, name: str | None, base: str | None, stem: str) -> CarriedSet:
    """Read the modules that ``--modules`` names: a set of Timor, or a spec imported before.

    ``stem`` is the name of the spec of the task, without its extension.

    Raises:
        UsageFault: the file cannot be read, or has no base.
    """
    if given is None:
        return CarriedSet(
            f'include std "{LIBRARY}";', OF_LIBRARY, GroundPort("Std_Timor_Ground", "male")
        )
    if given.suffix == ".srg":
        return _spec(given)
    from srgc.imports.timor.timor_import import SetOptions, read_modules

    found = read_modules(given, SetOptions(name, stem=stem))
    families = [each for each in found.modules.families if base in (None, each.start)]
    if not families:
        starts = ", ".join(each.start for each in found.modules.families) or "none"
        raise UsageFault(f"{given} has no base {base or ''}; it has {starts}")
    family = families[0]
    modules = {module.name: module for module in found.modules.modules}
    listed = [family.start, *family.carried]
    (entry,) = (port for port in modules[family.start].ports if port.name == "in")
    dofs = [dof for each in listed for dof in modules[each].dofs]
    found.modules.families.clear()
    return CarriedSet(
        "",
        listed,
        GroundPort(entry.type, MALE_TO[entry.gender or ""]),
        frozenset(dof.kind for dof in dofs if dof.effort is None and not dof.passive),
        _kept(found.modules, listed, modules),
        found.files,
        any(dof.accel is not None for dof in dofs),
    )


def _kept(found: ModuleSet, listed: Sequence[str], modules: Mapping[str, Module]) -> ModuleSet:
    """Only the modules that the grammar lists: other bases would be unused."""
    kept = [each for each in found.modules if each.name in listed]
    if left := [name for name in modules if name not in listed]:
        found.remarks.append(f"modules that this task does not use: {', '.join(left)}")
    found.modules = kept
    return found


def _spec(path: Path) -> CarriedSet:
    """The modules of the first grammar from ports in a spec."""
    from grammar_lang.diagnostics.diagnostic import Sink
    from grammar_lang.parsing.parse import parse
    from grammar_lang.syntax import family as syntax
    from srgc.imports.source_files import source_files

    files = source_files(path)
    content = files.main_bytes()
    sink, text = Sink(), content.decode("utf-8", "replace")
    file = parse(text, sink)
    grammars = [each for each in file.items if isinstance(each, syntax.Grammar) and each.from_ports]
    modules = {each.name.text: each for each in file.items if isinstance(each, syntax.Module)}
    if not grammars:
        raise UsageFault(f"{path} has no grammar from ports; import a module set first")
    listed = [each.name.text for each in grammars[0].items if isinstance(each, syntax.StartSymbol)]
    for item in grammars[0].items:
        if isinstance(item, syntax.Listed):
            listed += [name.text for name in item.names]
    if not listed:
        raise UsageFault(f"{path}: its grammar from ports names no modules: it needs a `start`")
    known = [modules[name] for name in listed if name in modules]
    entry = next(
        (
            item
            for item in (known[0].items if known and known[0].name.text == listed[0] else ())
            if isinstance(item, syntax.Port) and item.name.text == "in"
        ),
        None,
    )
    if entry is None:
        raise UsageFault(f"{path}: its base {listed[0]} has no `port in` by which it could stand")
    dofs = [item for each in known for item in each.items if isinstance(item, syntax.Dof)]
    return CarriedSet(
        f'include "{path.name}";',
        listed,
        GroundPort(entry.type.text, MALE_TO[entry.gender or ""]),
        frozenset(dof.kind for dof in dofs if dof.effort is None),
        files={path.name: content} | {name: files.bytes_of(name) for name in MESH.findall(text)},
        accel=any(dof.accel is not None for dof in dofs),
    )
