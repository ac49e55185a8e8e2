"""Charts of a motion: what matplotlib holds against the arrays and the bounds of the spec."""

from __future__ import annotations

import sys

import matplotlib as mpl
import numpy as np
import pytest

import srgc


@pytest.fixture
def motion(made):
    mpl.use("Agg")
    yield srgc.open_result(made("turner") / "out").trajectory
    from matplotlib import pyplot

    pyplot.close("all")


def data(line):
    return np.array(line.get_xdata()), np.array(line.get_ydata())


def test_each_kind_and_unit_has_a_chart(motion):
    axes = motion.plot()
    assert [each.get_ylabel() for each in axes] == [
        "Coordinates (rad)", "Rates (rad/s)", "Inputs (N*m)",
    ]  # fmt: skip
    assert axes[-1].get_xlabel() == "time (s)"
    coordinates, rates, inputs = (each.get_lines()[0] for each in axes)
    for line, values in ((coordinates, motion.q), (rates, motion.qd)):
        times, drawn = data(line)
        np.testing.assert_array_equal(times, motion.t)
        np.testing.assert_array_equal(drawn, values[:, 0])
    times, drawn = data(inputs)
    np.testing.assert_array_equal(times, motion.t)
    np.testing.assert_array_equal(drawn[:-1], motion.u[:, 0])
    assert inputs.get_drawstyle() == "steps-post"
    assert "at symbol 2" in coordinates.get_label()


def test_bounds_are_dashed(motion):
    """``TURNER`` has a range of 180 degrees to both sides and at most 10 N*m."""
    coordinates, rates, inputs = motion.plot()
    for axes, most in ((coordinates, np.pi), (inputs, 10.0)):
        bounds = axes.get_lines()[1:]
        assert sorted(line.get_ydata()[0] for line in bounds) == pytest.approx([-most, most])
        assert {line.get_linestyle() for line in bounds} == {"--"}
    assert len(rates.get_lines()) == 1


def test_it_draws_on_axes_that_are_given(motion):
    from matplotlib import pyplot

    _, places = pyplot.subplots(3, 1)
    assert motion.plot(places) == tuple(places)
    assert all(len(each.get_lines()) for each in places)
    with pytest.raises(srgc.SrgcError, match=r"`axes` are 3, .*Rates \(rad/s\).*, not 1"):
        motion.plot(places[0])


def test_without_matplotlib_it_says_so(motion, monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    with pytest.raises(srgc.SrgcError, match="`plot` needs matplotlib, which is not") as caught:
        motion.plot()
    assert "pip install matplotlib" in str(caught.value)
