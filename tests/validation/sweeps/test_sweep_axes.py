"""What varies in a sweep: axes, layouts, and the scenarios of the cases."""

import tracemalloc
from dataclasses import asdict, replace
from itertools import product
from math import pi
from typing import Any

import numpy as np
import pytest
from scipy.stats import qmc

from analysis import (
    MODELS,
    ROUNDED_STEEL_DISK,
    STEEL_DISK,
    Disk,
    Ensemble,
    Scenario,
    SmoothCoulomb,
    Start,
    State,
    Stribeck,
)
from analysis.data.changes import changed, check_field
from analysis.data.disk import STEEL_RING
from analysis.data.names import full_name
from validation.sweeps.axes import LAYOUTS, Axis, Design, axis_from, axis_from_text

PAPER = Scenario()


def grid(*texts: str) -> Design:
    return Design(axes=tuple(map(axis_from_text, texts)))


def drawn(layout: Any, number: int, *texts: str, seed: int = 0) -> Design:
    axes = tuple(map(axis_from_text, texts))
    return Design(axes=axes, layout=layout, number=number, seed=seed)


def points(design: Design) -> Any:
    return np.array([design.case(index) for index in range(design.size)])


def test_grid_holds_all_combinations_with_the_last_axis_fastest() -> None:
    design = grid("spin=0:60:4", "mu=0.3,0.1", "model=1,4")
    expected = list(product([0.0, 20.0, 40.0, 60.0], [0.3, 0.1], [1, 4]))
    assert [design.case(index) for index in range(design.size)] == expected


def test_ends_of_a_range_are_exact_and_steps_even() -> None:
    plain, log = axis_from_text("spin=60:-7.3:9"), axis_from_text("mu=1e-3:0.7:5:log")
    assert [plain.at(0), plain.at(8)] == [60.0, -7.3]
    assert [log.at(0), log.at(4)] == [1e-3, 0.7]
    ratios = [log.between((k + 1) / 4) / log.between(k / 4) for k in range(4)]
    np.testing.assert_allclose(ratios, 700.0 ** (1 / 4), rtol=1e-12)


def test_angles_are_read_as_on_the_command_line() -> None:
    axis = axis_from_text("gamma=-pi/2:90deg:3")
    assert [axis.at(index) for index in range(3)] == [-pi / 2, 0.0, pi / 2]
    assert axis_from_text("beta=pi/2,80deg").values == (pi / 2, 80 * pi / 180)


@pytest.mark.parametrize("layout", LAYOUTS[1:])
def test_drawn_points_fill_the_ranges_and_depend_on_the_seed_alone(layout: str) -> None:
    texts = ("spin=10:20", "mu=0.01:1:log", "model=1,2,4")
    first = points(drawn(layout, 300, *texts))
    assert np.array_equal(first, points(drawn(layout, 300, *texts)))
    assert not np.array_equal(first, points(drawn(layout, 300, *texts, seed=1)))
    assert len(np.unique(first[:, 0])) == 300
    for column, (low, middle, high) in enumerate([(10.0, 15.0, 20.0), (0.01, 0.1, 1.0)]):
        values = first[:, column]
        assert low <= values.min()
        assert values.max() <= high
        assert 0.4 < np.mean(values < middle) < 0.6
    assert set(first[:, 2]) == {1, 2, 4}


def test_latin_hypercube_has_one_point_in_each_layer() -> None:
    layers = np.floor(points(drawn("latin-hypercube", 50, "spin=0:50", "beta_rate=0:50")))
    for column in layers.T:
        assert sorted(column) == list(range(50))


def test_sobol_points_go_on_over_blocks_as_one_sequence() -> None:
    design = drawn("sobol", 10_000, "spin=0:1", "gamma=0:1", seed=3)
    whole = qmc.Sobol(2, rng=3).random(8192 * 2)
    for index in (0, 4095, 4096, 8191, 9999):
        assert design.case(index) == tuple(whole[index])


def test_memory_does_not_grow_with_the_number_of_cases() -> None:
    def peak(design: Design) -> int:
        tracemalloc.start()
        for index in (0, design.size // 2, design.size - 1):
            design.case(index)
        found = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        return found

    assert peak(grid("spin=0:60:1000000", "gamma=0:1:1000000")) < 100_000
    assert peak(drawn("random", 10**12, "spin=0:60", "gamma=0:1")) < 500_000


@pytest.mark.parametrize(
    ("name", "field"),
    [
        ("spin", "start.spin"),
        ("mu", "friction.coefficient"),
        ("eps", "friction.smoothing"),
        ("beta-rate", "start.beta_rate"),
        ("table.inclination", "table.inclination"),
        ("model", "model"),
    ],
)
def test_fields_go_by_their_keys(name: str, field: str) -> None:
    assert full_name(name) == field


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ({"start.spin": 12.0}, replace(PAPER, start=Start(spin=12.0))),
        ({"model": 4}, replace(PAPER, constraints=MODELS[4])),
        ({"constraints": "contact+fixed-cog"}, replace(PAPER, constraints=MODELS[2])),
        ({"friction.load": "contact"}, replace(PAPER, friction=SmoothCoulomb(load="contact"))),
        (
            {"friction.static": 0.6, "friction.law": "stribeck"},
            replace(PAPER, friction=Stribeck(static=0.6)),
        ),
        (
            {"disk.eccentricity": 2e-3, "disk.name": "steel-rounded"},
            replace(PAPER, disk=replace(ROUNDED_STEEL_DISK, eccentricity=2e-3)),
        ),
        (
            {"disk.hole_radius": 0.01},
            replace(PAPER, disk=Disk.ring(**(STEEL_RING | {"hole_radius": 0.01}))),
        ),
        (
            {"disk.radius": 0.05},
            replace(PAPER, disk=Disk.ring(**(STEEL_RING | {"radius": 0.05}))),
        ),
        (
            {f"disk.{name}": 2.0 * value for name, value in asdict(STEEL_DISK).items()}
            | {"disk.mass": 1.0},
            replace(
                PAPER,
                disk=Disk(
                    **{name: 2.0 * value for name, value in asdict(STEEL_DISK).items()}
                    | {"mass": 1.0}
                ),
            ),
        ),
    ],
)
def test_case_is_the_scenario_with_its_fields_changed(changes: Any, expected: Scenario) -> None:
    assert changed(PAPER, changes) == expected


