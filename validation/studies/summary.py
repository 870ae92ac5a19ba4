"""The first box of the report: its question, the verdicts and whether all checks hold.

Every number is taken from the tables of the sections that follow, or from the studies that come
with the package, so that box and section cannot tell different things.
"""

from collections import Counter
from collections.abc import Callable, Sequence

import mbs_models
from analysis import LEVELS, MODELS, Scenario, Start
from analysis.stability.linear_variants import PRINTED
from mbs_models import Scene
from validation.kit.limits import largest
from validation.kit.page import Section, Verdict
from validation.kit.tables import Cell, Tables, at_most
from validation.studies import agreement, crosscheck
from validation.studies.claims.claim import VERDICTS
from validation.studies.rest import runs as rest
from validation.studies.robustness import stored as robustness
from validation.studies.robustness.causes import GOOD
from validation.studies.stability.tables import stable_range
from validation.studies.work_precision import stored as work_precision
from validation.studies.work_precision.problems import PROBLEMS, ProblemName
from validation.studies.work_precision.runs import Run, fastest

QUESTION = (
    "A rigid disk whose centre of gravity lies off its centre is spun on a table and turns itself "
    "upside down: does it do so as Sailer and Leine say, and from which spinning speed on? And "
    "can the multibody engine Exudyn be trusted with it, in which formulation, at what price?"
)

PRINTED_SPIN = 30.92
"""Critical speed of the reduced system in the paper, in rad/s."""


def section(sections: Sequence[Section]) -> Section:
    """The box, from the sections of the report that follow it."""
    tables = Tables.of(sections)
    makers: tuple[Callable[[Tables], Verdict], ...] = (
        _inversion,
        _critical_speed,
        _hopf_speeds,
        _stable_region,
        _agreement,
        _rest,
        _fastest,
        _hard_cases,
    )
    number, failed = tables.checks()
    checks = f"All {number} checks of this report hold."
    if failed:
        checks = f"Checks FAIL in: {'; '.join(failed)}. The others of {number} hold."
    found = tables.column("claims", "verdict")
    told = ", ".join(f"{found.count(word)} {word}" for word in VERDICTS if word in found)
    return Section(
        name="summary",
        title="In one minute",
        paragraphs=[
            QUESTION,
            (
                f"{checks} Of {len(found)} statements of the paper about the motion, judged by "
                f"criteria printed beside them: {told}."
            ),
        ],
        verdicts=[make(tables) for make in makers],
        tables=[agreement.table(tables)],
    )


def _inversion(tables: Tables) -> Verdict:
    times = tables.column("figure-agreement", "inverted after s")
    told = [f"{time:.2f}" if isinstance(time, float) else "–" for time in times]
    apart = max(tables.numbers("figure-agreement", "max difference of β, γ"))
    return Verdict(
        statement="The disk turns itself upside down.",
        answer="yes" if all(isinstance(time, float) for time in times) else "partly",
        numbers=f"From Table 3, at {Start().spin:g} rad/s, Models {LEVELS[0]} to {LEVELS[-1]} are "
        f"inverted after {', '.join(told[:-1])} and {told[-1]} s.",
        certainty="engine and in-house equations follow each other to "
        f"{at_most(apart)} rad over 4 s.",
        section="inversion",
    )


def _critical_speed(tables: Tables) -> Verdict:
    closed = tables.row("stability-numbers", "critical spin, closed form (126)")
    computed = tables.row("stability-numbers", "critical spin, computed")
    here = "here, unrounded disk"
    ways = [_number(closed[here]), _number(computed[here])]
    engine = _number(computed["engine, unrounded disk"])
    confirmed = all(round(value, 2) == PRINTED_SPIN for value in (*ways, engine))
    return Verdict(
        statement=f"In the reduced system, inverted spinning is stable from {PRINTED_SPIN:g} "
        "rad/s on.",
        answer="confirmed" if confirmed else "not confirmed",
        numbers=f"Closed form {ways[0]:.4f}, root finding {ways[1]:.4f}, engine {engine:.4f} "
        "rad/s.",
        certainty="three independent ways, apart by at most "
        f"{at_most(max(*ways, engine) - min(*ways, engine))} rad/s.",
        section="stability",
    )


