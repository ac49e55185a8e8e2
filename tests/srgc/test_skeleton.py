"""The thin lines of the workspace picture, against the geometry of a turning pole."""

from __future__ import annotations

import numpy as np
import pytest

from grammar_lang.load import load
from solvers.progress import Conduct
from solvers.synthesis import synthesise
from srgc.pictures.figures import _skeletons, input_figure, workspace_figure
from tests.oracles.small_specs import TURNER

POINT = "point(frame: N.frame * move(x, L.length), mass: 1 kg);"
ROD = "rod(frame: N.frame, axis: x, length: L.length, density: L.density);"


@pytest.fixture(scope="module")
def drawn(tmp_path_factory):
    path = tmp_path_factory.mktemp("skeleton") / "spec.srg"
    path.write_text(TURNER.replace(ROD, POINT), encoding="utf-8")
    program = load(path).program
    task = program.tasks["Turn"]
    return program, task, synthesise(program, task, Conduct())


def test_a_point_mass_hangs_on_a_line_from_the_base(drawn):
    _, task, result = drawn
    (length,) = (float(p.value) for p in result.design.parameters)
    angles = result.design.configuration.outcome.trajectory.x[:, 0]
    tips = length * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    for chain in _skeletons(result.design, task):
        np.testing.assert_allclose(chain[:, 0], 0, atol=1e-12)
        np.testing.assert_allclose(chain[:, -1], tips, atol=1e-9)


def test_the_pictures_are_made_twice_alike(drawn):
    program, task, result = drawn
    workspace = program.workspaces["Table"]
    pictures = [workspace_figure(result, result.design, workspace, task) for _ in range(2)]
    assert pictures[0] == pictures[1]
    assert pictures[0].lstrip().startswith("<?xml")
    assert input_figure(result.design, task) == input_figure(result.design, task)
