"""Choose the inputs of modules, the outputs that may stay open, and the grammars of a set."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

from srgc.imports.module_set import Family, Module, Placement, Port
from srgc.imports.names import Names
from srgc.imports.timor.mounted_module import Mounting
from srgc.imports.timor.port_types import COMPLEMENT, GENDER_WORDS, PortTypes
from srgc.imports.timor.set_data import (
    BASE,
    EFFECTOR,
    Connector,
    ConnectorGender,
    ModuleData,
    fits,
)


def mountings_of(module: ModuleData, *, any_end: bool) -> list[Mounting]:
    """The ways in which a module can stand on others.

    A base stands on the world by its connector of type ``base``.  Another module stands on each of
    its female connectors; if it has none, on the hermaphroditic ones, or else on the male ones.
    With ``any_end`` it may stand on any of its connectors.
    """
    ends = [each for each in module.connectors if each.type == BASE][:1]
    if not ends:
        all_ends = [each for each in module.connectors if each.type != EFFECTOR]
        ends = all_ends if any_end else _usual(all_ends)
    return [Mounting(module, end) for end in ends]


def _usual(ends: Sequence[Connector]) -> list[Connector]:
    order: Sequence[ConnectorGender] = "fhm"  # type: ignore[assignment]
    for gender in order:
        if found := [each for each in ends if each.gender == gender]:
            return found
    return []


@dataclass(slots=True)
class Arrangement:
    """Mountings with their names, outputs that may stay open, and grammars."""

    named: list[tuple[str, Mounting]]
    open_ends: dict[str, Connector] = field(default_factory=dict)
    families: list[Family] = field(default_factory=list)
    remarks: list[str] = field(default_factory=list)


def arranged(named: list[tuple[str, Mounting]], names: Names, family: str) -> Arrangement:
    """The grammars from ports of a set, one for each base.

    An output may stay open if nothing fits it or no robot beyond it ever ends.  So may the outputs
    of modules that have several, since Timor may leave any of them open.
    """
    found = Arrangement(named)
    bases = [(name, each) for name, each in named if _is_base(each)]
    others = [(name, each) for name, each in named if not _is_base(each)]
    reached = _reached([each for _, each in bases], others)
    for end in _open_ends([each for _, each in bases], reached):
        wanted = f"Open{Names().camel(end.type or 'Flange')}"
        found.open_ends[names.name(wanted)] = end
    carried = [name for name, _ in reached] + [*found.open_ends]
    for name, _ in bases:
        called = family if len(bases) == 1 else f"{family}On{name}"
        found.families.append(Family(called, name, carried))
    if not bases:
        found.remarks.append(
            "no module has a connector of type `base`: there is no grammar; write one that starts "
            "with a module of yours"
        )
    kept = {name for name, _ in (*bases, *reached)}
    if left := [name for name, _ in named if name not in kept and bases]:
        found.remarks.append(f"nothing carries {', '.join(left)}: no grammar lists them")
    return found


def open_module(name: str, end: Connector, types: PortTypes, *, effector: bool) -> Module:
    """A module that marks an output as open; it is an effector if ``effector`` is set."""
    place = Placement()
    return Module(
        name=name,
        role="effector" if effector else "link",
        ports=[Port("in", types.name(end), GENDER_WORDS[COMPLEMENT[end.gender]])],
        effectors=[place] if effector else [],
        comments=[f"A {types.name(end)} that stays open."],
    )


def _is_base(mounting: Mounting) -> bool:
    return mounting.entry.type == BASE


def _reached(
    starts: Iterable[Mounting], others: Sequence[tuple[str, Mounting]]
) -> list[tuple[str, Mounting]]:
    """The mountings that can stand on the starts, directly or not, in the order of the set."""
    waiting = [output for start in starts for output in start.outputs]
    seen, met = set[str](), set[tuple[object, ...]]()
    while waiting:
        output = waiting.pop()
        key = (output.type, output.size, output.gender)
        if key in met:
            continue
        met.add(key)
        for name, each in others:
            if name not in seen and fits(output, each.entry):
                seen.add(name)
                waiting += each.outputs
    return [(name, each) for name, each in others if name in seen]


def _open_ends(
    starts: Sequence[Mounting], reached: Sequence[tuple[str, Mounting]]
) -> list[Connector]:
    """One output of each kind that has to be able to stay open."""
    carried = [each for _, each in reached]
    outputs = [output for each in (*starts, *carried) for output in each.outputs]
    first = dict[tuple[object, ...], Connector]()
    for output in outputs:
        first.setdefault(_key(output), output)
    several = [output for each in (*starts, *carried) for output in each.outputs[1:]]
    several += [each.outputs[0] for each in (*starts, *carried) if len(each.outputs) > 1]
    found = {_key(output): first[_key(output)] for output in several}
    while endless := _endless(list(first.values()), carried, set(found)):
        found[_key(endless[0])] = endless[0]
    return list(found.values())


def _endless(
    outputs: Sequence[Connector], carried: Sequence[Mounting], closed: set[tuple[object, ...]]
) -> list[Connector]:
    """The outputs beyond which no robot ends: all that fits one has such an output again."""
    ends = set(closed)
    while True:
        new = {
            _key(output)
            for output in outputs
            if _key(output) not in ends
            and any(
                fits(output, each.entry) and all(_key(next_) in ends for next_ in each.outputs)
                for each in carried
            )
        }
        if not new:
            return [output for output in outputs if _key(output) not in ends]
        ends |= new


def _key(connector: Connector) -> tuple[object, ...]:
    return connector.type, connector.size, connector.gender
