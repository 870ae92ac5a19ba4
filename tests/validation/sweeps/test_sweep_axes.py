"""What varies in a sweep: axes, layouts, and what is no axis."""

import tracemalloc
from itertools import product
from math import pi
from typing import Any

import numpy as np
import pytest
from scipy.stats import qmc

from tests.helpers import refusals
from validation.parser.runs import LAYOUTS
from validation.sweeps.axes import Axis, Design, axis_from, axis_from_text


def design(*texts: str, **how: Any) -> Design:
    return Design(axes=tuple(map(axis_from_text, texts)), **how)


def points(found: Design) -> Any:
    return np.array([[*found.values_of(index).values()] for index in range(found.size)])


def test_grid_holds_all_combinations_with_the_last_axis_fastest() -> None:
    found = points(design("spin=1,2,3", "mu=0.1", "beta=0.5:0.75:2"))
    assert list(map(tuple, found)) == list(product((1.0, 2.0, 3.0), (0.1,), (0.5, 0.75)))
    # Also where there are more than can be counted in 64 bits.
    huge = design("spin=0:60:4000000000", "mu=0.1:0.3:4000000000", "gamma=0:1:9")
    assert [*huge.values_of(huge.size - 1).values()] == [60.0, 0.3, 1.0]


def test_ends_of_a_range_are_exact_and_steps_even() -> None:
    plain, log = axis_from_text("gamma=-pi/2:90deg:3"), axis_from_text("mu=1e-3:0.7:5:log")
    assert plain.grid == [-pi / 2, 0.0, pi / 2]
    assert [log.at(0), log.at(4)] == [1e-3, 0.7]
    np.testing.assert_allclose(np.diff(np.log(log.grid)), np.log(700.0) / 4, rtol=1e-12)
    for ends in ("1e-300:1e90", "1e90:1e-300"):
        middle = axis_from_text(f"mass={ends}:3:log").at(1)
        assert middle == pytest.approx(1e-105, rel=1e-12, abs=0.0)


@pytest.mark.parametrize("layout", LAYOUTS[1:])
def test_drawn_points_fill_the_ranges_and_depend_on_the_seed_alone(layout: str) -> None:
    texts = ("spin=10:20", "mu=0.01:1:log", "model=1,2,4")
    first, again, other = (
        points(design(*texts, layout=layout, number=300, seed=seed)) for seed in (0, 0, 1)
    )
    assert np.array_equal(first, again)
    assert not np.array_equal(first, other)
    layers = np.unique(np.floor(30.0 * (first[:, 0] - 10.0)))
    assert (len(layers) == 300) == (layout == "latin-hypercube")
    for column, (low, middle, high) in enumerate([(10.0, 15.0, 20.0), (0.01, 0.1, 1.0)]):
        values = first[:, column]
        assert low <= values.min()
        assert values.max() <= high
        assert 0.4 < np.mean(values < middle) < 0.6
    assert set(first[:, 2]) == {1, 2, 4}


def test_sobol_points_go_on_over_blocks_as_one_sequence() -> None:
    found = design("spin=0:1", "gamma=0:1", layout="sobol", number=10_000, seed=3)
    whole = qmc.Sobol(2, rng=3).random(8192 * 2)
    for index in (0, 4095, 4096, 8191, 9999):
        assert [*found.values_of(index).values()] == whole[index].tolist()


def test_memory_does_not_grow_with_the_number_of_cases() -> None:
    tracemalloc.start()
    for found in (
        design("spin=0:60:1000000", "gamma=0:1:1000000"),
        design("spin=0:60", "gamma=0:1", layout="random", number=10**12),
    ):
        for index in (0, found.size // 2, found.size - 1):
            found.values_of(index)
    assert tracemalloc.get_traced_memory()[1] < 500_000
    tracemalloc.stop()


def test_values_and_axes_may_stand_in_any_list() -> None:
    spins = Axis(field="spin", values=np.linspace(10.0, 20.0, 3))  # type: ignore[arg-type]
    found = Design(axes=[spins], layout="random", number=5)  # type: ignore[arg-type]
    assert {type(each) for each in spins.values} == {float}
    assert set(points(found).ravel()) <= {10.0, 15.0, 20.0}


HELD = 2_000_000_000 // np.dtype(float).itemsize
HUGE: dict[str, Any] = {"layout": "latin-hypercube", "number": HELD + 1}


def test_as_many_points_are_drawn_at_once_as_two_gigabytes_hold() -> None:
    assert design("spin=1:2", **HUGE | {"number": HELD}).size == HELD


test_what_is_no_axis_or_no_design_is_refused = refusals(
    {
        "axis must be field=first:last:count": lambda: design("spin"),
        r"^count of axis start\.spin must be at least 1, got 0": lambda: design("spin=1:2:0"),
        r"^axis start\.spin must hold each value once": lambda: design("spin=1,1.0"),
        "must be positive to be logarithmic, got 0 to 1": lambda: design("mu=0:1:3:log"),
        "axis model takes a list": lambda: design("model=1:4:4"),
        "model must be one of 1, 2, 3, 4, got '5'": lambda: design("model=5,1"),
        "axes must be at least one": design,
        r"^axis start\.spin is given twice": lambda: design("spin=1:2:3", "start.spin=4,5"),
        r"^axis start\.spin needs a count on a grid": lambda: design("spin=1:2"),
        rf"^number asks for 2\.5e\+08 samples of 1 numbers each; at most {HELD} are held$": (
            lambda: design("spin=1:2", **HUGE)
        ),
        r"friction\.load must be text, got 1": lambda: axis_from("load", 1),
        r"^values of axis start\.spin must be a list of": lambda: Axis(field="spin", values=5.0),  # type: ignore[arg-type]
        r"^log of axis start\.spin must be True or False": lambda: Axis(
            field="spin",
            first=1.0,
            last=2.0,
            log="no",  # type: ignore[arg-type]
        ),
        "either values, or first and last": lambda: Axis(field="mu", values=(1,), first=0, last=1),
    }
)
