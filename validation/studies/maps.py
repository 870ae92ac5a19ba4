"""The report's section on maps: drawn from the shipped ones, of which a sample is repeated."""

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from math import pi
from typing import Any

import numpy as np

from analysis import Scenario
from analysis.data.checks import Array
from analysis.data.files import AnyArray
from validation.kit import figures as kit
from validation.kit.figures import Picture
from validation.kit.report import Job, Section
from validation.kit.samples import COMMAND, age
from validation.kit.tables import Cell, Table
from validation.maps import figures, ship, stored
from validation.maps.problems import PROBLEMS, classify, critical_points
from validation.maps.run import Panel
from validation.maps.stored import Study
from validation.studies.claims.claim import Claim, grade, listed
from validation.sweeps.outcomes import difference, outcome
from validation.sweeps.plan import Motion, Plan

NEAR = 0.3
"""Tilt from upright in rad within which the models are compared."""

BANDS = (0.1, NEAR, 0.5, 0.7)
"""Tilts from upright in rad up to which the models are compared."""

ABOVE = 3.0
"""Spin in rad/s by which the disk may have to be faster than the second critical speed."""

_REPEATED = 2
"""Cases of each panel that a report repeats."""

_TREE_STEP, _STEP = 5e-3, 2.5e-3
"""Steps in s of the engine's repetitions: Model 1, and the others."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Repetition:
    """A case of a map, run again by both sides.

    Parameters
    ----------
    engine, inhouse : str
        Classes.
    difference : float
        Largest of beta and gamma in rad.
    """

    engine: str
    inhouse: str
    difference: float


def sample(panel: Panel) -> list[int]:
    """Numbers of the cases to repeat: the middle ones of the most frequent outcomes."""
    found = Counter(panel.classes.values()).most_common()
    names = [name for name, _ in found if name not in ("failed", "refused", "not decided")]
    chosen = []
    for name in names[:_REPEATED]:
        numbers = sorted(number for number, each in panel.classes.items() if each == name)
        chosen.append(numbers[len(numbers) // 2])
    return chosen


def repeat(name: str, scenario: Scenario, end: float) -> Repetition:
    """Run a case of a map by both sides, with a fixed step and a local tolerance."""
    step = _TREE_STEP if scenario.model == 1 else _STEP
    plans = (
        Plan(source="engine", step=step, end=end),
        Plan(source="in-house", local_tolerance=1e-6, end=end),
    )
    motions: list[Motion] = [plan.motion(scenario, time_limit=None) for plan in plans]
    judge = classify(PROBLEMS[name])
    engine, inhouse = (judge(scenario, outcome(motion)) for motion in motions)
    return Repetition(engine=engine, inhouse=inhouse, difference=difference(*motions))


def _cases(study: Study) -> Iterable[tuple[str, Panel, int]]:
    return (
        (name, panel, number)
        for name, panels in study.panels.items()
        for panel in panels
        for number in sample(panel)
    )


def _key(name: str, panel: Panel, number: int) -> tuple[Any, ...]:
    return ("map", name, panel.sweep.scenario.model, number)


def jobs() -> list[Job]:
    """Repetitions of the sample."""
    study = stored.shipped()
    return [
        Job(
            _key(name, panel, number),
            repeat,
            (name, panel.sweep.scenario_of(number), panel.sweep.plan.end),
        )
        for name, panel, number in (_cases(study) if study else ())
    ]


def inverts(panel: Panel) -> AnyArray:
    """Where the disk turns upside down over the finest grid, kept or lost again; of bool."""
    found: AnyArray = np.isin(panel.filled, ("inverted", "lost"))
    return found


def agreement(panels: Sequence[Panel], band: float) -> list[float]:
    """Part of the starts, within a tilt from upright, that end as in the first panel."""
    first, *others = (inverts(panel) for panel in panels)
    rows = np.abs(panels[0].values()[0] - pi / 2) <= band + 1e-9
    return [float(np.mean(each[rows] == first[rows])) for each in others]


def above_critical(panel: Panel, least: float) -> Array:
    """How far the least spin that inverts lies above the second critical one, in rad/s.

    Parameters
    ----------
    panel : Panel
        Over the spin, horizontally.
    least : float
        Of the quantity along the vertical axis.

    Returns
    -------
    ndarray, shape (n,)
        By the values along the vertical axis.
    """
    points = critical_points(panel.problem, panel.sweep.scenario)
    heights = [each for each in np.unique(points[:, 1]) if each >= least]
    critical = [float(np.sort(points[points[:, 1] == each, 0])[1]) for each in heights]
    values, spins = panel.values()
    rows = np.flatnonzero(values >= least)
    inverted = panel.filled[rows] == "inverted"
    least_spins = spins[np.argmax(inverted, axis=1)]
    apart: Array = (least_spins - np.interp(values[rows], heights, critical))[inverted.any(axis=1)]
    return apart


def claims(study: Study, repeated: Mapping[Any, Repetition]) -> list[Claim]:
    """What the maps say, by criteria."""
    near, everywhere = (agreement(study.panels["basins"], band)[-1] for band in (NEAR, BANDS[-1]))
    return [
        *(_speed_claim(study, name, least) for name, least in _SPEED_MAPS),
        *(
            Claim(
                place="basins",
                statement=f"the reduced system tells which starts of Model 1 invert, {at}",
                criterion="it tells so for at least 95 % of them; partly: 80 %",
                measured=f"{100 * part:.0f} %",
                verdict=grade(yes=part >= 0.95, partly=part >= 0.8),
            )
            for at, part in (
                (f"within {NEAR:g} rad of upright", near),
                (f"within {BANDS[-1]:g} rad", everywhere),
            )
        ),
        _fineness_claim(study),
        _sides_claim(study, repeated),
    ]


_SPEED_MAPS = (("spin-friction", 0.2), ("spin-eccentricity", 1.5e-3))
"""Maps over the spin, and from where on along the other axis they are judged.

