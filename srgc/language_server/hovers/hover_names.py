"""The hover text for a name, as Markdown."""

from __future__ import annotations

from collections.abc import Callable

from grammar_lang import ir
from grammar_lang import syntax as s
from grammar_lang.ir.constants import to_float
from grammar_lang.ir.expression_text import number_text
from grammar_lang.names.declarations import REGIONS, Entity, Kind
from grammar_lang.names.table import Mention
from grammar_lang.source import written
from srgc.language_server.documents.analysis import Analysis
from srgc.language_server.documents.places import described
from srgc.language_server.hovers.hover_tasks import mission_text, task_text
from srgc.language_server.hovers.production_physics import (
    added_physics,
    closed_text,
    domain_text,
    physics_text,
    rounded,
)

_MOST_PRODUCTIONS = 24
"""The number of productions to show of a grammar from ports."""
_MOST_MODULES = 24
"""The number of modules to show of a sum over modules."""


def _code(text: str) -> str:
    return f"```srg\n{text}\n```"


def _uses(analysis: Analysis, entity: Entity) -> str:
    number = len(analysis.names.uses(entity))
    return "used nowhere" if not number else f"used {number} time{'s' * (number > 1)}"


def _statement(analysis: Analysis, entity: Entity) -> str:
    """The declaration of an entity, as code."""
    return _code(written(entity.statement, analysis.sources) or entity.name)


def hover_mention(analysis: Analysis, mention: Mention) -> str:
    """The text for a name at its position."""
    return _sum(analysis, mention) if mention.summed_up else _name(analysis, mention.entity)


def _name(analysis: Analysis, entity: Entity) -> str:
    """The text for an entity."""
    makers: dict[Kind, Callable[[Analysis, Entity], str]] = {
        "module": _module,
        "edge": _edge,
        "nonterminal": _nonterminal,
        "production": _production,
        "occurrence": _occurrence,
        "attribute": _attribute,
        "port type": _port_type,
        "local value": _local_value,
        "grammar": _grammar,
        "workspace": _workspace,
        "map": _map,
        "task": _task,
        "mission": _mission,
    }
    if entity.kind in REGIONS:
        return _region(analysis, entity)
    return makers.get(entity.kind, _member)(analysis, entity)


# --- Modules -----------------------------------------------------------------------------------


def _sum(analysis: Analysis, mention: Mention) -> str:
    """The terms of an objective's sum, by module."""
    found = [each.entity for each in analysis.names.together(mention)]
    lines = [
        f"{each.scope[0]}: {written(each.statement, analysis.sources)}"
        for each in found[:_MOST_MODULES]
    ]
    if len(found) > len(lines):
        lines.append(f"// {len(found) - len(lines)} more")
    about = "Summed up over the modules of a robot; those that have none count as 0."
    return f"{_code(chr(10).join(lines))}\n\n{about}"


def _edge(analysis: Analysis, entity: Entity) -> str:
    return f"{_code(f'edge {entity.name}')}\n\nAn edge label, {_uses(analysis, entity)}."


def _module(analysis: Analysis, entity: Entity) -> str:
    module = analysis.declared.modules[entity.name]
    statements = (written(item.span, analysis.sources) for item in module.items)
    lines = "".join(f"\n  {line};" for line in statements if line)
    text = f"module {entity.name} {{{lines}\n}}" if lines else f"module {entity.name} {{ }}"
    return f"{_code(text)}\n\nA module, {_uses(analysis, entity)}."


def _member(analysis: Analysis, entity: Entity) -> str:
    program, module = analysis.program, entity.scope[0]
    lowered = None if program is None else program.modules.get(module)
    detail = "" if lowered is None else _member_detail(analysis, lowered, entity)
    about = f"Of module `{module}`, {_uses(analysis, entity)}."
    return "\n\n".join(part for part in (_statement(analysis, entity), detail, about) if part)


def _member_detail(analysis: Analysis, module: ir.Module, entity: Entity) -> str:
    name = entity.name
    match entity.kind:
        case "parameter":
            found = next((p for p in module.parameters if p.name == name), None)
            return "" if found is None else _parameter(found)
        case "degree of freedom":
            dof = next((d for d in module.dofs if d.name == name), None)
            return "" if dof is None else _dof(analysis, module, dof)
        case "state":
            state = next((each for each in module.states if each.name == name), None)
            if state is None:
                return ""
            start = "0" if state.initial is None else closed_text(state.initial)
            return f"A state, in {_unit(state.unit)}; {start} at first."
        case "input":
            given = next((each for each in module.inputs if each.name == name), None)
            return "" if given is None else f"An input in {domain_text(given.domain, given.unit)}."
        case "frame":
            return "A frame, which is counted from `in`."
        case _:
            return "A constant."


def _unit(unit: str) -> str:
    return "no unit" if unit in {"", "1"} else unit


def _parameter(parameter: ir.Parameter) -> str:
    kind = "interval" if isinstance(parameter.domain, ir.Interval) else "set"
    domain = domain_text(parameter.domain, parameter.unit)
    return (
        f"A parameter in the {kind} {domain} (SI). It has no default: the synthesis chooses it, "
        "unless a task has it `fixed`."
    )


