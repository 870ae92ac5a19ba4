"""The report's section on linear stability: its jobs and what becomes of them."""

from typing import Any

import numpy as np

from analysis import MODELS, POSSIBLE_SETS, Level, Motion, Scenario
from analysis.stability.chart import stability_chart
from analysis.stability.corners import corners
from analysis.stability.hopf_curves import hopf_curves
from validation.kit import samples
from validation.kit.figures import Picture
from validation.kit.limits import largest
from validation.kit.report import Job, Section
from validation.kit.samples import Sample
from validation.kit.tables import Table
from validation.studies.stability import eigenvalue_check
from validation.studies.stability import figures as stability_figures
from validation.studies.stability import tables as stability_tables
from validation.studies.stability.eigenvalue_check import ComplexArray, EigenvalueCheck


def engine_spectra(level: Level, motion: Motion) -> ComplexArray:
    """Eigenvalues of the engine at the spins of the figures' markers, shape (n, k)."""
    matrices = eigenvalue_check.engine_matrices(
        Scenario(constraints=MODELS[level]), stability_figures.ENGINE_SPINS, motion=motion
    )
    return np.linalg.eigvals(matrices).astype(complex)


def engine_numbers() -> dict[str, float]:
    """Printed critical speeds from the engine's eigenvalues."""
    return {
        "critical spin, computed": eigenvalue_check.engine_critical_spin(4, 30.0, 32.0, 7.1),
        "Ω_crit1": eigenvalue_check.engine_critical_spin(1, 26.0, 28.0, 22.7),
        "Ω_crit2": eigenvalue_check.engine_critical_spin(1, 29.0, 31.0, 5.75),
    }


def draw_chart() -> tuple[Picture, Table]:
    """Stability chart with its curves and corners."""
    scenario = Scenario()
    curves = hopf_curves(scenario)
    meeting = corners(scenario, curves)
    grid = stability_chart(scenario, np.linspace(0.0, 80.0, 200), np.geomspace(0.3, 30.0, 200))
    return stability_figures.chart(grid, curves, meeting), stability_tables.corner_table(meeting)


REPEATED: tuple[Any, ...] = (
    ("eigenvalues", (1, "contact-tree")),
    ("eigenvalues", (2, "floating")),
    ("eigenvalues", (3, "euler-tree")),
    ("eigenvalues", (4, "floating-lie")),
    ("eigenvalues of a set", ("contact", "fixed-cog", "no-slip-along", "no-slip-across")),
    ("eigenvalues of a set", ("contact", "no-slip-along", "constant-spin")),
)
"""Keys of the shipped checks that are made again."""


def shipped() -> list[Job]:
    """Checks whose results come with the package."""
    return [
        *(
            Job(("eigenvalues", case), eigenvalue_check.check_eigenvalues, (case,))
            for case in eigenvalue_check.cases()
        ),
        *(
            Job(("eigenvalues of a set", held), eigenvalue_check.check_set, (held,))
            for held in POSSIBLE_SETS
        ),
    ]


def jobs() -> list[Job]:
    """Jobs on the spot."""
    spectra: list[tuple[Level, Motion]] = [(1, "inverted"), (4, "inverted"), (1, "noninverted")]
    return [
        *(samples.fresh(job) for job in shipped() if job.key in REPEATED),
        *(Job(("spectra", *each), engine_spectra, each) for each in spectra),
        Job("stock eigenvalues", eigenvalue_check.stock_table),
        Job("engine's critical speeds", engine_numbers),
        Job("stability chart", draw_chart),
        Job("variants", stability_tables.variant_table),
        Job("sensitivities", stability_tables.sensitivity_table),
    ]


def _samples(results: dict[Any, Any]) -> list[Sample]:
    """The checks that are made again, by the engine's difference from the in-house equations."""
    found = []
    for key in REPEATED:
        again = results[samples.fresh_key(key)]
        model = isinstance(again, EigenvalueCheck)
        found.append(
            Sample(
                what=f"Model {key[1][0]}, {key[1][1]}" if model else again.name,
                how="made again",
                quantity="eigenvalues, engine with in-house, relative",
                difference=largest((again.inverted, again.noninverted))
                if model
                else again.difference,
                limit=eigenvalue_check.EIGENVALUE_LIMIT,
            )
        )
    return [*found, Sample(what="the other models, formulations and sets of constraints")]


def check_table(results: dict[Any, Any]) -> Table:
    """Engine against in-house eigenvalues."""
    return eigenvalue_check.table(
        [results["eigenvalues", case] for case in eigenvalue_check.cases()]
    )


def section(results: dict[Any, Any]) -> Section:
    """Section of the report from the results of `jobs`."""
    chart, corner_table = results["stability chart"]
    return Section(
        name="stability",
        title="Linear stability",
        paragraphs=[
            (
                "Eigenvalues of inverted and noninverted spinning, from the linear systems (55) "
                "and (111) and from the engine's accelerations, differentiated along the "
                "constraint manifold. Their comparison comes with the package; that of one "
                "formulation of each model and of some sets of constraints is made again on the "
                "spot. All else here is computed for this page."
            ),
            (
                "The full system has two Hopf points: a fast pair loses its stability at the "
                "lower one, and the slow pair gains it at the upper one. In the reduced system "
                "only the slow pair is left, and the critical speed is the paper's closed form."
            ),
        ],
        pictures=[
            stability_figures.figure_6(results["spectra", 1, "inverted"]),
            stability_figures.figure_10(results["spectra", 4, "inverted"]),
            stability_figures.figure_11(results["spectra", 1, "noninverted"]),
            chart,
        ],
        tables=[
            samples.table("stability", shipped(), _samples(results)),
            check_table(results),
            eigenvalue_check.sets_table(
                [results["eigenvalues of a set", held] for held in POSSIBLE_SETS]
            ),
            results["stock eigenvalues"],
            stability_tables.printed_numbers(results["engine's critical speeds"]),
            results["variants"],
            corner_table,
            results["sensitivities"],
        ],
    )
