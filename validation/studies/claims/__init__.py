"""What the paper says of the motion: statements with criteria, measured numbers and verdicts."""

from collections import Counter

import pandas as pd

from analysis import LEVELS
from validation.page.content import Content, Rows, Verdict
from validation.studies import inversion
from validation.studies.claims import (
    attraction,
    contact_matrix,
    least_spins,
    motion,
    orders,
    pure_rolling,
)
from validation.studies.claims.claim import ANSWERS, Claim

TITLE = "What the paper says"
STUDIES = (
    inversion.STUDY,
    motion.LONG_RUNS,
    contact_matrix.CONTACT_MATRIX,
    pure_rolling.PURE_ROLLING,
    orders.ORDERS,
    least_spins.LEAST_SPINS,
    attraction.RANDOM_STARTS,
    attraction.IN_ENGINE,
)


def claims(rows: Rows) -> list[Claim]:
    """All statements, those of Sections 1 to 4 first."""
    table, longs = rows["inversion"], rows["long-runs"]
    short, whole = inversion.motions(table, inversion.SHORT), inversion.motions(table)
    levels = [whole[f"Model {level}", "engine"] for level in LEVELS]
    oscillation, *compared = motion.constraints(levels, longs)
    return [
        attraction.claim(attraction.shares(rows["random-starts"])),
        contact_matrix.claim(rows["contact-matrix"]),
        *motion.figure_7(short[inversion.CONTACT, "engine"], short["Model 1", "engine"]),
        *motion.drift(longs),
        oscillation,
        pure_rolling.claim(rows["pure-rolling"]),
        *compared,
        *motion.spinning(levels, longs),
        orders.claim(rows["closed-form-orders"]),
        least_spins.claim(rows["least-spins"].to_dict("records")),
    ]


EARLY = 10
"""Statements of Sections 1 to 4."""


def present(rows: Rows) -> Content:
    """All statements with their verdicts, and what stands behind those on other starts."""
    found = claims(rows)
    starts, in_engine = rows["random-starts"], rows["random-starts-engine"]
    rolled, orders_found = rows["pure-rolling"], rows["closed-form-orders"]
    least = rows["least-spins"].to_dict("records")
    shares = attraction.shares(starts)
    counted = Counter(each.verdict for each in found)
    table = pd.DataFrame(found)
    upright = shares[(shares["model"] == "Model 1") & (shares["starts"] == "near upright")]
    upright = upright.set_index("spin in rad/s")
    return Content(
        numbers={
            "claims": found,
            "counted": {answer: counted[answer] for answer in ANSWERS},
            "critical": least_spins.critical_speed(),
            "starts": attraction,
            "upright": upright.to_dict("index"),
            "tilted": shares[shares["starts"] == "any tilt"].groupby("model")["share inverted"],
            "rolled": rolled[rolled["gradient"].isna()],
            "scanned": least_spins,
        },
        tables={
            "early": table[:EARLY],
            "late": table[EARLY:],
            "least_spins": least_spins.table(least),
            "pure_rolling": pure_rolling.both_sides(rolled),
            "orders": orders_found.drop(columns="case"),
            "random_starts": shares,
            "random_starts_engine": attraction.confirmation(in_engine, starts),
        },
        figures={"pure_rolling": pure_rolling.draw(rolled), "attraction": attraction.draw(shares)},
        checks=[
            *contact_matrix.checks(rows["contact-matrix"]),
            *pure_rolling.checks(rolled),
            *least_spins.checks(least),
            *attraction.checks(in_engine, starts),
        ],
        verdicts=[
            Verdict(
                statement="What the paper says of the motion holds.",
                answer="yes" if counted["yes"] == len(found) else "partly",
                numbers=f"Of {len(found)} statements {counted['yes']} hold, {counted['partly']} "
                f"hold in part and {counted['no']} do not.",
                criterion="one for each statement, printed beside it with the numbers.",
            ),
            *(
                Verdict(
                    statement=f"{each.statement[0].upper()}{each.statement[1:]}.",
                    answer=each.verdict,
                    numbers=f"{each.measured[0].upper()}{each.measured[1:]}.",
                    criterion=f"{each.criterion}.",
                    good=each.verdict == "yes",
                )
                for each in (found[0], found[-1])
            ),
        ],
    )
