"""What the work-precision study teaches, in sentences built from its runs."""

from collections.abc import Sequence
from statistics import geometric_mean, median

from validation.kit.plain import rounded
from validation.studies.work_precision.figures import NAMES
from validation.studies.work_precision.prices import CONSTRAINED, Price
from validation.studies.work_precision.problems import PROBLEMS
from validation.studies.work_precision.runs import (
    GOALS,
    Run,
    by_hindsight,
    fastest,
    grouped,
    words,
)
from validation.studies.work_precision.stored import Study


def paragraphs(study: Study) -> list[str]:
    """The lesson: which formulation and integrator to use for what, and why.

    A sentence whose runs were not made is left out.
    """
    runs = by_hindsight(study.runs)
    made = (
        _topology(runs),
        _constrained(runs),
        _extrapolation(runs),
        _failing(study.runs),
        _prices(study.prices),
        carefulness(study),
        _stiff(study),
        _drift(runs),
        _in_house(runs),
    )
    return [paragraph for paragraph in made if paragraph]


def summary(study: Study) -> str:
    """The lesson in a few lines, for docs/results.md."""
    runs = by_hindsight(study.runs)
    ratios, _reached = _topology_ratios(runs)
    sentences = [
        "On Model 1, the fastest formulation with constraints takes "
        f"{_span(ratios)} times as long as the contact tree to the same error."
        if ratios
        else "",
        _failing(study.runs),
        _prices(study.prices),
        carefulness(study),
        repeatability(study),
    ]
    return " ".join(sentence for sentence in sentences if sentence)


def carefulness(study: Study) -> str:
    """By how much runs to a tolerance do more than they are asked for."""
    parts = []
    for goal in GOALS:
        runs = [run for run in study.runs if (run.kind, run.setting) == ("tolerance", goal)]
        margins = [goal / run.angle_error for run in runs if run.errors is not None]
        extra = [excess for run in runs if (excess := study.excess(run)) is not None]
        if margins and extra:
            parts.append(
                f"at {words(goal)} rad {rounded(median(margins), 2):.0f} times more accurate than "
                f"asked, for {median(extra):.2g} times the evaluations"
            )
    if not parts:
        return ""
    return (
        "Runs to a tolerance are more careful than they would have to be: in the median, "
        f"{_list(parts)} They are compared with the cheapest run of the same method that would "
        "do, which only a reference tells."
    )


def repeatability(study: Study) -> str:
    """How far the times of the rounds differ, for there are no closer ties than that."""
    scatters = sorted(run.scatter for run in study.runs if len(run.rounds) > 1)
    if not scatters:
        return ""
    most = scatters[int(0.95 * (len(scatters) - 1))]
    return (
        "Each time is the least of rounds minutes apart, which differ "
        f"{median(scatters):.2f} times in the median and no more than {most:.2g} times in 95 % of "
        "the runs: ways closer than that are equally fast."
    )


def _topology_ratios(runs: Sequence[Run]) -> tuple[list[float], int]:
    """Times with constraints over those without, and how many goals are reached without."""
    ratios, reached = [], 0
    for group in grouped(runs, lambda run: run.problem).values():
        for goal in GOALS:
            free = fastest([run for run in group if run.formulation == "contact-tree"], goal)
            held = fastest([run for run in group if run.formulation in CONSTRAINED], goal)
            reached += free is not None
            if free is not None and held is not None:
                ratios.append(held.seconds / free.seconds)
    return ratios, reached


def _topology(runs: Sequence[Run]) -> str:
    """Closing the contact by topology, against keeping its constraint."""
    ratios, reached = _topology_ratios(runs)
    if not ratios:
        return ""
    return (
        "Model 1: close the contact by topology. The contact tree has minimal coordinates and no "
        "constraint, so that no Newton iteration is needed and explicit methods of high order "
        "apply. The fastest formulation with constraints takes "
        f"{_span(ratios)} times as long to the same error, {median(ratios):.2g} in the median of "
        f"{len(ratios)} cases of problem and goal, of {reached} that the contact tree reaches. It "
        "cannot tell friction the contact force, and its contact cannot open."
    )


def _constrained(runs: Sequence[Run]) -> str:
    """How often each formulation with constraints is the fastest."""
    parts = []
    for goal in GOALS:
        wins: dict[str, int] = {}
        for group in grouped(runs, lambda run: run.problem).values():
            best = fastest([run for run in group if run.formulation in CONSTRAINED], goal)
            if best is not None:
                wins[best.formulation] = wins.get(best.formulation, 0) + 1
        ranked = sorted(wins.items(), key=lambda item: (-item[1], item[0]))
        if ranked:
            counts = ", ".join(f"{NAMES[name]} {count}" for name, count in ranked)
            parts.append(f"to {words(goal)}: {counts}")
    if not parts:
        return ""
    return (
        "With constraints left, the number of problems in which each formulation is the fastest "
        f"of the three is, {_list(parts)} The table of formulations has the cases."
    )


