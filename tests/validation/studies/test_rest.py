"""The study of the way to rest: its numbers, and that what is wrong in it fails."""

from math import nan

import numpy as np
import pandas as pd
import pytest

from analysis.problem.choices import SOURCES
from tests.faults import Rows, faults
from tests.helpers import failing
from validation import study as studying
from validation.studies.rest import closed_forms, creep, runs, section, starts
from validation.study import Row

CLOSED = [
    {"case": name, "quantity": quantity, "exact": exact, "source": source, "value": exact}
    for name, case in closed_forms.cases().items()
    if isinstance(case, tuple)
    for quantity, exact in case.exact.items()
    for source in SOURCES
]
"""Rows in which both sides have each closed form."""


@pytest.fixture(scope="module")
def rows() -> Rows:
    """The stored tables; rows of them stand in for runs made for each report."""
    stored = {each.name: studying.load(each) for each in section.STUDIES if each.is_stored}
    known = stored[runs.STUDY.name].set_index("case").to_dict("index")
    fresh = [
        {**known[runs.ENGINE[each]], "case": runs.INHOUSE[each]}
        for each in (runs.SHOWN, runs.VISCOUS)
    ]
    ideal = {name: known[runs.INHOUSE[runs.SLIDING]][name] for name in runs.PHASES[:2]}
    fresh.append({**ideal, "case": runs.IDEAL, "end": 19.5})
    made = {runs.FRESH.name: fresh, closed_forms.STUDY.name: CLOSED}
    return stored | {name: pd.DataFrame(told) for name, told in made.items()}


def test_all_holds(rows: Rows) -> None:
    assert not failing(section.present(rows).checks)


RUNS, RUN, SEED = runs.STUDY.name, runs.ENGINE[runs.SHOWN], "random, seed 3"
BOTH = (": difference", ": engine against in-house")
SHIFTED = "rest, stiffness doubled: phases in s apart from"

test_what_departs_fails_its_check = faults(
    section.present,
    [
        (RUNS, RUN, "tilt", "tilt in rad", lambda x: [*x[:700], x[700] + 2e-3, *x[701:]]),
        (RUNS, RUN, "flat", "phases in s", nan),
        (RUNS, RUN, "taken_by_sliding", f"{RUN}: energy taken", lambda taken: 1.1 * taken),
        (RUNS, RUN, "face", f"{RUN}: face apart", "second"),
        (RUNS, RUN, "rise", f"{RUN}: rise of the energy", 1e-6),
        (RUNS, RUN, "force", f"{RUN}: contact pulls", -1.0),
        (RUNS, RUN, "unexplained", f"{RUN}: unexplained part", 1e-3),
        (RUNS, "stiffness doubled", "rest", SHIFTED, lambda time: time + 0.1),
        (
            *(RUNS, "spin 1e-05 rad/s faster", "tilt", "rest, spin: effect out of proportion"),
            lambda tilts: [each + 1e-3 for each in tilts],
        ),
        (creep.STUDY.name, "ε = 0.3 m/s", "error", "deviation from the law", 0.01),
        (creep.STUDY.name, "ε = 0.3 m/s", "part", "parts of the rate", 0.9),
        (starts.STUDY.name, SEED, "force", "contact pulls", -1.0),
        (closed_forms.STUDY.name, 0, "value", BOTH, nan, lambda x: 1.1 * x),
        (closed_forms.STUDY.name, -1, "value", BOTH, 1.0),
    ],
)


def test_a_phase_that_one_side_passes_without_fails_but_not_one_behind_its_end() -> None:
    whole: Row = dict.fromkeys(runs.PHASES, 1.0) | {"end": 5.0}
    assert section.shift(whole, whole | {"rest": 1.5}) == pytest.approx(0.5)
    assert section.shift(whole, whole | {"rest": None}) == np.inf
    assert section.shift(whole | {"rest": None}, whole) == np.inf
    assert section.shift(whole | {"rest": 4.0}, whole | {"rest": nan, "end": 3.0}) == 0.0
    nothing: Row = dict.fromkeys(runs.PHASES) | {"end": 5.0}
    assert section.shift(nothing, nothing) == np.inf


def test_the_creeps_law_and_its_deviation_are_found() -> None:
    times = np.arange(1.25, 60.0, creep.MEAN_TIME)
    tilts = (10.0 + 0.02 * times) ** -0.5
    tilts[times >= creep.TIMES[1]] *= 1.01
    assert creep.fit(times, tilts) == pytest.approx((0.02, 0.01), rel=1e-6)


def test_the_creep_is_as_far_down_as_is_said_after_the_stated_time(rows: Rows) -> None:
    shown = creep.present(rows[creep.STUDY.name]).tables["creep"]
    grown = shown["growth in 1/s, fitted"] * 60.0 * shown["from 0.28 to 0.14 rad in min"]
    np.testing.assert_allclose((0.28**-2 + grown) ** -0.5, 0.14, rtol=1e-12)
