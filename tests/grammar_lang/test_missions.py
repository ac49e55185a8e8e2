"""`mission`: what it means, and what is reported."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path

import pytest

from grammar_lang import ir
from grammar_lang.diagnostics.diagnostic import Code, Diagnostic, Severity, Sink
from grammar_lang.formatting.formatter import canonical
from grammar_lang.load import Loaded, load, load_text
from tests.oracles.loaded_modules import loaded_after
from tests.oracles.small_specs import replaced

TEXT = """\
module B { role base; const price = 5; }
module J { role joint; dof q: revolute z in [-150, 150] deg effort <= 9 N*m; const price = 3; }
module L { role link; param length in [0.5, 1.5] m; param width in {1, 2} cm; const price = 2; }
module E { role effector; const price = 1; }
module Spare { role link; param size in [1, 2] m; }
grammar Arm {
  start N;
  base: N -> B;
  joint: N -> N J;
  link: N -> N L;
  tool: N -> N E;
}
semantics Arm {
  base { this.frame = world; }
  joint { this.frame = N.frame * rot(z, J.q); }
  link {
    this.frame = N.frame * move(x, L.length);
    rod(frame: N.frame, axis: x, length: L.length, density: L.width * 1 kg/m^2);
  }
  tool { this.frame = N.frame; effector(frame: N.frame); }
}
grammar Other { start N; base: N -> B; tool: N -> N E; }
semantics Other {
  base { this.frame = world; }
  tool { this.frame = N.frame; effector(frame: N.frame); point(frame: N.frame, mass: 1 kg); }
}
workspace Table { plane xy; bounds box [-3, 3] x [-3, 3] m; region S box [1, 2] x [0, 1] m; }
workspace Hall { space xyz; bounds box [-3, 3] x [-3, 3] x [-3, 3] m;
  region S box [1, 2] x [0, 1] x [0, 1] m; }
task Morning { robot Arm; workspace Table; start in S; reach S; horizon 20 steps of 0.1 s; }
task Noon { robot Arm; workspace Table; start in S; reach S; horizon at most 9 steps of 0.1 s; }
task Night { robot Arm; workspace Table; start in S; reach S; horizon 9 steps of 0.1 s; }
task Bound { robot Arm; workspace Table; start in S; reach S; horizon 9 steps of 0.1 s;
  effort <= 5 N*m; }
task Tall { robot Arm; workspace Hall; start in S; reach S; horizon 9 steps of 0.1 s; }
task Elsewhere { robot Other; workspace Table; start in S; reach S; horizon 9 steps of 0.1 s; }
task Endless { robot Arm; workspace Table; start in S; satisfy always eventually S;
  horizon 9 steps of 0.1 s; repeat; }
task Again { robot Arm; workspace Table; start in S; reach S; horizon 9 steps of 0.1 s;
  from B J L E fixed L.length = 1 m; }