def _dof(analysis: Analysis, module: ir.Module, dof: ir.Dof) -> str:
    revolute = dof.kind == "revolute"
    unit, way = ("rad", "about") if revolute else ("m", "along")
    lines = [f"A {dof.kind} degree of freedom {way} {dof.axis}."]
    ranged = "unlimited" if dof.range is None else domain_text(dof.range, unit)
    rated = "unlimited" if dof.rate is None else domain_text(dof.rate, f"{unit}/s")
    lines += ["", f"- range: {ranged}", f"- rate: {rated}"]
    if dof.accel is not None:
        lines.append(f"- acceleration: at most {to_float(dof.accel):.6g} {unit}/s^2")
    if dof not in module.free_dofs:
        lines.append("- effort: by the module's own `torque`, no free input")
    else:
        lines += [f"- effort: {text}" for text in _efforts(analysis, module, dof)]
    if dof.inertia is not None:
        felt = "kg*m^2" if revolute else "kg"
        lines.append(f"- rotor: {to_float(dof.inertia):.6g} {felt} on the diagonal of M")
    if dof.coulomb is not None:
        effort = "N*m" if revolute else "N"
        lines.append(f"- dry friction: {to_float(dof.coulomb):.6g} {effort} against its motion")
    return "\n".join(lines)


def _efforts(analysis: Analysis, module: ir.Module, dof: ir.Dof) -> list[str]:
    """The bounds of the input: its own, then those of each task."""
    program = analysis.program
    unit = "N*m" if dof.kind == "revolute" else "N"
    found: list[str] = []
    if dof.effort is not None:
        found.append(f"at most {to_float(dof.effort):.6g} {unit}")
    for task in () if program is None else program.tasks.values():
        grammar = None if program is None else program.grammars.get(task.grammar)
        names = {x.name for p in (grammar.productions if grammar else ()) for x in p.right}
        for effort in task.effort:
            if module.name in names and effort.kind == dof.kind:
                norm = ", the Euclidean norm of all inputs" if effort.norm2 else ""
                bound = number_text(effort.bound)
                found.append(f"at most {bound} {unit} in task `{task.name}`{norm}")
    return found


# --- Grammars ----------------------------------------------------------------------------------


def _nonterminal(analysis: Analysis, entity: Entity) -> str:
    number = len(analysis.names.declarations(entity))
    grammar = analysis.declared.grammars[entity.scope[0]]
    productions = [p for p in grammar.items if isinstance(p, s.Production)]
    lines = [written(p.span, analysis.sources) for p in productions if p.left.text == entity.name]
    rules = "\n".join(f"{line};" for line in lines if line)
    many = f"{number} production{'s' * (number != 1)}"
    return f"{_code(rules)}\n\nA nonterminal of `{grammar.name.text}` with {many}."


def _occurrence(analysis: Analysis, entity: Entity) -> str:
    symbol = (written(entity.statement, analysis.sources) or "").partition(":")[2].strip(" '\"")
    return f"The occurrence of `{symbol}` called `{entity.name}` in `{entity.scope[1]}`."


def _attribute(analysis: Analysis, entity: Entity) -> str:
    grammar, nonterminal = entity.scope
    lines = []
    for mention in analysis.names.declarations(entity)[:8]:
        text = analysis.sources[mention.span.file].text
        line = text[text.rfind("\n", 0, mention.span.start) + 1 :].partition("\n")[0].strip()
        lines.append(line)
    uses = _uses(analysis, entity)
    rules = _code("\n".join(lines))
    return f"{rules}\n\nAn attribute of `{nonterminal}` in `{grammar}`, {uses}."


def _port_type(analysis: Analysis, entity: Entity) -> str:
    """The ports of a type, by module."""
    lines: list[str] = []
    for name, module in analysis.declared.modules.items():
        ports = (p for p in module.items if isinstance(p, s.Port) and p.type.text == entity.name)
        lines += [f"{name}: {written(port.span, analysis.sources)}" for port in ports]
    return f"{_code(chr(10).join(lines))}\n\nA type of ports."


def _local_value(analysis: Analysis, entity: Entity) -> str:
    about = f"A local value of `{entity.scope[1]}`, {_uses(analysis, entity)}."
    return f"{_statement(analysis, entity)}\n\n{about}"


def _production(analysis: Analysis, entity: Entity) -> str:
    grammar = entity.scope[0]
    text = f"{_statement(analysis, entity)}\n\nA production of `{grammar}`."
    program = analysis.program
    lowered = None if program is None else program.grammars.get(grammar)
    if program is None or lowered is None:
        return text
    added = added_physics(program, lowered, entity.name)
    if added is None:
        return f"{text}\n\nWhat it adds is not known: the semantics is missing or has errors."
    return f"{text}\n\n{physics_text(added, _dimension(program, grammar))}"


def _dimension(program: ir.Program, grammar: str) -> int | None:
    """The dimension in which the robots of a grammar move; None unless all tasks agree."""
    found = {
        program.workspaces[task.workspace].dimension
        for task in program.tasks.values()
        if task.grammar == grammar and task.workspace in program.workspaces
    }
    return found.pop() if len(found) == 1 else None