@pytest.mark.parametrize(
    ("disk", "fields", "message"),
    [
        (STEEL_DISK, ("radius", "mass"), "mass does not go together with radius, from which it"),
        (STEEL_DISK, ("thickness", "inertia_x"), "inertia_x does not go together with thickness"),
        (ROUNDED_STEEL_DISK, ("radius",), "radius varies the paper's ring alone"),
        (ROUNDED_STEEL_DISK, ("hole_radius",), "hole_radius varies the paper's ring alone"),
    ],
)
def test_a_geometry_varies_with_the_mass_that_follows_from_it_or_not_at_all(
    disk: Disk, fields: tuple[str, ...], message: str
) -> None:
    with pytest.raises(ValueError, match=f"^{message}"):
        Ensemble(
            scenario=replace(PAPER, disk=disk),
            fields={name: np.array([0.04, 0.05]) for name in fields},
        )


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("spim=0:1:2", "got 'spim'; did you mean spin?"),
        ("spin", "axis must be field=first:last:count"),
        ("spin=", "axis must be field=first:last:count"),
        ("spin=1:2:3:4", "axis start.spin must be first:last:count"),
        ("spin=1:log", "axis start.spin must be first:last:count"),
        ("spin=1:2:-3", "axis start.spin must be first:last:count"),
        ("spin=1:2:0", "axis start.spin must have at least 1 value, got 0"),
        ("spin=1:1:5", "axis start.spin is an empty range"),
        ("spin=1:2:1", "axis start.spin is an empty range"),
        ("spin=1,1.0", "axis start.spin must hold each value once"),
        ("mu=0:1:3:log", "must be positive to be logarithmic, got 0 to 1"),
        ("mu=a,b", "friction.coefficient must be a number, got 'a'"),
        ("model=1:4:4", "axis model takes a list"),
        ("model=5,1", "model must be one of 1, 2, 3, 4, got '5'"),
        ("gamma=up,down", "start.gamma must be an angle"),
    ],
)
def test_what_is_no_axis_is_refused(text: str, message: str) -> None:
    with pytest.raises(ValueError, match=message.replace("(", r"\(")):
        axis_from_text(text)


def test_words_are_no_numbers_and_numbers_no_words() -> None:
    with pytest.raises(ValueError, match=r"friction\.load must be text, got 1"):
        axis_from("load", [1, 2])
    with pytest.raises(ValueError, match="either values, or first and last"):
        Axis(field="spin", values=(1.0,), first=0.0, last=1.0)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"axes": ()}, "axes must be at least one"),
        ({"axes": ("spin=1:2:3", "start.spin=4,5")}, r"axis start\.spin is given twice"),
        ({"axes": ("spin=1:2",)}, r"axis start\.spin needs a count on a grid"),
        ({"axes": ("spin=1,2",), "number": 5}, "number belongs to drawn points"),
        ({"axes": ("spin=1:2",), "layout": "sobol"}, "number of points must be given"),
        (
            {"axes": ("spin=1:2:3",), "layout": "random", "number": 5},
            "takes no count where points are drawn",
        ),
        (
            {"axes": ("spin=1:2",), "layout": "latin-hypercube", "number": 10**9},
            "limited by memory",
        ),
        ({"axes": ("spin=1,2",), "seed": -1}, "seed must be a whole number"),
        ({"axes": ("spin=1,2",), "layout": "hexagonal"}, "layout must be one of grid"),
    ],
)
def test_axes_that_do_not_fit_are_refused(arguments: dict[str, Any], message: str) -> None:
    axes = tuple(map(axis_from_text, arguments.pop("axes")))
    with pytest.raises(ValueError, match=message):
        Design(axes=axes, **arguments)


@pytest.mark.parametrize(
    ("scenario", "field", "message"),
    [
        (PAPER, "contact.stiffness", "needs a penalty contact"),
        (PAPER, "friction.static", r"friction\.static must be one of load, coefficient"),
        (
            replace(PAPER, disk=ROUNDED_STEEL_DISK),
            "disk.thickness",
            "varies the paper's ring alone",
        ),
        (
            replace(PAPER, start=State(coordinates=(0, 0, 0.045, 0, pi / 2, 0), rates=(0.0,) * 6)),
            "start.spin",
            "the start is told by its coordinates and rates",
        ),
    ],
)
def test_fields_that_the_scenario_lacks_are_refused(
    scenario: Scenario, field: str, message: str
) -> None:
    with pytest.raises(ValueError, match=message):
        check_field(scenario, field, {})


@pytest.mark.parametrize("layout", LAYOUTS)
def test_plain_data_make_the_same_design_again(layout: Any) -> None:
    count = ":3" if layout == "grid" else ""
    number = None if layout == "grid" else 7
    axes = (axis_from_text(f"spin=0:60{count}"), axis_from_text("friction.load=weight,contact"))
    design = Design(axes=axes, layout=layout, number=number)
    assert Design.from_values(design.to_values()) == design