"""
REBUILT = "tasks Morning, Noon; reconfigure;"


def spec(clauses: str) -> str:
    """The tasks above and a mission."""
    return f"{TEXT}mission Day {{ {clauses} }}\n"


def read(clauses: str) -> ir.Mission:
    found = load_text(spec(clauses), "spec.srg")
    assert found.program is not None, found.diagnostics
    return found.program.missions["Day"]


def of_missions(found: Loaded) -> list[Diagnostic]:
    """The findings but for those about names that are not used."""
    return [each for each in found.diagnostics if each.code is not Code.UNUSED_NAME]


def shown(found: Sequence[Diagnostic], text: str) -> list[tuple[str, str, str]]:
    """Severity and code, message and place."""
    return [
        (f"{each.severity.value} {each.code.value}", each.message, at(text, each)) for each in found
    ]


def at(text: str, found: Diagnostic) -> str:
    return text[found.span.start : found.span.end]


def marked(clauses: str) -> list[tuple[str, str, str]]:
    text = spec(clauses)
    found = of_missions(load_text(text, "spec.srg"))
    assert all(each.hint for each in found)
    return shown(found, text)


def hints(clauses: str) -> list[str]:
    return [each.hint or "" for each in of_missions(load_text(spec(clauses), "spec.srg"))]


def notes(clauses: str) -> list[str]:
    text = spec(clauses)
    found = of_missions(load_text(text, "spec.srg"))
    return [text[span.start : span.end] for each in found for span, _ in each.notes]


# --- what it means -----------------------------------------------------------------------------


def test_one_robot_for_all_tasks() -> None:
    found = read("tasks Noon, Morning; one robot; minimize sum(price) then modules;")
    assert (found.name, found.tasks) == ("Day", ("Noon", "Morning"))
    assert (found.prices, found.free, found.most) == (None, frozenset(), None)
    assert [each.kind for each in found.minimize] == ["sum", "modules"]
    assert dict(found.minimize[0].amounts) == {"B": 5, "J": 3, "L": 2, "E": 1}


def test_prices_that_are_not_written() -> None:
    found = read(REBUILT)
    assert found.prices == ir.Prices(Fraction(1), Fraction(1), Fraction(0))
    assert (found.free, found.most, found.minimize) == (frozenset(), None, ())


def test_what_may_change_and_what_it_costs() -> None:
    found = read(
        "tasks Morning, Noon; reconfigure remove 1/2, add 2 + 3 * 0.1, change (1 - 1);"
        " free L.length, L.width; changes <= 2^3 - 1/3; minimize changes within 5 % then effort;"
    )
    assert found.prices == ir.Prices(add=Fraction(23, 10), remove=Fraction(1, 2))
    assert found.free == {("L", "length"), ("L", "width")}
    assert found.most == Fraction(23, 3)
    assert [(each.kind, each.within) for each in found.minimize] == [
        ("changes", Fraction(1, 20)),
        ("effort", 0),
    ]


def test_zero_is_a_price_and_a_bound() -> None:
    found = read("tasks Morning, Noon; reconfigure add 0, remove 0; changes <= 0;")
    assert found.prices == ir.Prices(add=Fraction(0), remove=Fraction(0))
    assert found.most == 0


def test_one_task_alone() -> None:
    assert read("tasks Morning; one robot;").tasks == ("Morning",)
    assert read("tasks Again; reconfigure;").tasks == ("Again",)


def test_the_first_task_may_have_a_robot_before_it() -> None:
    assert marked("tasks Again, Noon; reconfigure;") == []


def test_several_missions_and_their_order() -> None:
    text = spec("one robot; tasks Morning;") + "mission Week { reconfigure; tasks Noon, Night; }"
    program = load_text(text, "spec.srg").program
    assert program is not None
    assert list(program.missions) == ["Day", "Week"]


def test_a_file_without_missions_has_none() -> None:
    program = load_text(TEXT, "spec.srg").program
    assert program is not None
    assert program.missions == {}


def test_places_of_clauses_and_of_the_tasks() -> None:
    clauses = (
        "tasks Morning, Noon;",
        "reconfigure add 1;",
        "free L.length;",
        "changes <= 2;",
        "minimize changes;",
    )
    text = spec(" ".join(clauses))
    program = load_text(text, "spec.srg").program
    assert program is not None
    mission = program.missions["Day"]
    places = {name: text[span.start : span.end] for name, span in mission.clauses.items()}
    assert list(places) == ["tasks", "reconfigure", "free", "changes", "minimize"]
    assert tuple(places.values()) == clauses
    assert [text[span.start : span.end] for span in mission.named] == ["Morning", "Noon"]
    one = read("one robot; tasks Noon;").clauses["one robot"]
    assert spec("one robot; tasks Noon;")[one.start : one.end] == "one robot;"


def test_a_mission_may_be_called_as_a_task_or_a_module() -> None:
    program = load_text(f"{TEXT}mission Noon {{ tasks Noon; one robot; }}", "spec.srg").program
    assert program is not None
    assert program.missions["Noon"].tasks == ("Noon",)


def test_words_of_missions_are_names_elsewhere() -> None:
    text = """
    module mission { role base; const add = 2; const remove = add; const change = 1;
      const free = remove + change; const one = 1; frame tasks = in;
      point(frame: tasks, mass: 1 kg); }
    module tasks { role effector; param changes in [1, 2]; param free in [1, 2] m; }
    module reconfigure { role link; }
    grammar changes { start one; add: one -> mission; remove: one -> one tasks; }
    semantics changes {
      add { this.free = mission.tasks; mission.in = world; }
      remove { this.free = one.free;
        effector(frame: this.free * move(x, tasks.free * tasks.changes)); }
    }
    workspace free { plane xy; bounds box [0, 9] x [0, 9] m;
      region robot box [0, 1] x [0, 1] m; }
    task tasks { robot changes; workspace free; start in robot; reach robot;
      horizon 1 steps of 1 s; }
    task one { robot changes; workspace free; start in robot; reach robot;
      horizon 1 steps of 1 s; }
    task add { robot changes; workspace free; start in robot; reach robot;
      horizon 1 steps of 1 s; }
    mission mission { tasks tasks, one, add; reconfigure add 1, change 1; changes <= 2;
      free tasks.free, tasks.changes; minimize changes then modules; }
    mission tasks { tasks one; one robot; minimize sum(add); }
    """
    found = load_text(text, "spec.srg")
    assert found.program is not None, found.diagnostics
    assert found.program.missions["mission"].tasks == ("tasks", "one", "add")
    assert found.program.missions["mission"].free == {("tasks", "free"), ("tasks", "changes")}
    assert found.program.missions["tasks"].minimize[0].attribute == "add"


def test_line_ends_do_not_matter() -> None:
    clauses = "tasks Morning,\n Noon;\n one\n robot;\n minimize\n modules;"
    found = read(clauses)
    assert read(clauses.replace("\n", "\r\n")) == found
    wrong = "tasks Morning,\n Noun;\n reconfigure\n add -1;"
    for text in (wrong, wrong.replace("\n", "\r\n")):
        assert [place for _, _, place in marked(text)] == ["Noun", "-1"]


def test_tasks_of_an_included_file(tmp_path: Path) -> None:
    (tmp_path / "tasks.srg").write_text(TEXT, "utf-8")
    main = tmp_path / "main.srg"
    main.write_text(
        'include "tasks.srg";\nmission Day { tasks Morning, Noon; one robot; }', "utf-8"
    )
    program = load(main).program
    assert program is not None
    assert program.missions["Day"].tasks == ("Morning", "Noon")
    main.write_text(
        'include "tasks.srg";\nmission Day { tasks Morning, Tall; one robot; }', "utf-8"
    )
    (found,) = of_missions(load(main))
    assert (found.code, found.span.file) == (Code.OTHER_ROBOTS, 0)
    assert [span.file for span, _ in found.notes] == [1]


def test_the_elaboration_of_missions_is_loaded_for_missions() -> None:
    module = "grammar_lang.elaboration.missions"
    load_one = "from grammar_lang.load import load_text; load_text({!r}, 'spec.srg')"
    assert module not in loaded_after(load_one.format(TEXT))
    assert module in loaded_after(load_one.format(spec(REBUILT)))


def test_the_canonical_text() -> None:
    odd = "tasks  Morning ,Noon;reconfigure  add 2,remove-1 ;free L . length;changes<=3;"
    text = canonical(spec(odd), Sink())
    assert text is not None
    assert (
        "mission Day {\n  tasks Morning, Noon;\n  reconfigure add 2, remove -1;\n"
        "  free L.length;\n  changes <= 3;\n}\n"
    ) in text
    assert canonical(text, Sink()) == text


# --- tasks -------------------------------------------------------------------------------------


def test_a_task_twice() -> None:
    clauses = "tasks Noon, Morning, Noon, Noon; one robot;"
    message = "task `Noon` is listed twice in mission `Day`"
    assert marked(clauses) == [("error SRG0730", message, "Noon")] * 2
    assert notes(clauses) == ["Noon", "Noon"]
    assert hints(clauses)[0].endswith("for a motion that repeats, write `repeat;` in the task")


def test_names_that_are_no_tasks() -> None:
    clauses = "tasks Moning, Table, Nothing, Noon; one robot;"
    assert marked(clauses) == [
        ("error SRG0201", "unknown task `Moning`", "Moning"),
        ("error SRG0203", "`Table` is a workspace, not a task", "Table"),
        ("error SRG0201", "unknown task `Nothing`", "Nothing"),
    ]
    assert hints(clauses)[0] == "did you mean `Morning`?"


def test_no_tasks() -> None:
    for clauses in ("", "one robot;", "reconfigure; minimize changes;"):
        assert marked(clauses) == [("error SRG0733", "mission `Day` has no tasks", "Day")]
        assert hints(clauses) == ["write `tasks A, B;`"]


def test_neither_one_robot_nor_rebuilt() -> None:
    message = "mission `Day` does not say whether one robot does all tasks"
    # What would be a contradiction of one of both is not said.
    for more in ("", "free L.length; changes <= 3; minimize changes;"):
        clauses = f"tasks Morning, Noon; {more}"
        assert marked(clauses) == [("error SRG0701", message, "Day")]
        assert "reconfigure" in hints(clauses)[0]


def test_tasks_of_other_robots() -> None:
    clauses = "tasks Morning, Elsewhere, Noon, Tall; one robot;"
    about = "task `Elsewhere` uses grammar `Other`, but task `Morning` uses `Arm`"
    assert marked(clauses) == [
        ("error SRG0731", about, "Elsewhere"),
        ("error SRG0731", "task `Tall` is in space, the first one is not", "Tall"),
    ]
    assert [note.partition(" {")[0] for note in notes(clauses)] == ["task Morning"] * 2
    assert marked("tasks Tall, Noon; reconfigure;") == [
        ("error SRG0731", "task `Noon` is in the plane, the first one is not", "Noon")
    ]


def test_bounds_of_other_efforts() -> None:
    clauses = "tasks Morning, Bound; reconfigure;"
    message = "task `Bound` bounds the efforts of revolute joints, the first task bounds no efforts"
    assert marked(clauses) == [("error SRG0732", message, "Bound")]
    assert [note.partition(" {")[0] for note in notes(clauses)] == ["task Morning"]
    message = "task `Noon` bounds no efforts, the first task bounds the efforts of revolute joints"
    assert marked("tasks Bound, Noon; one robot;") == [("error SRG0732", message, "Noon")]


def test_tasks_that_say_which_robot_there_is() -> None:
    clauses = "tasks Morning, Again; reconfigure;"
    message = "task `Again` has `from`, but is not the first task"
    assert marked(clauses) == [("error SRG0734", message, "Again")]
    assert notes(clauses) == ["from B J L E fixed L.length = 1 m;"]
    assert "only the first task may have `from`" in hints(clauses)[0]
    clauses = "tasks Again, Morning; one robot;"
    message = "task `Again` rebuilds a robot, but the mission has `one robot`"
    assert marked(clauses) == [("error SRG0734", message, "Again")]


def test_what_is_done_about_a_robot_before_a_task_of_one_robot() -> None:
    """What the hint says is done, and then nothing is wrong; with half of it, something is."""
    first = "remove `from` from the task, or write `reconfigure;` instead of `one robot;`"
    assert hints("tasks Again, Morning; one robot;") == [first]
    assert marked("tasks Again, Morning; reconfigure;") == []
    assert hints("tasks Morning, Again; one robot;") == [f"{first} and name this task first"]
    assert marked("tasks Morning, Again; reconfigure;") != []


def test_what_the_first_task_fixes_is_not_free() -> None:
    clauses = "tasks Again, Morning; reconfigure; free L.length, L.width;"
    message = "`L.length` is free, but task `Again` fixes it"
    assert marked(clauses) == [("error SRG0734", message, "L.length")]
    assert notes(clauses) == ["L.length = 1 m"]
    assert marked("tasks Again, Morning; reconfigure; free L.width;") == []


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("effort <= 5 N*m;", "effort <= -5 N*m;"),
        ("effort <= 5 N*m;", "effort <= 5 N*m; horizon;"),
        ("effort <= 5 N*m;", "effort <= 5 N*m"),
        ("workspace Hall { space xyz;", "workspace Hall {"),
        ("robot Other;", "robot Othr;"),
        ("grammar Other { start N;", "grammar Other { start N"),
    ],
)
def test_of_a_task_with_errors_nothing_more_is_said(old: str, new: str) -> None:
    text = replaced(spec("tasks Morning, Bound, Tall, Elsewhere; reconfigure;"), old, new)
    wrong = text.index("mission")
    before = {d.message for d in of_missions(load_text(text[:wrong], "spec.srg"))}
    found = [d for d in of_missions(load_text(text, "spec.srg")) if d.message not in before]
    named = {"effort": "Bound", "workspace": "Tall"}.get(old.partition(" ")[0], "Elsewhere")
    assert before
    assert sorted(at(text, d) for d in found) == sorted({"Bound", "Tall", "Elsewhere"} - {named})


def test_a_mission_of_a_task_with_errors_is_not_of_the_sound_part() -> None:
    text = replaced(spec("tasks Bound, Night; one robot;"), "effort <= 5 N*m;", "effort <= -5 N*m;")
    found = load_text(text, "spec.srg")
    assert found.program is None
    assert found.sound is not None
    assert found.sound.missions == {}
    assert [each.message for each in of_missions(found)] == ["the effort bound is not positive"]


# --- what may change ---------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("clauses", "code", "message", "place"),
    [
        ("reconfigure add -1;", "SRG0703", "the price of `add` is negative", "-1"),
        ("reconfigure remove 1 - 2;", "SRG0703", "the price of `remove` is negative", "1 - 2"),
        ("changes <= -1; reconfigure;", "SRG0703", "the bound on changes is negative", "-1"),
        ("changes < 3; reconfigure;", "SRG0703", "`changes` takes `<=`, not `<`", "changes < 3;"),
        (
            "reconfigure add 2 m;",
            "SRG0301",
            "expected a plain number or angle, found a length (m)",
            "2 m",
        ),
        ("reconfigure add 1, add 2;", "SRG0702", "a second price of `add`", "add 2"),
        ("reconfigure; one robot;", "SRG0734",
         "`one robot` and `reconfigure` contradict each other", "reconfigure;"),
        ("reconfigure; reconfigure;", "SRG0702", "a second `reconfigure`", "reconfigure;"),
        ("one robot; one robot;", "SRG0702", "a second `one robot`", "one robot;"),
        ("one robot; tasks Night;", "SRG0702", "a second `tasks`", "tasks Night;"),
        ("reconfigure; changes <= 1; changes <= 2;", "SRG0702", "a second `changes`",
         "changes <= 2;"),
        ("reconfigure; free L.length; free L.width;", "SRG0702", "a second `free`",
         "free L.width;"),
        ("one robot; minimize modules; minimize mass;", "SRG0702", "a second `minimize`",
         "minimize mass;"),
        (
            "one robot; free L.length;",
            "SRG0734",
            "`free` without `reconfigure`: nothing is changed",
            "free L.length;",
        ),
        (
            "one robot; changes <= 3;",
            "SRG0734",
            "`changes` without `reconfigure`: nothing is changed",
            "changes <= 3;",
        ),
        (
            "reconfigure add 1, change 2;",
            "SRG0734",
            "`change` has a price, but no parameter is `free`",
            "change 2",
        ),
        ("reconfigure; free K.length;", "SRG0201", "unknown module `K`", "K"),
        ("reconfigure; free Table.S;", "SRG0203", "`Table` is a workspace, not a module", "Table"),
        ("reconfigure; free L.lenght;", "SRG0201", "module `L` has no parameter `lenght`",
         "lenght"),
        (
            "reconfigure; free J.q;",
            "SRG0203",
            "`q` of module `J` is a degree of freedom; parameters are free",
            "q",
        ),
        (
            "reconfigure; free L.price;",
            "SRG0203",
            "`price` of module `L` is no parameter; parameters are free",
            "price",
        ),
        ("reconfigure; free L.length, L.width, L.length;", "SRG0702", "`L.length` is free twice",
         "L.length"),
    ],
)  # fmt: skip
def test_wrong_clauses(clauses: str, code: str, message: str, place: str) -> None:
    assert marked(f"tasks Morning, Noon; {clauses}") == [(f"error {code}", message, place)]


def test_a_misspelt_parameter_has_a_hint() -> None:
    assert hints(f"{REBUILT} free L.lenght;") == ["did you mean `length`?"]
    assert hints(f"{REBUILT} free L.q;") == ["known: `length`, `width`"]
    assert hints(f"{REBUILT} free J.q;") == ["no parameter is declared here"]


def test_what_stands_twice_is_shown() -> None:
    clauses = "tasks Morning, Noon; reconfigure add 1, add 2; free L.width, L.width;"
    assert notes(clauses) == ["add 1", "L.width"]


def test_a_free_parameter_of_a_module_that_no_robot_has() -> None:
    clauses = f"{REBUILT} free Spare.size;"
    message = "no robot of `Arm` has a module `Spare`"
    assert marked(clauses) == [("warning SRG0734", message, "Spare")]
    assert read(clauses).free == {("Spare", "size")}


def test_nothing_to_rebuild() -> None:
    clauses = "tasks Morning; reconfigure;"
    message = "nothing is rebuilt: there is only one task and no existing robot"
    assert marked(clauses) == [("warning SRG0734", message, "reconfigure;")]
    assert "write `from W;` in task `Morning`" in hints(clauses)[0]
    # Of names that are wrong it is not known how many tasks there are.
    assert [code for code, _, _ in marked("tasks Morning, Nothing; reconfigure;")] == [
        "error SRG0201"
    ]


def test_several_mistakes_at_once() -> None:
    clauses = (
        "tasks Morning, Moning, Elsewhere, Noon, Noon; reconfigure add -1, add 2, change 1;"
        " changes >= 2; minimize effort then speed then effort;"
    )
    assert [(code, place) for code, _, place in marked(clauses)] == [
        ("error SRG0201", "Moning"),
        ("error SRG0731", "Elsewhere"),
        ("error SRG0730", "Noon"),
        ("error SRG0703", "-1"),
        ("error SRG0702", "add 2"),
        ("error SRG0734", "change 1"),
        ("error SRG0703", "changes >= 2;"),
        ("error SRG0734", "effort"),
        ("error SRG0720", "speed"),
        ("error SRG0702", "effort"),
    ]


def test_a_mission_twice() -> None:
    text = spec(REBUILT) + "mission Day { tasks Night; one robot; }"
    found = of_missions(load_text(text, "spec.srg"))
    assert [(each.code, at(text, each)) for each in found] == [(Code.DUPLICATE_NAME, "Day")]


# --- what cannot be read -----------------------------------------------------------------------


@pytest.mark.parametrize(
    "clauses",
    [
        "tasks ; one robot;",
        "tasks Morning Noon; one robot;",
        "one; tasks Noon;",
        "tasks Noon, Night; reconfigure add;",
        "tasks Noon, Night; reconfigure add 1 remove 2;",
        "tasks Noon, Night; reconfigure swap 1; free L.length; minimize changes;",
        "tasks Noon, Night; reconfigure change 1; free length;",
        "tasks Noon, Night; reconfigure; changes 3;",
        "tasks Noon; reach S; one robot;",
    ],
)
def test_a_clause_that_cannot_be_read_has_no_followers(clauses: str) -> None:
    text = spec(clauses)
    found = [d for d in load_text(text, "spec.srg").diagnostics if d.severity is Severity.ERROR]
    assert len(found) == 1
    assert found[0].code.value.startswith("SRG01")


# --- what is to be least -----------------------------------------------------------------------

THERE_ARE = "the objectives are `modules`, `mass`, `time`, `energy`, `effort` and `sum(NAME)`"


def test_changes_are_no_objective_of_tasks() -> None:
    text = replaced(TEXT, "effort <= 5 N*m;", "effort <= 5 N*m; minimize changes then effort;")
    found = of_missions(load_text(text, "spec.srg"))
    assert shown(found, text) == [("error SRG0720", "unknown objective `changes`", "changes")]
    assert found[0].hint == f"`changes` belongs to a `mission` with `reconfigure`; {THERE_ARE}"


def test_changes_where_nothing_is_changed() -> None:
    clauses = "tasks Morning, Noon; one robot; minimize modules then changes;"
    message = "`minimize changes` without `reconfigure`: nothing is changed"
    assert marked(clauses) == [("error SRG0734", message, "changes")]


@pytest.mark.parametrize("clause", ["effort", "effort then changes", "sum(price) then mass"])
def test_changes_come_first(clause: str) -> None:
    message = "with `reconfigure` the first objective must be `changes`"
    place = clause.partition(" then ")[0]
    assert marked(f"{REBUILT} minimize {clause};") == [("error SRG0734", message, place)]


def test_names_that_are_no_objective() -> None:
    clauses = f"{REBUILT} minimize chnges then effort;"
    assert marked(clauses) == [("error SRG0720", "unknown objective `chnges`", "chnges")]
    too = "of missions with `reconfigure` also `changes`"
    assert hints(clauses) == [f"did you mean `changes`? {THERE_ARE}; {too}"]
    clauses = "tasks Noon; one robot; minimize sum(prise) then effort(price);"
    assert [(code, place) for code, _, place in marked(clauses)] == [
        ("error SRG0721", "prise"),
        ("error SRG0720", "price"),
    ]


def test_an_objective_twice() -> None:
    for clause, twice in (("changes then effort then changes", "changes"),
                          ("changes then effort then effort", "effort")):  # fmt: skip
        clauses = f"{REBUILT} minimize {clause};"
        assert marked(clauses) == [("error SRG0702", f"a second `{twice}`", twice)]
        assert notes(clauses) == [twice]


def test_time_of_motions_that_do_not_end() -> None:
    for kind in ("time", "energy"):
        clauses = f"tasks Noon, Endless; one robot; minimize {kind};"
        message = f"a motion that goes on for ever has no least {kind}"
        assert marked(clauses) == [("error SRG0727", message, kind)]
        assert notes(clauses) == ["repeat;"]
        assert hints(clauses) == [f"remove `{kind}`, or `repeat;` from `Endless`"]
    assert marked("tasks Noon, Endless; one robot; minimize effort;") == []


def test_time_of_tasks_that_all_take_the_same() -> None:
    clauses = "tasks Morning, Night; reconfigure; minimize changes then time;"
    message = "all motions of a task take the same time"
    assert marked(clauses) == [("warning SRG0726", message, "time")]
    assert marked("tasks Morning, Noon; reconfigure; minimize changes then time;") == []


# --- names -------------------------------------------------------------------------------------


def test_what_a_mission_names_is_known() -> None:
    text = spec(f"{REBUILT} free L.length; minimize changes then sum(price);")
    names = load_text(text, "spec.srg").names
    assert names is not None
    (mission,) = names.entities("mission")
    assert (mission.name, mission.kind) == ("Day", "mission")
    within = [each for each in names.mentions if each.within == mission and not each.declares]
    said = {(text[each.span.start : each.span.end], each.entity.kind) for each in within}
    assert said == {
        ("Morning", "task"),
        ("Noon", "task"),
        ("L", "module"),
        ("length", "parameter"),
        ("price", "constant"),
    }


def test_a_parameter_that_is_only_free_is_used_by_nothing() -> None:
    text = replaced(spec(f"{REBUILT} free L.width;"), "L.width * 1 kg/m^2", "1 kg/m")
    found = load_text(text, "spec.srg").diagnostics
    message = "the parameter `width` of module `L` is never used"
    assert message in [each.message for each in found]
