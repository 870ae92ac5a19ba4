"""What agrees with what, over all sections of the report, to one digit each."""

from validation.kit.tables import Cell, Table, Tables, at_most
from validation.studies.comparisons import ANGLE_LIMIT
from validation.studies.crosscheck import END, states_counted
from validation.studies.rest import runs as rest
from validation.studies.stability.eigenvalue_check import CHECKED_SPINS, FEW_SPINS


def table(tables: Tables) -> Table:
    """The largest differences between engine and in-house equations.

    Parameters
    ----------
    tables : Tables
        Those of all sections.
    """
    return Table(
        name="agreement",
        title="What agrees with what",
        columns=("compared", "over", "largest difference"),
        rows=[*_states_and_motions(tables), *_eigenvalues(tables), _rest(tables), _spin(tables)],
        note="Each rounded up to one digit, from the tables below.",
    )


def _states_and_motions(tables: Tables) -> list[list[Cell]]:
    scenes = len(tables.by_name["crosscheck-models"].rows)
    states = tables.numbers("crosscheck-models", "accelerations", "constraint forces")
    motions = tables.numbers("crosscheck-models", "β and γ")
    angles = tables.numbers("figure-agreement", "max difference of β, γ")
    forces = tables.numbers("figure-agreement", "of normal force")
    return [
        [
            "accelerations and constraint forces, engine with in-house",
            f"{states_counted(tables)} of each of {scenes} scenes",
            f"{at_most(max(states))} relative",
        ],
        [
            f"trajectories, engine with in-house, to a tolerance of {at_most(ANGLE_LIMIT)} rad",
            f"{END:g} s from Table 3, {scenes} scenes",
            f"{at_most(max(motions))} rad in β and γ",
        ],
        [
            "trajectories of the paper's figures, engine with in-house",
            "4 s from Table 3, Models 1 to 4",
            f"{at_most(max(angles))} rad in β and γ, {at_most(max(forces))} N in the normal force",
        ],
    ]


def _eigenvalues(tables: Tables) -> list[list[Cell]]:
    models = tables.numbers("eigenvalues", "inverted", "noninverted")
    sets = tables.numbers("eigenvalues-of-sets", "engine against in-house")
    return [
        [
            "eigenvalues of inverted and noninverted spinning, engine with in-house",
            f"{CHECKED_SPINS.size} spins from 0 to 60 rad/s, Models 1 to 4, every formulation",
            f"{at_most(max(models))} relative",
        ],
        [
            "the same",
            (
                f"{FEW_SPINS.size} spins, all {len(sets)} possible sets of constraints, every "
                "formulation"
            ),
            f"{at_most(max(sets))} relative",
        ],
    ]


def _rest(tables: Tables) -> list[Cell]:
    row = tables.row("rest-phases", rest.SHOWN, "in-house")
    apart = [
        cell
        for heading, cell in row.items()
        if heading.startswith("largest difference") and isinstance(cell, float)
    ]
    return [
        f"the way to rest, engine with in-house, steps of {1e3 * rest.STEP:g} ms",
        f"from Table 3 until the disk lies still, after {row['rest']:.1f} s",
        f"{at_most(max(apart))} rad in the tilt",
    ]


def _spin(tables: Tables) -> list[Cell]:
    closed, computed = (
        tables.row("stability-numbers", f"critical spin, {how}")
        for how in ("closed form (126)", "computed")
    )
    here = "here, unrounded disk"
    values = (closed[here], computed[here], computed["engine, unrounded disk"])
    shown = dict.fromkeys(f"{value:.4f}" for value in values if isinstance(value, float))
    return [
        "critical speed of the reduced system: closed form, root finding, engine",
        "–",
        f"{', '.join(shown)} rad/s, all three" if len(shown) == 1 else f"{', '.join(shown)} rad/s",
    ]
