"""From the unit cube to parameters and their domains."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from solvers.parameters.parameter_search import ParameterSpace, parameter_space
from tests.oracles.robots import rod_chain

LENGTHS = np.array([0.2, 0.5, 0.9])
SPACE = ParameterSpace(np.array([-1.0, 0.2, 3.0]), np.array([2.0, 0.9, 3.0]), (None, LENGTHS, None))
coordinates = st.lists(st.floats(0, 1), min_size=3, max_size=3)


@given(coordinates)
def test_points_become_members_of_the_domains(point) -> None:
    theta = SPACE.from_cube(np.array(point))
    assert -1 <= theta[0] <= 2
    assert theta[1] in LENGTHS
    assert theta[2] == 3
    nearest = SPACE.cube.nearest(np.array(point))
    np.testing.assert_array_equal(SPACE.from_cube(nearest), theta)


def test_the_cube_of_a_space() -> None:
    assert SPACE.cube.levels == (None, 3, 1)
    assert SPACE.cube.size is None
    assert not SPACE.is_point
    middles = SPACE.cube.nearest(np.array([[0.3, 0.0, 0.9], [0.3, 0.34, 0.1], [0.3, 1.0, 0.0]]))
    np.testing.assert_allclose(middles, [[0.3, 1 / 6, 0.5], [0.3, 0.5, 0.5], [0.3, 5 / 6, 0.5]])


@given(coordinates)
def test_parameters_are_found_in_the_cube_again(point) -> None:
    nearest = SPACE.cube.nearest(np.array(point))
    np.testing.assert_allclose(SPACE.to_cube(SPACE.from_cube(nearest)), nearest, atol=1e-12)


@given(st.floats(-1e3, 1e3), st.floats(0, 1e3), st.floats(0, 1))
def test_rounding_never_leaves_an_interval(low, width, at) -> None:
    space = ParameterSpace(np.array([low]), np.array([low + width]), (None,))
    for point in (at, 0.0, 1.0):
        assert low <= space.from_cube(np.array([point]))[0] <= low + width


def test_samples_fill_the_space() -> None:
    samples = np.array(SPACE.samples(6, 1))
    assert samples.shape == (64, 3)
    assert {float(value) for value in samples[:, 1]} == set(LENGTHS.tolist())
    # 64 points of base 2 on the first axis: one in every 64th.
    assert sorted(np.floor((samples[:, 0] + 1) / 3 * 64).astype(int)) == list(range(64))
    np.testing.assert_array_equal(np.array(SPACE.samples(6, 1)), samples)
    fixed = ParameterSpace(np.array([2.0]), np.array([2.0]), (None,))
    assert [list(theta) for theta in fixed.samples(6, 1)] == [[2.0]]


def test_the_space_of_a_robot() -> None:
    space = parameter_space(rod_chain(2))
    np.testing.assert_array_equal(space.lower, [0.5, 0.5])
    np.testing.assert_array_equal(space.upper, [5.0, 5.0])
    assert space.cube.levels == (None, None)
    lower, upper = SPACE.free_box(np.array([0.5, 0.5, 3.0]))
    np.testing.assert_array_equal(lower, [-1.0, 0.5, 3.0])
    np.testing.assert_array_equal(upper, [2.0, 0.5, 3.0])
    fixed = np.array([3.0])
    assert ParameterSpace(fixed, fixed, (None,)).free_box(fixed) is None


def test_draws_are_members_of_the_domains() -> None:
    rng = np.random.default_rng(1)
    drawn = np.array([SPACE.drawn(rng) for _ in range(40)])
    assert {float(value) for value in drawn[:, 1]} == set(LENGTHS.tolist())
    for theta in (*drawn, *SPACE.uniform(rng, 40)):
        assert np.all((SPACE.lower <= theta) & (theta <= SPACE.upper))
