"""What the work-precision study teaches, in sentences built from its runs."""

from collections.abc import Sequence
from itertools import product
from statistics import median

from validation.work_precision.figures import GOALS, NAMES
from validation.work_precision.problems import PROBLEMS
from validation.work_precision.runs import USEFUL, Run, curves, fastest
from validation.work_precision.tables import geometric_mean, option_pairs

CONSTRAINED = ("euler-tree", "floating", "floating-lie")
"""Formulations that keep constraints."""


def paragraphs(runs: Sequence[Run]) -> list[str]:
    """The lesson: which formulation and integrator to use for what, and why.

    A sentence whose runs were not made is left out.
    """
    made = (
        _topology(runs),
        _constrained(runs),
        _extrapolation(runs),
        _attitude(runs),
        _damping(runs),
        _options(runs),
        _stiff(runs),
        _drift(runs),
        _in_house(runs),
    )
    return [paragraph for paragraph in made if paragraph]


def _topology(runs: Sequence[Run]) -> str:
    """Closing the contact by topology, against keeping its constraint."""
    ratios, alone, reached = [], 0, 0
    for group in curves(runs, lambda run: run.problem).values():
        for goal in GOALS:
            free = fastest([run for run in group if run.formulation == "contact-tree"], goal)
            held = fastest([run for run in group if run.formulation in CONSTRAINED], goal)
            reached += free is not None
            if free is not None and held is not None:
                ratios.append(held.seconds / free.seconds)
            alone += free is not None and held is None
    if not reached:
        return ""
    text = (
        "Model 1: close the contact by topology. The contact tree has minimal coordinates and no "
        "constraint, so that no Newton iteration is needed and explicit methods of high order "
        "apply. "
    )
    if ratios:
        text += (
            "The fastest formulation with constraints takes "
            f"{_span(ratios)} times as long to the same error, {median(ratios):.0f} in the median "
            f"of {len(ratios)} pairs of problem and goal; "
        )
    return (
        f"{text}in {alone} of {reached} the contact tree alone gets there. It cannot tell "
        "friction the contact force, and its contact cannot open."
    )


def _constrained(runs: Sequence[Run]) -> str:
    """How often each formulation with constraints is the fastest."""
    parts = []
    for goal in GOALS[:2]:
        wins: dict[str, int] = {}
        for group in curves(runs, lambda run: run.problem).values():
            best = fastest([run for run in group if run.formulation in CONSTRAINED], goal)
            if best is not None:
                wins[best.formulation] = wins.get(best.formulation, 0) + 1
        ranked = sorted(wins.items(), key=lambda item: -item[1])
        if ranked:
            counts = ", ".join(f"{NAMES[name]} {count}" for name, count in ranked)
            parts.append(f"to {goal:g}: {counts}")
    if not parts:
        return ""
    return (
        "With constraints left, the number of problems in which each formulation is the fastest "
        f"of the three is, {_list(parts)} The table of formulations has the cases."
    )


def _extrapolation(runs: Sequence[Run]) -> str:
    """Extrapolated against plain runs at the same goal."""
    held = [run for run in runs if run.formulation in CONSTRAINED and not run.variant]
    texts = []
    for goal in (1e-2, 1e-3, 1e-4, 1e-6):
        gains, alone = [], 0
        for group in curves(held, lambda run: f"{run.problem}, {run.formulation}").values():
            plain = fastest([run for run in group if not run.extrapolated], goal)
            better = fastest([run for run in group if run.extrapolated], goal)
            if plain is not None and better is not None:
                gains.append(plain.seconds / better.seconds)
            alone += plain is None and better is not None
        parts = []
        if gains:
            parts.append(f"{geometric_mean(gains):.2g} times the speed in {len(gains)} cases")
        if alone:
            parts.append(f"the only way in {alone}")
        if parts:
            texts.append(f"to {goal:g}, " + " and ".join(parts))
    if not texts:
        return ""
    return (
        "Extrapolating runs with halved steps, all their time counted, against the implicit rules "
        f"alone: {_list(texts)}"
    )


def _attitude(runs: Sequence[Run]) -> str:
    """Lie group against Euler parameters at the same step."""
    errors, times = _ratios(runs, ("floating-lie", "trapezoidal"), ("floating", "trapezoidal"))
    if not errors:
        return ""
    return (
        "Attitude of the floating disk, trapezoidal rule at the same step: the rotation vector on "
        f"the Lie group has {_span(errors)} times the error of Euler parameters (median "
        f"{median(errors):.2g}) in {_span(times)} times the time (median {median(times):.2g})."
    )


def _damping(runs: Sequence[Run]) -> str:
    """Generalized-alpha at its spectral radii against the trapezoidal rule."""
    plain = [run for run in runs if not (run.variant or run.extrapolated)]
    held = [run for run in plain if run.formulation in CONSTRAINED]
    texts = []
    for scheme, group in sorted(curves(held, lambda run: run.scheme).items()):
        failed = sum(bool(run.failure) for run in group)
        text = f"{scheme} fails in {failed} of {len(group)} runs"
        if scheme != "trapezoidal":
            errors = [
                ratio
                for name in CONSTRAINED
                for ratio in _ratios(runs, (name, scheme), (name, "trapezoidal"))[0]
            ]
            if errors:
                text += f" and has {median(errors):.2g} times the error in the median"
        texts.append(text)
    if len(texts) < 2:
        return ""
    return (
        "Generalized-α takes the position-level constraints as they are (index 3), the "
        f"trapezoidal rule all of them on velocity level. Of the runs at equal steps, "
        f"{_list(texts)}"
    )


