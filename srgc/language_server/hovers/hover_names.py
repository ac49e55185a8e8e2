"""What a name stands for, as Markdown."""

from __future__ import annotations

from grammar_lang import ir
from grammar_lang import syntax as s
from grammar_lang import syntax_tasks as t
from grammar_lang.ir.expression_text import number_text
from grammar_lang.source import written
from srgc.language_server.documents.analysis import Analysis
from srgc.language_server.documents.places import described
from srgc.language_server.hovers.production_physics import added_physics, physics_text
from srgc.language_server.hovers.quantity_text import closed_text, domain_text, rounded
from srgc.language_server.names.declared import module_names
from srgc.language_server.names.names import Key


def _code(text: str) -> str:
    return f"```srg\n{text}\n```"


def _uses(analysis: Analysis, key: Key) -> str:
    number = sum(not mark.defines for mark in analysis.names.of(key))
    return "used nowhere" if not number else f"used {number} time{'s' * (number > 1)}"


def hover_name(analysis: Analysis, key: Key) -> str:
    """The text about a thing."""
    makers = {
        "terminal": _terminal,
        "nonterminal": _nonterminal,
        "label": _production,
        "occurrence": _occurrence,
        "member": _member,
        "attribute": _attribute,
        "grammar": _grammar,
        "workspace": _workspace,
        "region": _region,
        "map": _map,
        "task": _task,
    }
    return makers[key.kind](analysis, key)


# --- modules -----------------------------------------------------------------------------------


def _terminal(analysis: Analysis, key: Key) -> str:
    module = analysis.declared.modules.get(key.name)
    if module is None:
        return f"{_code(f'edge {key.name}')}\n\nAn edge label, {_uses(analysis, key)}."
    statements = (written(item.span, analysis.sources) for item in module.items)
    lines = "".join(f"\n  {line};" for line in statements if line)
    text = f"module {key.name} {{{lines}\n}}" if lines else f"module {key.name} {{ }}"
    return f"{_code(text)}\n\nA module, {_uses(analysis, key)}."


def _module(analysis: Analysis, name: str) -> ir.Module | None:
    return None if analysis.program is None else analysis.program.modules.get(name)


def _member(analysis: Analysis, key: Key) -> str:
    module = analysis.declared.modules[key.scope[0]]
    item = module_names(module)[key.name]
    head = _code(written(item.span, analysis.sources) or key.name)
    lowered = _module(analysis, key.scope[0])
    detail = "" if lowered is None else _member_detail(analysis, lowered, key.name, item)
    about = f"Of module `{key.scope[0]}`, {_uses(analysis, key)}."
    return "\n\n".join(part for part in (head, detail, about) if part)


def _member_detail(analysis: Analysis, module: ir.Module, name: str, item: s.ModuleItem) -> str:
    match item:
        case s.Param():
            found = next((p for p in module.parameters if p.name == name), None)
            return "" if found is None else _parameter(found)
        case s.Dof():
            dof = next((d for d in module.dofs if d.name == name), None)
            return "" if dof is None else _dof(analysis, module, dof)
        case s.State():
            state = next((each for each in module.states if each.name == name), None)
            if state is None:
                return ""
            start = "0" if state.initial is None else closed_text(state.initial)
            return f"A state, in {_unit(state.unit)}; {start} at first."
        case s.Input():
            given = next((each for each in module.inputs if each.name == name), None)
            return "" if given is None else f"An input in {domain_text(given.domain, given.unit)}."
        case s.Const():
            return "A constant."
        case _:
            return ""


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
    if dof not in module.free_dofs:
        lines.append("- effort: by the module's own `torque`, no free input")
    else:
        lines += [f"- effort: {text}" for text in _efforts(analysis, module, dof)]
    return "\n".join(lines)


def _efforts(analysis: Analysis, module: ir.Module, dof: ir.Dof) -> list[str]:
    """The bounds of the input, task by task."""
    program = analysis.program
    unit = "N*m" if dof.kind == "revolute" else "N"
    found: list[str] = []
    for task in () if program is None else program.tasks.values():
        grammar = None if program is None else program.grammars.get(task.grammar)
        names = {x.name for p in (grammar.productions if grammar else ()) for x in p.right}
        for effort in task.effort:
            if module.name in names and effort.kind == dof.kind:
                norm = ", the Euclidean norm of all inputs" if effort.norm2 else ""
                bound = number_text(effort.bound)
                found.append(f"at most {bound} {unit} in task `{task.name}`{norm}")
    return found


# --- grammars ----------------------------------------------------------------------------------


def _nonterminal(analysis: Analysis, key: Key) -> str:
    marks = analysis.names.definitions(key)
    grammar = analysis.declared.grammars[key.scope[0]]
    productions = [p for p in grammar.items if isinstance(p, s.Production)]
    lines = [written(p.span, analysis.sources) for p in productions if p.left.text == key.name]
    rules = "\n".join(f"{line};" for line in lines if line)
    many = f"{len(marks)} production{'s' * (len(marks) != 1)}"
    return f"{_code(rules)}\n\nA nonterminal of `{key.scope[0]}` with {many}."


