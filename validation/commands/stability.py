"""The commands on linear stability: `eigenvalues` and `critical`."""

from dataclasses import asdict, replace
from textwrap import fill
from typing import Any

import numpy as np

from analysis import LEVELS, MODELS, Start
from analysis.mechanics.paper import CriticalSpeed, critical_speed
from analysis.problem.checks import Array
from analysis.problem.choices import EngineFormulation, Source
from analysis.problem.names import ArgumentError
from analysis.stability import spectra
from analysis.stability.critical import CriticalSpeeds, critical_speeds, spin_interval
from analysis.stability.linearisation import ComplexArray
from validation.commands.options import parse_spins
from validation.display import figures
from validation.display.progress import counted
from validation.display.tables import Table
from validation.parser.files import Result
from validation.parser.kinds import Spectrum, SpinningProblem, Spins

_WIDEST = 70
"""Letters in a line of a label."""

_MODELS = {name: level for name, (level, _) in spectra.CLOSED.items()}
"""That a system stands for unless constraints are given."""


def eigenvalues(
    *,
    problem: SpinningProblem,
    spectrum: Spectrum,
    source: Source = "in-house",
    formulation: EngineFormulation | None = None,
    spin: Spins,
) -> Result:
    """Eigenvalues of inverted and noninverted spinning.

    Eigenvalues of the stationary spinning motions over the spin, in 1/s.

    full: the eight of Eq. (55), Model 1; reduced: the three of Eq. (111), Model 4; numeric: those
    of any constraints, or on a compliant contact, linearised by dual numbers. With --source engine
    they come from the engine. Columns follow the branches.

    Parameters
    ----------
    source
        Who computes.
    formulation
        Engine only: how it is built (the most accurate).
    spin
        Spins in rad/s: values, with commas or not, or first:last:number.
    """
    spins, motion = parse_spins(spin), spectrum["motion"]
    scenario = problem.scenario(model=_MODELS.get(spectrum.get("system", "")))
    if source == "in-house" and formulation is not None:
        raise ArgumentError("formulation", "needs --source engine")
    found = spectra.branches(scenario, spins, **spectrum)
    if source == "engine":
        from validation.studies.comparisons import engine_matrices

        shown = counted(spins, "spins")
        matrices = engine_matrices(scenario, shown, formulation=formulation, motion=motion)
        values = np.linalg.eigvals(matrices).astype(complex)
        found = spectra.matched(found, found, values)
    found = found + 0.0  # zeros without a sign
    rows = [
        {"spin": spin, "real": values.real.tolist(), "imag": values.imag.tolist()}
        for spin, values in zip(spins.tolist(), found, strict=True)
    ]
    return Result(
        tables=[_table(scenario.name, spins, found)],
        values=rows,
        draw=lambda: _draw(spins, found, f"{motion} spinning, {scenario.name},"),
    )


def critical(
    *,
    problem: SpinningProblem,
    spectrum: Spectrum,
    spin: Spins = ("0:60",),
) -> Result:
    """Spins at which the spinning is stable, and at which eigenvalues cross.

    For each model the spins at which inverted spinning is stable, all of its eigenvalues together;
    then the spins at which one of them, or a pair, becomes stable or unstable, with its frequency,
    beside the closed form of the reduced system, Eq. (126). Other bodies, and a compliant contact,
    have Model 1 alone.

    Parameters
    ----------
    spin
        From the least to the largest of spins in rad/s: values, with commas or not, or
        first:last:number.
    """
    scenario = problem.scenario(model=_MODELS.get(spectrum.get("system", "")))
    spins, motion = parse_spins(spin, ends=True), spectrum["motion"]
    ends = spin_interval((spins[0], spins[-1]), "spin")
    found = critical_speeds(scenario, ends, **spectrum)
    # Of other bodies the reduced system, Model 4 and a closed form know nothing; without friction
    # nothing is damped.
    is_damped = scenario.rubs and scenario.friction_gradient > 0.0
    is_known = scenario.disk.is_plain and is_damped and scenario.contact is None
    closed = critical_speed(scenario, motion) if is_known else None
    crossings = _critical_table(found, _closed_form(closed) if closed else "")

    def picture() -> Any:
        helpers = spectra.helper_spins(scenario, *ends)
        branches = spectra.branches(scenario, helpers, **spectrum)
        return _draw(helpers, branches, f"{motion} spinning, {scenario.name},", found)

    return Result(
        tables=[_stable_table(found), crossings],
        values={
            "stable": found.stable,
            "crossings": [asdict(each) for each in found.crossings],
            "pair_changes": [asdict(each) for each in found.pair_changes],
            "reason": found.reason,
            "closed_form": asdict(closed) if closed else None,
        },
        csv=crossings,
        draw=picture,
    )


