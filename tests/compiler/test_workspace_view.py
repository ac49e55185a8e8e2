import re

from compiler.views.dot import to_dot
from compiler.views.workspace_view import workspace_view
from compiler.workspaces.abstraction import Abstraction, abstract
from compiler.workspaces.bisection import bisections
from grammar_lang.ir import Workspace
from tests.oracles.planes import bench, box


def workspace_dot(abstraction: Abstraction, workspace: Workspace) -> str:
    return to_dot(workspace_view(abstraction, workspace))


def test_nodes_edges_and_colours_of_the_running_example():
    workspace = bench()
    abstraction = abstract(workspace)
    text = workspace_dot(abstraction, workspace)
    nodes = dict(re.findall(r'^  "([^"]+)" \[.*fillcolor="(#\w+)"', text, re.MULTILINE))
    assert list(nodes) == [cell.name for cell in abstraction.cells]
    assert len({nodes[name] for name in ("O", "T", "S", "free.1")}) == 4
    assert len({colour for name, colour in nodes.items() if name.startswith("free")}) == 1
    drawn = set(re.findall(r'^  "([^"]+)" -- "([^"]+)";$', text, re.MULTILINE))
    cells = abstraction.cells
    assert drawn == {(cells[i].name, cells[j].name) for i, j in abstraction.adjacency}
    assert text == workspace_dot(abstract(bench()), bench())
    (x, y) = re.search(r'"O" \[label="O", pos="([\d.]+),([\d.]+)!"', text).groups()
    assert (float(x), float(y)) == (2.35 * 9 / 5, 2.5 * 9 / 5)


def test_names_are_escaped():
    workspace = Workspace(
        'a"b\\c', 2, box("bounds", "bounds", (0, 2), (0, 1)), (box('q"', "region", (0, 1), (0, 1)),)
    )
    text = workspace_dot(abstract(workspace), workspace)
    assert text.startswith('graph "a\\"b\\\\c" {\n')
    assert '"q\\"" -- "free";' in text


def test_space_is_drawn_obliquely():
    workspace = Workspace("W", 3, box("bounds", "bounds", (0, 1), (0, 1), (0, 1)), ())
    assert 'pos="4.5000,4.5000!"' in workspace_dot(abstract(workspace), workspace)


def test_a_cell_in_several_regions_says_so_and_every_cell_its_size():
    regions = (box("A", "region", (0, 2), (0, 1)), box("O", "obstacle", (1, 2), (0, 1)))
    workspace = Workspace("W", 2, box("bounds", "bounds", (0, 3), (0, 1)), regions)
    text = workspace_dot(abstract(workspace), workspace)
    assert r'"O" [label="O\n{A, O}"' in text
    assert '"A" [label="A", ' in text
    assert 'tooltip="1 m^2: ' in text


def test_a_picture_of_many_cells_is_larger():
    workspace = bench()
    abstraction = abstract(workspace)
    finer = abstraction.cut(bisections(abstraction, 400))
    places = re.findall(r'pos="([\d.]+),', workspace_dot(finer, workspace))
    assert 20 < max(map(float, places)) < 22
