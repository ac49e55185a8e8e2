"""The notebooks run from top to bottom, and everything in them shows itself."""

from __future__ import annotations

import asyncio
import json
import os
from pathlib import Path

import pytest

# nbformat takes seconds to load, in every worker that collects this file: tests load it.

ROOT = Path(__file__).parents[1]
NOTEBOOKS = sorted(ROOT.glob("notebooks/*.ipynb"))
SECONDS = 300


def test_there_are_three():
    assert [path.stem for path in NOTEBOOKS] == [
        "design_your_own_robot",
        "paper_step_by_step",
        "tutorial_in_python",
    ]


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_is_kept_without_outputs(path):
    book = json.loads(path.read_text(encoding="utf-8"))
    code = [cell for cell in book["cells"] if cell["cell_type"] == "code"]
    assert all(cell["outputs"] == [] and cell["execution_count"] is None for cell in code)
    assert book["metadata"]["kernelspec"]["name"] == "python3"
    assert any("assert " in line for cell in code for line in cell["source"])


@pytest.fixture
def run(tmp_path, monkeypatch):
    """Execute a notebook in a folder of its own, by the kernel of this interpreter."""
    monkeypatch.setenv("PYTHONPATH", str(ROOT))
    monkeypatch.setenv("IPYTHONDIR", str(tmp_path / "ipython"))
    monkeypatch.setenv("JUPYTER_RUNTIME_DIR", str(tmp_path / "runtime"))
    folder = tmp_path / "work"
    folder.mkdir()

    from nbclient import NotebookClient

    def execute(book):
        client = NotebookClient(
            book,
            timeout=SECONDS,
            kernel_name="python3",
            resources={"metadata": {"path": str(folder)}},
        )
        asyncio.run(client.async_execute(env=dict(os.environ)))
        return book, sorted(folder.iterdir())

    return execute


@pytest.mark.site
@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs(path, run):
    import nbformat

    book = nbformat.read(path, as_version=4)
    nbformat.validate(book)
    book, left = run(book)
    assert left == []
    outputs = [output for cell in book.cells for output in cell.get("outputs", ())]
    kinds = {output.output_type for output in outputs}
    assert kinds <= {"execute_result", "stream", "display_data"}  # charts, and progress
    assert not [output.text for output in outputs if output.get("name") == "stderr"]
    shown = [output.data for output in outputs if output.output_type == "execute_result"]
    assert sum("text/html" in data for data in shown) >= 8
    for data in shown:
        assert data["text/plain"].strip()
        assert "/tmp" not in data["text/plain"]


@pytest.mark.site
def test_a_failing_cell_is_noticed(run):
    import nbformat

    book = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell("assert 1 + 1 == 3")])
    with pytest.raises(Exception, match="AssertionError"):
        run(book)