def _stable_table(found: CriticalSpeeds) -> Table:
    """Where spinning is stable under these constraints and those of the models of the body."""
    scenario, interval, motion = found.scenario, found.interval, found.motion
    takes_all = scenario.disk.is_round_disk and scenario.contact is None
    sets = [MODELS[level] for level in (LEVELS if takes_all else LEVELS[:1])]
    if scenario.model is None:
        sets.append(scenario.constraints)
    compared = (replace(scenario, constraints=each, start=Start()) for each in sets)
    return Table(
        title=f"Where {motion} spinning is stable, all eigenvalues together, from "
        f"{interval[0]:g} to {interval[1]:g} rad/s",
        columns=("model", "stable spins in rad/s"),
        rows=[
            (each.name, critical_speeds(each, interval, motion=motion).where) for each in compared
        ],
    )


def _critical_table(found: CriticalSpeeds, note: str) -> Table:
    """Critical speeds; each row says what becomes of one eigenvalue or pair."""
    what = {"hopf": "pair", "static": "real eigenvalue"}
    side = {"above": "stable", "below": "unstable"}
    pairs = {
        "above": "two real eigenvalues become a pair",
        "below": "a pair becomes two real eigenvalues",
    }
    low, high = found.interval
    return Table(
        title=f"Single eigenvalues of {found.scenario.name}, {found.system} system, "
        f"{found.motion}, from {low:g} to {high:g} rad/s",
        columns=("as the spin rises", "spin in rad/s", "frequency in rad/s"),
        rows=[
            *(
                (f"this {what[e.kind]} becomes {side[e.stable_side]}", e.spin, e.frequency)
                for e in found.crossings
            ),
            *((pairs[each.complex_side], each.spin, 0.0) for each in found.pair_changes),
        ],
        note="\n".join(filter(None, (found.reason, note))),
    )


def _closed_form(closed: CriticalSpeed) -> str:
    meaning = {
        "hopf": f"a pair of frequency {closed.frequency:.6g} rad/s becomes stable there",
        "static": "without eccentricity, a real eigenvalue crosses there",
        "saddle": "two real eigenvalues of opposite sign cancel; no stability changes",
    }[closed.kind]
    return (
        f"Closed form of the reduced system with any friction, Eq. (126): {closed.spin:.6g} "
        f"rad/s; {meaning}."
    )


def _table(name: str, spins: Array, values: ComplexArray) -> Table:
    size = values.shape[1]
    heads = [f"{part} {index + 1}" for index in range(size) for part in ("Re λ", "Im λ")]
    # Real and imaginary parts in turns.
    parts = np.ascontiguousarray(values).view(float)
    return Table(
        title=f"Eigenvalues of {name} in 1/s",
        columns=("spin in rad/s", *heads),
        rows=np.column_stack((spins, parts)).tolist(),
    )


def _draw(
    spins: Array, values: ComplexArray, motion: str, critical: CriticalSpeeds | None = None
) -> Any:
    """Figure of the real and imaginary parts, stable spins shaded and crossings marked."""
    stable, crossings = (critical.stable, critical.crossings) if critical else ((), ())
    figure, axes = figures.new_figure(2, height=6.5)
    # What decides on stability is small beside what friction makes decay.
    axes[0].set_yscale("symlog", linthresh=1.0)
    marker = "o" if spins.size == 1 else None
    for column, look in enumerate(figures.LOOKS[: values.shape[1]]):
        axes[0].plot(spins, values[:, column].real, marker=marker, label=f"λ{column + 1}", **look)
        axes[1].plot(spins, values[:, column].imag, marker=marker, **look)
    axes[0].axhline(0.0, color="#999999", linewidth=0.8, zorder=0)
    for each in axes:
        for index, ends in enumerate(stable):
            label = "" if index else "stable"
            each.axvspan(*ends, color="#cccccc", alpha=0.5, zorder=0, label=label)
    if crossings:
        places = [each.spin for each in crossings]
        axes[0].plot(places, [0.0] * len(places), "ko", zorder=4, label="crossing")
        for sign in (1.0, -1.0):
            axes[1].plot(places, [sign * each.frequency for each in crossings], "ko", zorder=4)
    axes[0].set(ylabel="Re λ in 1/s: unstable above 0,\nlogarithmic beyond ±1")
    axes[1].set(ylabel="Im λ in 1/s", xlabel=fill(f"Ω of {motion} in rad/s", _WIDEST))
    figures.legend_above(axes[0], columns=4)
    return figure
