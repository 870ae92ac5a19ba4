"""What the paper says of the motion: statements with criteria, measured numbers and verdicts."""

from collections import Counter
from collections.abc import Iterator

from validation.page.content import Content, Rows, Verdict
from validation.studies import inversion
from validation.studies.claims import contact_matrix, motion, orders, pure_rolling, starts
from validation.studies.claims.grades import ANSWERS, Judged

TITLE = "What the paper says"
STUDIES = (
    inversion.STUDY,
    motion.LONG_RUNS,
    contact_matrix.CONTACT_MATRIX,
    pure_rolling.PURE_ROLLING,
    orders.ORDERS,
    starts.LEAST_SPINS,
    starts.RANDOM_STARTS,
    starts.IN_ENGINE,
)


def judge(rows: Rows) -> dict[str, Judged]:
    """All statements, by the names that the text has for them."""
    runs = inversion.motions(rows["inversion"])
    short = inversion.motions(rows["inversion"], inversion.SHORT)
    return motion.judge(runs, short, rows["long-runs"]) | {
        "attraction": starts.judge_attraction(starts.shares(rows["random-starts"])),
        "singular": contact_matrix.judge(rows["contact-matrix"]),
        "rolling": pure_rolling.judge(rows["pure-rolling"]),
        "orders": orders.judge(rows["closed-form-orders"]),
        "supercritical": starts.judge_least_spins(rows["least-spins"]),
    }


def present(rows: Rows) -> Content:
    """All statements with their verdicts, and what stands behind those on other starts."""
    judged = judge(rows)
    counted = Counter(each["verdict"] for each in judged.values())
    shares, rolled = starts.shares(rows["random-starts"]), rows["pure-rolling"]
    least, engine = rows["least-spins"], rows["random-starts-engine"]
    return Content(
        numbers={
            "c": judged,
            "counted": {answer: counted[answer] for answer in ANSWERS},
            "critical": starts.critical_speed(),
            "shares": shares.groupby(["starts", "model"])["inverted in %"].max(),
        },
        tables={
            "least_spins": least.drop(columns=["engine", "engine above"]),
            "pure_rolling": pure_rolling.both_sides(rolled),
            "orders": rows["closed-form-orders"].drop(columns="case"),
            "random_starts": shares,
            "random_starts_engine": engine,
        },
        figures={"attraction": starts.draw(shares)},
        checks=[
            *contact_matrix.checks(rows["contact-matrix"]),
            *pure_rolling.checks(rolled),
            *starts.checks(least, engine, rows["random-starts"]),
        ],
        verdicts=list(verdicts(judged, counted)),
    )


def verdicts(judged: dict[str, Judged], counted: Counter[str]) -> Iterator[Verdict]:
    """What is read first: how many statements hold, and the one on other starts."""
    yield Verdict(
        statement="What the paper says of the motion holds.",
        answer="yes" if counted["yes"] == len(judged) else "partly",
        numbers=f"Of {len(judged)} statements {counted['yes']} hold, {counted['partly']} hold in "
        f"part and {counted['no']} do not.",
        criterion="one for each statement, printed beside it with the numbers.",
    )
    found, critical = judged["attraction"], starts.critical_speed()
    told = ", ".join(
        f"{row['inverted in %']:.0f} % at {row['spin']:g} rad/s ({row['from']:.0f} to "
        f"{row['to']:.0f})"
        for row in found["upright"]
    )
    yield Verdict(
        statement="Inverted spinning of a fast disk attracts nearly all trajectories.",
        answer=found["verdict"],
        numbers=f"Of {starts.NUMBER} random starts of Model 1 near upright invert, with 95 % "
        f"intervals, {told}; of those of any tilt at most {found['tilted']:.0f} %.",
        criterion=f"at least {found['enough']:g} %, of any tilt, at every spin tried above "
        f"{critical:.2f} rad/s; partly: near upright, at some of these spins.",
        good=found["verdict"] == "yes",
    )