def _hopf_speeds(tables: Tables) -> Verdict:
    rows = [tables.row("stability-numbers", name) for name in ("Ω_crit1", "Ω_crit2")]
    here = [_number(row["here, unrounded disk"]) for row in rows]
    engine = [_number(row["engine, unrounded disk"]) for row in rows]
    apart = max(abs(a - b) for a, b in zip(here, engine, strict=True))
    tried = tables.column("variants", "gives both printed speeds")
    confirmed = all(round(a, 1) == b for a, b in zip(here, PRINTED, strict=True))
    return Verdict(
        statement=f"In the full system, pairs of eigenvalues cross at {PRINTED[0]} and "
        f"{PRINTED[1]} rad/s.",
        answer="confirmed" if confirmed else "not confirmed",
        numbers=f"They cross at {here[0]:.2f} and {here[1]:.2f} rad/s.",
        certainty="matrices, numerical linearisation and engine agree (the engine to "
        f"{at_most(apart)} rad/s); {tried.count('yes') or 'none'} of {len(tried)} obvious other "
        f"choices {'give' if tried.count('yes') > 1 else 'gives'} the printed pair.",
        section="stability",
    )


def _stable_region(tables: Tables) -> Verdict:
    scenario = Scenario(constraints=MODELS[1])
    own = stable_range(scenario, (0.0, 60.0))
    gradients = [float(cell) for cell in tables.numbers("corners", "μ/ε")]
    spins = tables.numbers("corners", "spin")
    worst = largest(tables.numbers("eigenvalues", "inverted"))
    region = "No region is found in which it is stable."
    if gradients:
        region = (
            f"Between {min(gradients):.2g} and {max(gradients):.2g} s/m there is a region in "
            f"which it is stable, with corners from {min(spins):.3g} to {max(spins):.3g} rad/s."
        )
    return Verdict(
        statement="In the full system, inverted spinning is always unstable.",
        answer="no" if own != "nowhere" else "partly" if gradients else "yes",
        numbers=f"At the paper's friction gradient μ/ε = 3 s/m it is stable {own} from 0 to 60 "
        f"rad/s. {region}",
        certainty="linear stability, its boundaries by continuation and closed form; at the "
        f"paper's friction the engine has the same eigenvalues to {at_most(worst)}, relative.",
        section="stability",
    )


def _agreement(tables: Tables) -> Verdict:
    motion = max(tables.numbers("crosscheck-models", "β and γ"))
    accelerations = max(tables.numbers("crosscheck-models", "accelerations", "constraint forces"))
    eigenvalues = max(tables.numbers("crosscheck-models", "eigenvalues"))
    scenes = len(tables.by_name["crosscheck-models"].rows)
    verdicts = tables.column("crosscheck-models", "agrees")
    states = crosscheck.states_counted(tables)
    return Verdict(
        statement="The engine solves the same equations as the in-house ones.",
        answer="yes" if verdicts and all(each is True for each in verdicts) else "no",
        numbers=f"Over {scenes} scenes: accelerations and constraint forces at {states} "
        f"to {at_most(accelerations)}, motions over 2 s to {at_most(motion)} rad, eigenvalues to "
        f"{at_most(eigenvalues)}.",
        certainty="both sides share the description of the problem and no mechanics; a test "
        "reads the imports. Shipped results, those of one scene of each model made again here.",
        section="crosscheck",
    )


def _rest(tables: Tables) -> Verdict:
    case = rest.SHOWN
    row = tables.row("rest-phases", case, "engine")
    other = tables.row("rest-phases", case, "in-house")
    apart = next(cell for heading, cell in other.items() if heading.startswith("largest diff"))
    sliding = tables.row("rest-phases", rest.SLIDING, "in-house")["rest"]
    return Verdict(
        statement="The disk comes to lie flat.",
        answer="not by sliding friction alone" if sliding is None else "yes",
        numbers="With sliding friction alone it "
        + (f"still creeps after {rest.END:g} s" if sliding is None else f"rests at {sliding:g} s")
        + f"; with dry rolling resistance and pivoting friction it inverts after "
        f"{_number(row['inversion']):.2f} s, loses the inversion after "
        f"{_number(row['inversion lost']):.1f} s and lies still after "
        f"{_number(row['rest']):.1f} s.",
        certainty="engine and in-house equations agree to "
        f"{at_most(_number(apart))} rad in the tilt, from shipped runs of which the in-house one "
        "and a coarser half of the engine's are made again here; the coefficients of rolling and "
        "pivoting are chosen here, not the paper's.",
        section="rest",
    )