def _occurrence(analysis: Analysis, key: Key) -> str:
    grammar = analysis.declared.grammars[key.scope[0]]
    for item in grammar.items:
        if isinstance(item, s.Production) and item.label.text == key.scope[1]:
            for each in item.right:
                if each.alias is not None and each.alias.text == key.name:
                    which = f"`{each.symbol.text}` called `{key.name}`"
                    return f"The occurrence of {which} in `{key.scope[1]}`."
    return f"An occurrence called `{key.name}`."


def _attribute(analysis: Analysis, key: Key) -> str:
    marks = analysis.names.definitions(key)
    grammar, nonterminal = key.scope
    lines = []
    for mark in marks[:8]:
        text = analysis.sources[mark.span.file].text
        line = text[text.rfind("\n", 0, mark.span.start) + 1 :].partition("\n")[0].strip()
        lines.append(line)
    rules = _code("\n".join(lines))
    return f"{rules}\n\nAn attribute of `{nonterminal}` in `{grammar}`, {_uses(analysis, key)}."


def _production(analysis: Analysis, key: Key) -> str:
    grammar = analysis.declared.grammars[key.scope[0]]
    items = (i for i in grammar.items if isinstance(i, s.Production) and i.label.text == key.name)
    production = next(items, None)
    head = "" if production is None else written(production.span, analysis.sources) or ""
    text = f"{_code(head)}\n\nA production of `{key.scope[0]}`."
    program = analysis.program
    lowered = None if program is None else program.grammars.get(key.scope[0])
    if program is None or lowered is None:
        return text
    added = added_physics(program, lowered, key.name)
    if added is None:
        return f"{text}\n\nWhat it adds is not known: the semantics is missing or has errors."
    return f"{text}\n\n{physics_text(added, _dimension(program, key.scope[0]))}"


def _dimension(program: ir.Program, grammar: str) -> int | None:
    """The dimension in which the robots of a grammar move, where all tasks agree."""
    found = {
        program.workspaces[task.workspace].dimension
        for task in program.tasks.values()
        if task.grammar == grammar and task.workspace in program.workspaces
    }
    return found.pop() if len(found) == 1 else None


def _grammar(analysis: Analysis, key: Key) -> str:
    grammar = analysis.declared.grammars[key.name]
    productions = sum(isinstance(item, s.Production) for item in grammar.items)
    start = next((i.name.text for i in grammar.items if isinstance(i, s.StartSymbol)), "?")
    accepts = [i for i in grammar.items if isinstance(i, s.Accept)]
    lines = [f"{written(item.span, analysis.sources)};" for item in accepts]
    known = "with" if key.name in analysis.declared.semantics else "without"
    text = f"A grammar of {productions} productions from `{start}`, {known} semantics."
    return f"{_code(chr(10).join(lines))}\n\n{text}" if lines else text


# --- workspaces and tasks ----------------------------------------------------------------------


def _workspace(analysis: Analysis, key: Key) -> str:
    program = analysis.program
    workspace = None if program is None else program.workspaces.get(key.name)
    if workspace is None:
        return f"A workspace, {_uses(analysis, key)}."
    kind = "plane" if workspace.dimension == 2 else "space"
    names = ", ".join(f"`{region.name}`" for region in workspace.regions)
    return f"A workspace in the {kind}: {names or 'no regions'}; {_uses(analysis, key)}."


def _region(analysis: Analysis, key: Key) -> str:
    from srgc.language_server.hovers.region_sizes import region_text

    workspace = analysis.declared.workspaces[key.scope[0]]
    regions_written = (item for item in workspace.items if isinstance(item, t.Region))
    item = next(i for i in regions_written if i.name is not None and i.name.text == key.name)
    head = _code(written(item.span, analysis.sources) or key.name)
    program = analysis.program
    lowered = None if program is None else program.workspaces.get(key.scope[0])
    regions = () if lowered is None else lowered.regions
    region = next((r for r in regions if r.name == key.name), None)
    detail = "" if region is None or lowered is None else region_text(region, lowered.dimension)
    about = f"Of workspace `{key.scope[0]}`, {_uses(analysis, key)}."
    return "\n\n".join(part for part in (head, detail, about) if part)


def _map(analysis: Analysis, key: Key) -> str:
    return f"All obstacles of the map `{key.name}` of `{key.scope[0]}`, {_uses(analysis, key)}."


def _task(analysis: Analysis, key: Key) -> str:
    program = analysis.program
    task = None if program is None else program.tasks.get(key.name)
    if task is None:
        return f"{described(analysis, key).capitalize()}."
    end = rounded(float(task.steps * task.step))
    step = rounded(float(task.step))
    lines = [
        f"A task for robots of `{task.grammar}` in `{task.workspace}`.",
        "",
        f"- horizon: {task.steps} steps of {step} s, T = {end} s",
    ]
    for effort in task.effort:
        unit = "N*m" if effort.kind == "revolute" else "N"
        norm = " (Euclidean norm)" if effort.norm2 else ""
        bound = f"{number_text(effort.bound)} {unit}{norm}"
        lines.append(f"- effort of {effort.kind} joints: at most {bound}")
    if task.modules is not None:
        lines.append(f"- at most {task.modules} modules")
    if any(task.gravity):
        gravity = ", ".join(number_text(each) for each in task.gravity)
        lines.append(f"- gravity: ({gravity}) m/s^2")
    return "\n".join(lines)
