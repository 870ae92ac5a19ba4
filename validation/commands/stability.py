"""What the subcommands on linear stability do; each returns the exit code."""

import argparse
import json
from pathlib import Path

import numpy as np

from analysis import Scenario
from analysis.data.checks import Array
from analysis.data.files import whole_file
from analysis.data.limits import MOST_SPINS
from analysis.stability import linear_reduced, spectra
from analysis.stability.critical import critical_speeds
from analysis.stability.spectra import Branches
from validation.commands.options import written_number
from validation.commands.scenarios import chosen_scenario
from validation.kit.progress import counted
from validation.kit.tables import Table


def eigenvalues(options: argparse.Namespace) -> int:
    """Print, store or plot eigenvalues over the spin."""
    spins = parse_spins(options.spins)
    if options.formulation is not None and options.source != "engine":
        raise ValueError("--formulation needs --source engine")
    scenario = _scenario(options)
    found = _branches(options, scenario, spins)
    table = _table(scenario.name, found)
    if options.csv is not None:
        with whole_file(options.csv) as stream:
            stream.write(table.to_csv().encode())
    if options.plot is not None:
        _plot(found, options.plot)
    if options.json:
        rows = [
            {"spin": spin, "real": values.real.tolist(), "imag": values.imag.tolist()}
            for spin, values in zip(found.spins.tolist(), found.values, strict=True)
        ]
        print(json.dumps(rows))
    elif options.csv is None and options.plot is None:
        print(f"{table.title}\n{table.to_text()}")
    return 0


def critical(options: argparse.Namespace) -> int:
    """Print where spinning is stable, and critical spins beside the closed form."""
    from validation.studies.stability.tables import critical_table, stable_range, stable_table

    scenario = _scenario(options)
    ends = options.spins.split(":")
    if len(ends) != 2:
        raise ValueError(f"--spin must be FIRST:LAST, got {options.spins!r}")
    low, high = (written_number("--spin", end) for end in ends)
    found = critical_speeds(scenario, (low, high), options.system, options.motion)
    where = stable_range(scenario, (low, high), options.motion)
    print(f"{scenario.name}: {options.motion} spinning is stable {where}.\n")
    table = stable_table(scenario, (low, high), options.motion)
    print(f"{table.title}\n{table.to_text()}\n")
    table = critical_table(found)
    print(f"{table.title}\n{table.to_text() if table.rows else 'none'}")
    if table.note:
        print(table.note)
    closed = linear_reduced.critical_speed(scenario, options.motion)
    meaning = {
        "hopf": f"a pair of frequency {closed.frequency:.6g} rad/s becomes stable there",
        "static": "without eccentricity, a real eigenvalue crosses there",
        "saddle": "two real eigenvalues of opposite sign cancel; no stability changes",
    }[closed.kind]
    print(
        f"\nClosed form of the reduced system with any friction, Eq. (126): {closed.spin:.6g} "
        f"rad/s; {meaning}."
    )
    return 0


def parse_spins(texts: list[str]) -> Array:
    """Spins in rad/s from values and ranges `first:last:number`, strictly increasing, (n,).

    Raises
    ------
    ValueError
        If a text is neither, a range is empty, descending or longer than `MOST_SPINS`, or the
        spins do not increase.
    """
    spins: list[float] = []
    for text in texts:
        parts = text.split(":")
        if len(parts) == 1:
            spins.append(written_number("--spin", text))
            continue
        if len(parts) != 3 or not parts[2].isdigit() or int(parts[2]) < 2:
            raise ValueError(
                f"--spin must be a value or FIRST:LAST:NUMBER with at least 2, got {text!r}"
            )
        first, last = written_number("--spin", parts[0]), written_number("--spin", parts[1])
        if first >= last:
            raise ValueError(f"--spin must have FIRST < LAST, got {text!r}")
        if int(parts[2]) > MOST_SPINS:
            raise ValueError(f"--spin must name at most {MOST_SPINS} spins, got {text!r}")
        spins += np.linspace(first, last, int(parts[2])).tolist()
    if np.any(np.diff(spins) <= 0.0):
        raise ValueError("--spin must increase strictly")
    return np.array(spins)


def _scenario(options: argparse.Namespace) -> Scenario:
    """Scenario of the options; a system names its model unless constraints are given."""
    model = {"full": 1, "reduced": 4}.get(options.system)
    if model is not None and options.model is None and options.constraints is None:
        options.model = model
    return chosen_scenario(options)


def _branches(options: argparse.Namespace, scenario: Scenario, spins: Array) -> Branches:
    if options.source == "in-house":
        return spectra.branches(scenario, spins, options.system, options.motion)
    from validation.studies.stability.eigenvalue_check import engine_matrices

    how = {"formulation": options.formulation, "motion": options.motion}
    matrices = [
        engine_matrices(scenario, np.array([spin]), **how) for spin in counted(spins, "spins")
    ]
    return Branches(spins=spins, values=spectra.follow(np.concatenate(matrices)))


def _table(name: str, found: Branches) -> Table:
    size = found.values.shape[1]
    heads = [f"{part} {index + 1}" for index in range(size) for part in ("Re λ", "Im λ")]
    return Table(
        name="eigenvalues",
        title=f"Eigenvalues of {name} in 1/s",
        columns=("spin in rad/s", *heads),
        rows=[
            [spin, *np.column_stack((values.real, values.imag)).ravel().tolist()]
            for spin, values in zip(found.spins.tolist(), found.values, strict=True)
        ],
    )


def _plot(found: Branches, path: Path) -> None:
    from validation.kit import figures

    figure, axes = figures.new_figure(2, height=6.5)
    for column in range(found.values.shape[1]):
        look = {
            "color": figures.COLOURS[column % 4],
            "linestyle": figures.STYLES[column // 4 % 4],
            "marker": "o" if found.spins.size == 1 else None,
        }
        axes[0].plot(found.spins, found.values[:, column].real, **look, label=f"λ{column + 1}")
        axes[1].plot(found.spins, found.values[:, column].imag, **look)
    axes[0].axhline(0.0, color="#999999", linewidth=0.8, zorder=0)
    axes[0].set(ylabel="Re λ in 1/s")
    axes[1].set(ylabel="Im λ in 1/s", xlabel="spinning speed Ω in rad/s")
    figures.legend_above(axes[0], columns=4)
    with whole_file(path) as stream:
        figure.savefig(stream, format=path.suffix[1:], dpi=150)