Below, other critical speeds come in, and 4 s are too short for friction to lift the disk.
"""


def _speed_claim(study: Study, name: str, least: float) -> Claim:
    (panel,) = study.panels[name]
    apart = above_critical(panel, least)
    label, _, unit = panel.problem.labels[1].partition(" in ")
    bound = f"{least:g} {unit}".strip()
    return Claim(
        place=name,
        statement="the least spin at the start that inverts is the second critical speed",
        criterion=f"0 to {ABOVE:g} rad/s above it, with {label} from {bound} on; partly: "
        "nowhere below",
        measured=f"{apart.min():.1f} to {apart.max():.1f} rad/s more",
        verdict=grade(yes=apart.min() >= 0.0 and apart.max() <= ABOVE, partly=apart.min() >= 0.0),
    )


def _fineness_claim(study: Study) -> Claim:
    found = study.fineness
    return Claim(
        place="rest",
        statement="the face that is up at rest hangs on the start by a fractal boundary",
        criterion="the uncertainty exponent lies below 1 by more than 2 standard deviations; "
        "no: it is not shown",
        measured=f"{found.exponent:.2f} ± {found.error:.2f} from {study.pairs} starts, of which "
        f"{listed(100.0 * found.parts, '.0f')} % end differently "
        f"{listed(found.distances, '.1e')} widths away",
        verdict=grade(yes=found.exponent + 2.0 * found.error < 1.0),
    )


def _sides_claim(study: Study, repeated: Mapping[Any, Repetition]) -> Claim:
    seen = [
        each.alike
        for panels in study.panels.values()
        for panel in panels
        for each in panel.witnesses.values()
    ]
    same = sum(each.engine == each.inhouse for each in repeated.values())
    alike, number = sum(seen) + same, len(seen) + len(repeated)
    return Claim(
        place="all",
        statement="engine and in-house equations tell the same",
        criterion="all cases that both have run end alike; partly: 95 %",
        measured=f"{sum(seen)} of {len(seen)} shipped, {same} of {len(repeated)} repeated",
        verdict=grade(yes=0 < alike == number, partly=0 < 0.95 * number <= alike),
    )


def section(results: Mapping[Any, Any]) -> Section:
    """Section of the report from the results of `jobs`."""
    study = stored.shipped()
    if study is None:
        return Section(
            name="maps", title="Maps", paragraphs=[f"None is shipped; run `{COMMAND} DIR maps`."]
        )
    return Section(
        name="maps",
        title="Maps",
        paragraphs=[
            (
                "What becomes of the disk over two parameters: a coarse grid is run whole, and "
                "cells with different outcomes are halved. Model 1 runs in the engine, Models 2 "
                "to 4 in-house; the other side has run those marked by a circle as well."
            ),
            (
                f"Shipped results ({study.provenance.text()}), of which this report has repeated "
                f"{len(results)} cases on both sides. {age('maps', ship.jobs())}"
            ),
        ],
        pictures=pictures(study),
        tables=[
            _claim_table(claims(study, results)),
            _agreement_table(study),
            _panel_table(study),
            _repetition_table(study, results),
        ],
    )


def pictures(study: Study) -> list[Picture]:
    """The maps of the inversion, the basins of the models, and the faces at rest."""
    return [
        _picture(
            [study.panels[name][0] for name in ("spin-friction", "spin-eccentricity", "tilting")],
            name="maps",
            title="What becomes of the inversion",
            caption="Model 1 from Table 3. On the right of the first two it is time that lacks: "
            "little friction, or eccentricity, does not lift the disk within "
            f"{PROBLEMS['spin-friction'].end:g} s.",
        ),
        _picture(
            study.panels["basins"],
            name="basins",
            title="Starts that invert, by model",
            caption="From Table 3's spin, over the attitude at the start; Model 4 as the reduced "
            "system.",
        ),
        _picture(
            study.panels["rest"],
            name="rest-faces",
            title="Which face is up at rest",
            caption="Model 1 from Table 3. Decided once the energy no longer lifts the disk on "
            f"its rim; not decided: it still does after {PROBLEMS['rest'].end:g} s.",
            width=5.8,
        ),
    ]


def _picture(panels: Sequence[Panel], *, width: float | None = None, **told: str) -> Picture:
    figure = figures.draw(panels, width=width, points=False)
    return kit.render(figure, **told, stacked=len(panels) > 1)


def _claim_table(found: Sequence[Claim]) -> Table:
    return Table(
        name="maps-verdicts",
        title="What the maps say",
        columns=("map", "statement", "criterion", "measured", "verdict"),
        rows=[
            [each.place, each.statement, each.criterion, each.measured, each.verdict]
            for each in found
        ],
        folded=False,
    )


def _agreement_table(study: Study) -> Table:
    panels = study.panels["basins"]
    parts = [agreement(panels, band) for band in BANDS]
    rows: list[list[Cell]] = [
        [panel.sweep.scenario.name, *(100.0 * each[index] for each in parts)]
        for index, panel in enumerate(panels[1:])
    ]
    return Table(
        name="maps-models",
        title="Starts of which a simpler model tells what Model 1 does",
        columns=("model", *(f"% within {band:g} rad of upright" for band in BANDS)),
        rows=rows,
        note="Part of the area of the basins: turned upside down, kept or lost again, or not.",
    )


def _panel_table(study: Study) -> Table:
    rows: list[list[Cell]] = []
    for name, panels in study.panels.items():
        for panel in panels:
            whole = panel.filled
            shares = Counter(whole.ravel().tolist()).most_common()
            seen = panel.witnesses.values()
            apart = [each.difference for each in seen]
            rows.append(
                [
                    name,
                    panel.sweep.scenario.name,
                    len(panel.classes),
                    whole.size,
                    ", ".join(f"{each} {100 * n / whole.size:.0f} %" for each, n in shares),
                    len(seen),
                    sum(each.alike for each in seen),
                    float(np.median(apart)) if apart else None,
                    max(apart, default=None),
                ]
            )
    return Table(
        name="maps-shipped",
        title="The shipped maps",
        columns=(
            "map", "model", "runs", "in place of", "outcomes", "seen by the other side",
            "of them alike", "median difference in rad", "largest difference in rad",
        ),
        rows=rows,
        note=f"{_runs(study)} runs, which took {_seconds(study):.0f} s of processor time without "
        "those of the other side.",
        folded=False,
    )  # fmt: skip


def _runs(study: Study) -> int:
    return sum(len(panel.classes) for panels in study.panels.values() for panel in panels)


def _seconds(study: Study) -> float:
    return sum(panel.seconds for panels in study.panels.values() for panel in panels)


def _repetition_table(study: Study, results: Mapping[Any, Repetition]) -> Table:
    rows: list[list[Cell]] = []
    for name, panel, number in _cases(study):
        found, kept = results[_key(name, panel, number)], panel.classes[number]
        values = [float(each) for each in panel.sweep.design.case(number)[::-1]]
        fields = [axis.field.partition(".")[2] for axis in panel.sweep.design.axes[::-1]]
        at = ", ".join(f"{each} {value:.4g}" for each, value in zip(fields, values, strict=True))
        rows.append(
            [
                name,
                panel.sweep.scenario.name,
                at,
                kept,
                found.engine,
                found.inhouse,
                found.difference,
                found.engine == found.inhouse == kept,
            ]
        )
    return Table(
        name="maps-repeated",
        title="Cases of the maps repeated by both sides",
        columns=(
            "map", "model", "case", "shipped", "engine", "in-house", "difference in rad",
            "the same",
        ),
        rows=rows,
        worst="difference in rad",
        note=f"Engine: steps of {1e3 * _TREE_STEP:g} ms for Model 1 and {1e3 * _STEP:g} ms for "
        "the others; in-house: a local tolerance of 1e-6. Of each panel, the middle case of each "
        f"of the {_REPEATED} most frequent outcomes.",
    )  # fmt: skip