def _extrapolation(runs: Sequence[Run]) -> str:
    """Extrapolated against plain runs at the same goal, in work."""
    held = [run for run in runs if run.formulation in CONSTRAINED and run.scheme == "trapezoidal"]
    texts = []
    for goal in (1e-2, 1e-3, 1e-4, 1e-6):
        gains, alone = [], 0
        for group in grouped(held, lambda run: f"{run.problem}, {run.formulation}").values():
            good = [run for run in group if run.error <= goal]
            plain = min((run.work for run in good if run.kind == "step"), default=None)
            better = min((run.work for run in good if run.kind == "extrapolated"), default=None)
            if plain is not None and better is not None:
                gains.append(plain / better)
            alone += plain is None and better is not None
        parts = []
        if gains:
            parts.append(f"{geometric_mean(gains):.2g} times as many in {_cases(len(gains))}")
        if alone:
            parts.append(f"none that get there in {alone}, where extrapolated ones do")
        if parts:
            texts.append(f"to {words(goal)}, {' and '.join(parts)}")
    if not texts:
        return ""
    return (
        "Iterations of the trapezoidal rule alone, against all those that it takes extrapolated "
        f"from halved steps: {_list(texts)}"
    )


def _failing(runs: Sequence[Run]) -> str:
    """How often implicit rules fail at the steps of the ladders."""
    held = [run for run in runs if run.formulation in CONSTRAINED and run.kind == "step"]
    texts = [
        f"{scheme} fails in {sum(bool(run.failure) for run in group)} of {len(group)} runs"
        for scheme, group in sorted(grouped(held, lambda run: run.scheme).items())
    ]
    if len(texts) < 2:
        return ""
    return (
        "Generalized-α takes the position-level constraints as they are (index 3), the "
        f"trapezoidal rule all of them on velocity level. On the ladders of steps, {_list(texts)}"
    )


def _prices(prices: Sequence[Price]) -> str:
    """Median price of each option, with its range."""
    groups: dict[str, list[Price]] = {}
    for price in prices:
        groups.setdefault(price.what, []).append(price)
    texts = []
    for what, group in sorted(groups.items()):
        ratios = [price.ratio for price in group]
        text = (
            f"{what}: {median(ratios):.2g} times the time ({_span(ratios)} in {_cases(len(group))}"
        )
        doubtful = sum(not price.told for price in group)
        texts.append(text + (f", {doubtful} within scatter)" if doubtful else ")"))
    return f"Prices, each the median of pairs of runs in turns: {_list(texts)}" if texts else ""


def _stiff(study: Study) -> str:
    """Why explicit rules miss the stiff problem at long steps and hit it at short ones."""
    for curve in study.of("stiff", "contact-tree"):
        if curve.scheme != "RK67":
            continue
        plain = [run for run in curve.runs if run.kind == "step"]
        good = [run for run in plain if run.error <= GOALS[-1]]
        if good and plain[0] is not good[0]:
            before, first = plain[plain.index(good[0]) - 1], good[0]
            return (
                "Stiff friction, ε = 1e-3 m/s, on the contact tree: stability decides, not "
                f"accuracy. RK67 has an error of {before.error:.1g} with {before.counts['steps']} "
                f"steps and of {first.error:.1g} with {first.counts['steps']}, once its steps are "
                f"short enough to be stable.{_step_control(study)}"
            )
    return ""


def _step_control(study: Study) -> str:
    """Steps of DOPRI5."""
    runs = [
        run
        for curve in study.of("stiff", "contact-tree")
        if curve.scheme == "DOPRI5"
        for run in curve.runs
    ]
    best = fastest(runs, GOALS[0])
    if best is None:
        return ""
    return f" DOPRI5 finds them: an error of {best.error:.1g} after {best.counts['steps']} steps."


def _drift(runs: Sequence[Run]) -> str:
    """Constraint drift of the runs that are good to 1e-3."""
    texts = []
    good = [run for run in runs if run.error <= GOALS[0] and run.kind != "extrapolated"]
    for formulation, group in grouped(good, lambda run: run.formulation).items():
        drift = max(run.errors.position_drift for run in group if run.errors is not None)
        texts.append(f"{NAMES[formulation]} {drift:.1e} m")
    if not texts:
        return ""
    return (
        f"Largest drift off the position constraints among the runs with an error of at most "
        f"{words(GOALS[0])}, extrapolated ones left out: {_list(texts)}"
    )


def _in_house(runs: Sequence[Run]) -> str:
    """SciPy's methods among each other."""
    wins: dict[str, int] = {}
    for name in PROBLEMS:
        own = [run for run in runs if run.problem == name and run.formulation == "index-1"]
        for goal in GOALS:
            best = fastest(own, goal)
            if best is not None:
                wins[best.scheme] = wins.get(best.scheme, 0) + 1
    if not wins:
        return ""
    ranked = sorted(wins.items(), key=lambda item: (-item[1], item[0]))
    counts = ", ".join(f"{scheme} {count}" for scheme, count in ranked)
    return (
        f"The in-house index-1 equations get to a goal fastest with (number of cases): {counts}."
    )


def _cases(number: int) -> str:
    return "1 case" if number == 1 else f"{number} cases"


def _span(values: Sequence[float]) -> str:
    low, high = f"{min(values):.2g}", f"{max(values):.2g}"
    return low if low == high else f"{low} to {high}"


def _list(parts: Sequence[str]) -> str:
    return "; ".join(parts) + "."