def _grammar(analysis: Analysis, entity: Entity) -> str:
    grammar = analysis.declared.grammars[entity.name]
    if grammar.from_ports:
        return _port_grammar(analysis, grammar)
    productions = sum(isinstance(item, s.Production) for item in grammar.items)
    start = next((i.name.text for i in grammar.items if isinstance(i, s.StartSymbol)), "?")
    accepts = [i for i in grammar.items if isinstance(i, s.Accept)]
    lines = [f"{written(item.span, analysis.sources)};" for item in accepts]
    known = "with" if entity.name in analysis.declared.semantics else "without"
    text = f"A grammar of {productions} productions from `{start}`, {known} semantics."
    return f"{_code(chr(10).join(lines))}\n\n{text}" if lines else text


def _port_grammar(analysis: Analysis, grammar: s.Grammar) -> str:
    """The productions that a grammar from ports stands for."""
    name, program = grammar.name.text, analysis.program
    lowered = None if program is None else program.grammars.get(name)
    productions = () if lowered is None else lowered.productions
    lines = [
        f"{each.label}: {each.left} -> {' '.join(symbol.name for symbol in each.right)};"
        for each in productions[:_MOST_PRODUCTIONS]
    ]
    if len(productions) > len(lines):
        lines.append(f"// {len(productions) - len(lines)} more")
    text = "A grammar from ports; `srgc expand` prints what it stands for."
    return f"{_code(chr(10).join(lines))}\n\n{text}" if lines else text


# --- Workspaces, tasks and missions ------------------------------------------------------------


def _workspace(analysis: Analysis, entity: Entity) -> str:
    program, uses = analysis.program, _uses(analysis, entity)
    workspace = None if program is None else program.workspaces.get(entity.name)
    if workspace is None:
        return f"A workspace, {uses}."
    kind = "plane" if workspace.dimension == 2 else "space"
    names = ", ".join(f"`{region.name}`" for region in workspace.regions)
    return f"A workspace in the {kind}: {names or 'no regions'}; {uses}."


def _region(analysis: Analysis, entity: Entity) -> str:
    program, workspace = analysis.program, entity.scope[0]
    lowered = None if program is None else program.workspaces.get(workspace)
    regions = () if lowered is None else lowered.regions
    region = next((r for r in regions if r.name == entity.name), None)
    detail = "" if region is None or lowered is None else region_text(region, lowered.dimension)
    about = f"Of workspace `{workspace}`, {_uses(analysis, entity)}."
    return "\n\n".join(part for part in (_statement(analysis, entity), detail, about) if part)


def _map(analysis: Analysis, entity: Entity) -> str:
    of, uses = f"of the map `{entity.name}` of `{entity.scope[0]}`", _uses(analysis, entity)
    return f"All obstacles {of}, {uses}."


def _task(analysis: Analysis, entity: Entity) -> str:
    program = analysis.program
    task = None if program is None else program.tasks.get(entity.name)
    return _unread(entity) if task is None else task_text(task)


def _mission(analysis: Analysis, entity: Entity) -> str:
    program = analysis.program
    mission = None if program is None else program.missions.get(entity.name)
    if program is None or mission is None:
        return _unread(entity)
    return mission_text(mission, program)


def _unread(entity: Entity) -> str:
    """The text for an item with errors: its kind and its name."""
    text = described(entity)
    return f"{text[:1].upper()}{text[1:]}."


# --- The box, the area or volume and the corners of a region --------------------------------------


_MOST_ROWS = 60
"""Regions with more rows or points are not measured while an editor waits."""


def region_text(region: ir.Region, dimension: int) -> str:
    """The description of a region, as Markdown."""
    shape = region.shape
    kind = f"A{'n' if region.kind == 'obstacle' else ''} {region.kind}"
    if isinstance(shape, ir.Round):
        ends = " and ".join(f"({', '.join(map(number_text, point))})" for point in shape.points)
        return f"{kind}: a {shape.kind} of radius {number_text(shape.radius)} m about {ends} m."
    size = len(shape.rows if isinstance(shape, ir.Inequalities) else shape.points)
    if size > _MOST_ROWS:
        return f"{kind} of {size} rows."
    from compiler.workspaces.polytope import polytope_of

    polytope = polytope_of(shape, dimension)
    if polytope.is_empty:
        return f"{kind} that is empty."
    if not polytope.is_bounded:
        return f"{kind} without bounds."
    corners = polytope.vertices
    sides = [(min(each), max(each)) for each in zip(*corners, strict=True)]
    box = " x ".join(f"[{number_text(low)}, {number_text(high)}]" for low, high in sides)
    volume = polytope.volume
    unit, name = ("m^2", "area") if dimension == 2 else ("m^3", "volume")
    exact, near = number_text(volume), rounded(float(volume))
    shown = exact if exact == near else f"{exact} ≈ {near}"
    where = "plane" if dimension == 2 else "space"
    measures = f"- bounding box: {box} m\n- {name}: {shown} {unit}"
    return f"{kind} in the {where} with {len(corners)} corners.\n\n{measures}"
