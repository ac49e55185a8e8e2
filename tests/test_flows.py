"""The page of the architecture names all folders, and its flows are what a traced run does.

A step of a flow names a file and a function of it.  The order of a flow is that in which its
functions are first entered by the command of the flow; modules and classes that are being loaded,
and what they call meanwhile, do not count.
"""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path

import pytest

from tests.oracles.small_specs import TURNER, replaced

ROOT = Path(__file__).parents[1]
PAGE = (ROOT / "docs" / "explanation" / "architecture.md").read_text(encoding="utf-8")
PACKAGES = ("grammar_lang", "compiler", "solvers", "srgc")
STEP = re.compile(r"^\d+\. `([\w/]+\.py)` \(`([\w.]+)`\)", re.MULTILINE)
FLOWS = {
    "From text to an automaton": "graph",
    "A length from text to certificate": "synth",
    "How `synth` decides": "synth",
    "How `verify` checks one effort bound": "verify",
}
ONE_LINK = replaced(
    TURNER, "accept contains EN and starts with B eps JO;", "accept matches B eps JO eps L eps EN;"
)
"""Its first structure has a length, so that a length meets each function before any other does."""
TRACE = """
import json, sys
from pathlib import Path
from srgc.cli import run

root, folder = f"{Path.cwd()}/", Path(sys.argv[1])
packages = ("grammar_lang", "compiler", "solvers", "srgc")
names, loading = {}, 0

def entered(frame, event, argument):
    global loading
    code = frame.f_code
    if code.co_name == "<module>":
        loading += (event == "call") - (event == "return")
    elif event == "call" and not loading and code not in names:
        file = code.co_filename.removeprefix(root)
        if file.split("/")[0] in packages:
            names[code] = file, code.co_qualname

traces = {}
for command, *arguments in (
    ("graph", folder / "arm.srg", "--of", "sra", "-o", folder / "sra.dot"),
    ("synth", folder / "arm.srg", "-o", folder / "arm"),
    ("verify", folder / "arm"),
):
    names.clear()
    sys.setprofile(entered)
    status = run([command, *map(str, arguments)])
    sys.setprofile(None)
    assert status == 0, command
    traces[command] = list(names.values())
(folder / "traces.json").write_text(json.dumps(traces))
"""


def section(heading: str) -> str:
    """The text of the page below a heading."""
    pattern = rf"^#+ {re.escape(heading)}\n(.*?)(?=^#|\Z)"
    [text] = re.findall(pattern, PAGE, re.MULTILINE | re.DOTALL)
    return str(text)


@pytest.fixture(scope="module")
def traces(tmp_path_factory: pytest.TempPathFactory) -> dict[str, list[tuple[str, str]]]:
    """By command the file and the name of each function, in the order of their first entries."""
    folder = tmp_path_factory.mktemp("flows")
    (folder / "arm.srg").write_text(ONE_LINK, encoding="utf-8")
    command = [sys.executable, "-c", TRACE, str(folder)]
    run = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    read = json.loads((folder / "traces.json").read_text(encoding="utf-8"))
    return {name: [(file, function) for file, function in trace] for name, trace in read.items()}


@pytest.mark.parametrize("heading", FLOWS)
def test_a_flow_is_what_a_traced_run_does(
    heading: str, traces: dict[str, list[tuple[str, str]]]
) -> None:
    trace, text = traces[FLOWS[heading]], section(heading)
    steps = STEP.findall(text)
    assert 6 <= len(steps) == len(re.findall(r"^\d+\. ", text, re.MULTILINE))
    assert [step for step in steps if step not in trace] == []
    assert sorted(steps, key=trace.index) == steps


def test_the_page_has_these_flows() -> None:
    assert re.findall("^### (.*)$", PAGE, re.MULTILINE) == [*FLOWS]


@pytest.mark.parametrize("package", PACKAGES)
def test_the_page_names_the_folders(package: str) -> None:
    _, _, table = section("The folders of each package").partition(f"| `{package}/` | contents |\n")
    named = re.findall(r"^\| `([\w/]+)` \|", table.partition("\n\n")[0], re.MULTILINE)
    inits = (ROOT / package).glob("**/*/__init__.py")
    assert sorted(named) == sorted(str(i.parent.relative_to(ROOT / package)) for i in inits)
