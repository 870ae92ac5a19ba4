"""What the paper says of the motion: statements with criteria, measured numbers and verdicts."""

from collections import Counter

from validation.page.content import Content, Judged, Rows, Verdict
from validation.studies import inversion
from validation.studies.claims import equations, motion, pure_rolling, starts

TITLE = "What the paper says"
STUDIES = (
    inversion.STUDY,
    motion.LONG_RUNS,
    pure_rolling.PURE_ROLLING,
    starts.LEAST_SPINS,
    starts.RANDOM_STARTS,
    starts.IN_ENGINE,
)


def present(rows: Rows) -> Content:
    """All statements with their verdicts, and what stands behind those on other starts."""
    runs, longs = inversion.motions(rows["inversion"]), rows["long-runs"]
    measured, change = motion.measured(runs), motion.change(runs)
    shares, rolled = starts.shares(rows["random-starts"]), rows["pure-rolling"]
    least, engine = rows["least-spins"], rows["random-starts-engine"]
    loss = equations.loss()
    attraction, critical = starts.judge_attraction(shares), starts.critical_speed()
    judgements = motion.judge(measured, change, longs) | {
        "attraction": attraction,
        "singular": equations.judge_loss(loss),
        "rolling": pure_rolling.judge(rolled),
        "orders": equations.judge_orders(equations.exponents()),
        "supercritical": starts.judge_least_spins(least),
    }
    counted = Counter(each["verdict"] for each in judgements.values())
    return Content(
        numbers={
            "c": judgements,
            "contact": measured.iloc[0],
            "levels": measured.iloc[1:],
            "change": change,
            "longs": longs,
            "long": longs.iloc[0],
            "counted": counted,
            "critical": critical,
            "shares": shares.groupby(["starts", "model"])["inverted in %"].max(),
        },
        tables={
            "least_spins": least.drop(columns=list(starts.ENDS.values())),
            "pure_rolling": rolled.drop(columns="rolls"),
            "random_starts": shares,
            "random_starts_engine": engine,
        },
        figures={"attraction": starts.draw(shares)},
        checks=[
            *equations.checks(loss),
            *motion.checks(longs),
            *pure_rolling.checks(rolled),
            *starts.checks(least, engine, rows["random-starts"]),
        ],
        verdicts=verdicts(counted, attraction, critical),
    )


def verdicts(counted: Counter[str], attraction: Judged, critical: float) -> list[Verdict]:
    """What is read first: how many statements hold, and the one on other starts."""
    upright = ", ".join(
        f"{row['inverted in %']:.0f} % at {row['spin']:g} rad/s ({row['from']:.0f} to "
        f"{row['to']:.0f})"
        for row in attraction["upright"].to_dict("records")
    )
    return [
        Verdict(
            statement="What the paper says of the motion holds.",
            answer="yes" if counted["yes"] == counted.total() else "partly",
            numbers=f"Of {counted.total()} statements {counted['yes']} hold, {counted['partly']} "
            f"hold in part and {counted['no']} do not.",
            criterion="one for each statement, printed beside it with the numbers.",
        ),
        Verdict(
            statement="Inverted spinning of a fast disk attracts nearly all trajectories.",
            answer=attraction["verdict"],
            numbers=f"Of {starts.NUMBER} random starts of Model 1 near upright invert, with "
            f"95 % intervals, {upright}; of those of any tilt at most "
            f"{attraction['tilted']['inverted in %'].max():.0f} %.",
            criterion=f"at least {100 * starts.NEARLY_ALL:g} %, of any tilt, at every spin "
            f"tried above {critical:.2f} rad/s; partly: near upright, at some of these spins.",
        ),
    ]
