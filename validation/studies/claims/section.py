"""What the paper says of the motion: statements with criteria, measured numbers and verdicts."""

from collections import Counter

from validation.studies import inversion
from validation.studies.claims import equations, linear, motion, pure_rolling, starts
from validation.study import Content, Rows, grade

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
    measured, rolled = motion.measured(runs), rows["pure-rolling"]
    shares = starts.shares(rows["random-starts"])
    least, engine = rows["least-spins"], rows["random-starts-engine"]
    loss = equations.loss()
    judgements = (
        motion.judge(runs, measured, longs)
        | linear.judge()
        | {
            "attraction": starts.judge_attraction(shares),
            "singular": equations.judge_loss(loss),
            "rolling": pure_rolling.judge(rolled),
            "orders": equations.judge_orders(equations.exponents()),
            "supercritical": starts.judge_least_spins(least),
        }
    )
    told = shares.set_index(["starts", "model"])[[starts.INVERTED, starts.UNKNOWN]]
    counted = Counter(each["verdict"] for each in judgements.values())
    return Content(
        numbers={
            "c": judgements,
            "contact": measured.iloc[0],
            "levels": measured.iloc[1:],
            "longs": longs,
            "long": longs.iloc[0],
            "counted": counted,
            "answer": grade(yes=counted["yes"] == counted.total(), partly=True),
            "shares": told[starts.INVERTED].groupby(level=[0, 1]).max(),
            "bounds": told.sum(axis=1).groupby(level=[0, 1]).max(),
        },
        tables={
            "least_spins": least.drop(columns=list(starts.ENDS.values())),
            "pure_rolling": rolled.drop(columns="rolls"),
            "random_starts": shares,
            "random_starts_engine": engine,
        },
        figures={"attraction": lambda: starts.draw(shares)},
        checks=[
            *equations.checks(loss),
            *motion.checks(longs),
            *pure_rolling.checks(rolled),
            *starts.checks(least, engine, rows["random-starts"]),
        ],
    )