def _options(runs: Sequence[Run]) -> str:
    """Newton's options and the form of the friction function."""
    texts = []
    for variant, pairs in curves_of_pairs(runs).items():
        times = [one.seconds / other.seconds for one, other in pairs]
        worst = max(one.error / other.error for one, other in pairs)
        text = f"{variant} takes {geometric_mean(times):.2g} times the time"
        if worst > 1.1:
            text += f" and has up to {worst:.2g} times the error"
        texts.append(text)
    if not texts:
        return ""
    return f"Against modified Newton to 1e-12 and a Python friction function: {_list(texts)}"


def curves_of_pairs(runs: Sequence[Run]) -> dict[str, list[tuple[Run, Run]]]:
    """Runs with an option beside the plain ones, by option."""
    result: dict[str, list[tuple[Run, Run]]] = {}
    for pair in option_pairs(runs):
        result.setdefault(pair[0].variant, []).append(pair)
    return result


def _stiff(runs: Sequence[Run]) -> str:
    """What still works on the stiff problem."""
    stiff = [run for run in runs if run.problem == "stiff" and not run.extrapolated]
    texts = []
    for formulation, group in curves(stiff, lambda run: run.formulation).items():
        best = fastest(group, GOALS[0])
        steps = [run.setting for run in group if run.failure and run.fixed_step]
        text = f"{NAMES[formulation]} "
        if best is None:
            text += f"does not reach {GOALS[0]:g} on its ladder"
        else:
            text += f"reaches {GOALS[0]:g} with {best.way} in {1e3 * best.seconds:.3g} ms"
        if steps:
            text += f" and fails at steps down to {min(steps):.2g} s"
        texts.append(text)
    return f"Stiff friction, ε = 1e-3 m/s: {_list(texts)}{_step_control(stiff)}" if texts else ""


def _step_control(stiff: Sequence[Run]) -> str:
    """Steps of DOPRI5 beside those of fixed steps."""
    free = [run for run in stiff if run.formulation == "contact-tree" and not run.variant]
    controlled = fastest([run for run in free if not run.fixed_step], GOALS[0])
    if controlled is None:
        return ""
    steps = controlled.counts["steps"]
    rules = [run for run in free if run.scheme.startswith("RK")]
    fixed = [run for run in rules if run.counts.get("steps", 0) >= steps]
    text = f" Step control: DOPRI5 has an error of {controlled.error:.1g} after {steps} steps"
    if fixed:
        nearest = min(fixed, key=lambda run: (run.counts["steps"], run.error))
        text += (
            f", {nearest.scheme} of {nearest.error:.1g} after {nearest.counts['steps']} equal ones"
        )
    return text + "."


def _drift(runs: Sequence[Run]) -> str:
    """Constraint drift of the runs that are good to 1e-3."""
    texts = []
    good = [run for run in runs if run.error <= GOALS[0] and not run.extrapolated]
    for formulation, group in curves(good, lambda run: run.formulation).items():
        drift = max(run.errors.position_drift for run in group if run.errors is not None)
        texts.append(f"{NAMES[formulation]} {drift:.1e} m")
    if not texts:
        return ""
    return (
        f"Largest drift off the position constraints among the runs with an error of at most "
        f"{GOALS[0]:g}, extrapolated ones left out: {_list(texts)}"
    )


def _in_house(runs: Sequence[Run]) -> str:
    """SciPy's methods among each other."""
    wins: dict[str, int] = {}
    for group in curves(runs, lambda run: run.problem).values():
        for goal in GOALS:
            best = fastest([run for run in group if run.formulation == "index-1"], goal)
            if best is not None:
                wins[best.scheme] = wins.get(best.scheme, 0) + 1
    if not wins:
        return ""
    ranked = sorted(wins.items(), key=lambda item: -item[1])
    counts = ", ".join(f"{scheme} {count}" for scheme, count in ranked)
    return (
        f"The in-house index-1 equations get to a goal fastest with (number of cases): {counts}."
    )


def _ratios(
    runs: Sequence[Run], one: tuple[str, str], other: tuple[str, str]
) -> tuple[list[float], list[float]]:
    """Error and time of a formulation and scheme over those of another, at equal steps."""
    plain = {
        (run.problem, run.formulation, run.scheme, run.setting): run
        for run in runs
        if not (run.variant or run.extrapolated) and run.error < USEFUL
    }
    steps = {run.setting for run in plain.values()}
    errors, times = [], []
    for problem, step in product(PROBLEMS, sorted(steps)):
        first, second = plain.get((problem, *one, step)), plain.get((problem, *other, step))
        if first is not None and second is not None:
            errors.append(first.error / second.error)
            times.append(first.seconds / second.seconds)
    return errors, times


def _span(values: Sequence[float]) -> str:
    low, high = f"{min(values):.2g}", f"{max(values):.2g}"
    return low if low == high else f"{low} to {high}"


def _list(parts: Sequence[str]) -> str:
    return "; ".join(parts) + "."