def _fastest(tables: Tables) -> Verdict:
    study = work_precision.shipped()
    best = {} if study is None else {name: _fastest_run(study, name) for name in _MODELS}
    ways = "; ".join(_way(name, run) for name, run in best.items())
    free = {name: _unconstrained(name) for name in best}
    first = [run is not None and run.formulation in free[name] for name, run in best.items()]
    holds_so = any(free.values()) and first == [bool(each) for each in free.values()]
    runs, same = (
        sum(tables.numbers("work-precision-confirmed", heading))
        for heading in ("runs", "same work")
    )
    machine = "" if study is None else f"times of {study.provenance.machine}; "
    return Verdict(
        statement="Which way is fastest?",
        answer=f"{'' if holds_so else 'not '}the one without constraints, where there is one",
        good=holds_so,
        numbers=f"Processor time in the engine for 2 s of motion to 1e-6 rad: {ways}.",
        certainty=f"{machine}on this machine {same:.0f} of {runs:.0f} runs of a selection take "
        "the same work.",
        section="work-precision",
    )


_MODELS: tuple[ProblemName, ...] = ("model-1", "model-2", "model-3", "model-4")


def _unconstrained(name: ProblemName) -> list[str]:
    """Formulations of a problem that leave no constraint."""
    scenario = PROBLEMS[name].scenario
    return [
        formulation
        for formulation in mbs_models.formulations(scenario)
        if not Scene(scenario, formulation).has_constraints
    ]


def _fastest_run(study: work_precision.Study, name: ProblemName) -> Run | None:
    curves = study.of(name, *mbs_models.formulations(PROBLEMS[name].scenario))
    return fastest([run for curve in curves for run in curve.runs], 1e-6)


def _way(name: ProblemName, best: Run | None) -> str:
    problem = PROBLEMS[name]
    if best is None:
        return f"{problem.title} not reached"
    return f"{problem.title} {float(f'{1e3 * best.seconds:.2g}'):g} ms ({best.method})"


def _hard_cases(tables: Tables) -> Verdict:
    study = robustness.shipped()
    outcomes = () if study is None else study.outcomes
    counts = Counter[str](outcome.verdict for outcome in outcomes)
    broken = sum(outcome.broken for outcome in outcomes)
    ends = sum(counts[each] for each in GOOD[1:])
    rest_of_them = len(outcomes) - counts[GOOD[0]] - ends
    asked = sorted({outcome.tolerance for outcome in outcomes})
    accuracy = " to ".join(f"{each:g}" for each in dict.fromkeys((*asked[:1], *asked[-1:])))
    known, same = (
        sum(tables.numbers("robustness-confirmation", heading))
        for heading in ("of them in the full study", "same verdict")
    )
    return Verdict(
        statement="What becomes of stiff and extreme cases?",
        answer=f"of these cases {broken or 'none'} crashes or breaks its promise",
        numbers=f"Of {len(outcomes)} cases asked for {accuracy} rad, {counts[GOOD[0]]} are "
        f"accurate and {ends} end early, accurately, as where the contact would pull; "
        f"{rest_of_them} give no accurate result, for reasons that are counted below.",
        good=not broken,
        certainty=f"each is measured against another method; {same:.0f} of {known:.0f} of them "
        "repeated in this run have the same verdict.",
        section="robustness",
    )


def _number(cell: Cell) -> float:
    """A cell that has to hold a number."""
    if isinstance(cell, bool) or not isinstance(cell, int | float):
        raise TypeError(f"expected a number in the report's tables, got {cell!r}")
    return float(cell)
