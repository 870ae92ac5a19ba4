"""The study of nonlinear dynamics: its page, its checks and its pictures."""

from math import nan
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from tests.faults import GONE, Rows, faults
from tests.helpers import failing
from validation.display.figures import new_figure
from validation.nonlinear import figures
from validation.page.section import Section
from validation.studies.nonlinear import measured, section
from validation.studies.nonlinear.measured import DISSIPATED, HELD_NAMES, ROTATING, SLOW, SWINGING
from validation.studies.nonlinear.section import SAME_CYCLE, present
from validation.study import Row


def _families() -> list[Row]:
    common = {"period": 1.0, "multiplier": 0.9, "half_multiplier": 0.9, "log10_strong": -100.0}
    cycle = {**common, "kind": "motion", "stable": True}
    rows: list[Row] = [
        {"case": SWINGING, **cycle, "amplitude": amplitude, "spin": 31.0 - 0.25 * amplitude}
        for amplitude in (1.0, 2.0, 3.1)
    ]
    fit = {"curvature": -0.25, "fitted_curvature": -0.25, "fitted_curvature_error": 1e-6}
    birth = {"kind": "birth", "type": "supercritical", "fitted_exponent": 2.0, **fit}
    end = {"kind": "end", "off": 1e-10, "by_amplitude": -0.5, "predicted_by_amplitude": -0.5}
    rows += [{"case": SWINGING, **birth}, {"case": SWINGING, **end}]
    turn = {"case": ROTATING, **cycle, "tilt": 0.1, "largest_tilt": 0.5, "spin": 30.1}
    rows += [turn, turn | {"spin": 31.0, "stable": False}, turn | {"kind": "fold", "spin": 30.08}]
    rows.append(cycle | {"case": SLOW})
    for name in HELD_NAMES:
        held = {"case": name, **cycle, "complex_multiplier": nan, "spin": 30.0}
        rows += [held | {"amplitude": 0.1}, held | {"amplitude": 0.2, "stable": False}]
    return rows


def _passages() -> list[Row]:
    curve = {name: [1.0, 0.5] for name in ("times", "spins", "deviations", "linear")}
    way = {**curve, "source": "in-house", "hopf": 30.1, "crossing": 9.0, "lost": 18.0}
    way |= {"predicted": 17.0, "lowest_spin": 25.0, "rate": 0.5}
    rows = [{"case": label, **way} for label in measured.passages()]
    for number, row in enumerate(rows[4:]):
        row |= {"rate": 0.1 * 4.0**number, "lowest_spin": 30.1 - 2.0**number}
    return rows


@pytest.fixture
def rows() -> Rows:
    """Rows as they might have been measured."""
    cycle = {"spin": 30.5, "amplitude": 1.0, "period": 1.0, "multiplier": 0.9}
    engine = [
        {"case": case, "source": source, **cycle}
        for case in measured.repeated()
        for source in ("in-house", "engine")
    ]
    saddle = {"growing": 6.0, "slow": -8.0, "strong": -100.0, "saddle_index": 1.3}
    connections = [
        {"case": label, "spin": 30.12, "predicted": 30.2, "bracket": 1e-11, **saddle}
        for label in measured.disks_and_friction()
    ]
    found = (_families(), engine, connections, _passages())
    names = (study.name for study in section.STUDIES)
    return dict(zip(names, map(pd.DataFrame, found), strict=True))


def test_the_section_is_filled_in_and_says_what_was_found(rows: Rows) -> None:
    content = present(rows)
    assert not failing(content.checks)
    text = Path(section.__file__).parent / "nonlinear.md"
    made = Section("nonlinear", content, text)
    page = " ".join(made.filled(vars(section))[0].split())
    assert "Model 1 at held spin: stable at 0.1 rad, unstable at 0.2 rad" in page
    assert "Of 3 cycles" in page
    assert [verdict.answer for verdict in made.verdicts] == ["yes", "no"]
    assert "lost 9.0 to 9.0 s later" in made.verdicts[1].numbers


FITS = "fit over theory less 1"
WRONG = (0.3, nan)
LATE = f"{DISSIPATED}, engine"

test_a_wrong_value_none_or_a_missing_row_fails_its_check = faults(
    present,
    [
        *(
            ("engine-cycles", "engine", name, f"cycles: {name}, engine", *WRONG)
            for name in SAME_CYCLE
        ),
        ("engine-cycles", "engine", "", "cycles: ", GONE),
        ("families", "end", "off", "cycles: end at the connection", *WRONG),
        ("families", "birth", "fitted_curvature", f"spin over amplitude², {FITS}", *WRONG),
        ("families", "birth", "fitted_exponent", f"power of the amplitude, {FITS}", *WRONG),
        ("families", "end", "by_amplitude", f"over ln(π − amplitude), {FITS}", *WRONG),
        ("connections", "disk of Table 1", "bracket", "connections: ", *WRONG, GONE),
        ("passages", LATE, "lowest_spin", "passage: lowest_spin, engine", *WRONG),
        ("passages", LATE, "crossing", "passage: crossing, engine", *WRONG),
        ("passages", LATE, "", "passage", GONE),
    ],
)


def test_verdicts_come_out_otherwise_when_the_disk_behaves_otherwise(rows: Rows) -> None:
    families, passages = rows["families"], rows["passages"]
    families.loc[0, "stable"] = False
    passages.loc[0, "lost"] = 9.5
    numbers = present(rows).numbers
    assert [*numbers["answers"].values()] == ["partly", "partly"]
    assert numbers["stable"] == 2


def test_stable_cycles_are_solid_and_unstable_ones_dashed() -> None:
    axes, stable = new_figure()[1], (True, True, True, False, False)
    cycles = [{"spin": 30.0, "stable": each} for each in stable]
    figures.lines(axes, cycles, np.array((0.0, 0.5, 1.2, 1.7, 1.9)))
    (solid,), (dashed,) = (
        [line for line in axes.get_lines() if line.get_linestyle() == style]
        for style in ("-", "--")
    )
    np.testing.assert_equal(solid.get_ydata(), [0.0, 0.5, 1.2, np.nan, np.nan])
    np.testing.assert_equal(dashed.get_ydata(), [np.nan, np.nan, 1.2, 1.7, 1.9])
    figures.lines(axes, cycles[:1], np.zeros(1))
    # One alone has no line to be seen by.
    assert [line.get_marker() for line in axes.get_lines()] == ["None", "None", "o"]


def test_motions_and_noninverted_spinning_are_drawn_at_their_gamma_and_beta() -> None:
    states = np.array(((0.1, 0.2, 0.3), (1.1, 1.2, 1.3)))
    (axes,) = figures.portrait([("there", states)], saddles=(-1.6, 4.7)).axes
    motion, saddles = (line.get_xydata() for line in axes.get_lines())
    np.testing.assert_equal(motion, states[:, [1, 0]])
    # Upright, whichever half of the disk is below.
    np.testing.assert_equal(saddles, [(-1.6, np.pi / 2), (4.7, np.pi / 2)])
