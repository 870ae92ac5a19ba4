"""The nonlinear dynamics as the report has it: part of the results shipped, a sample confirmed."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from analysis import Scenario
from analysis.data.trajectory import Source
from analysis.nonlinear.heteroclinic import Connection
from validation.kit import samples
from validation.kit.limits import largest
from validation.kit.report import Job, Section
from validation.kit.samples import Sample, fresh, fresh_key
from validation.studies.nonlinear import engine_cycles, passage
from validation.studies.nonlinear import section as study
from validation.studies.nonlinear.engine_cycles import Witness
from validation.studies.nonlinear.held_spin import HeldCycle
from validation.studies.nonlinear.passage import Passage

SHIPPED = (
    "held family",
    "engine cycle",
    "repeated cycle",
    "stationary",
    "connection",
    "connection of a disk",
    "passage",
    "slowed",
)
"""Kinds of jobs whose results come with the package; all others are run on the spot."""

EVERY = 25
"""Every so many samples of a passage are shipped."""

REPEATED = (
    ("connection of a disk", "steel"),
    ("connection", 0.1, 0.01),
    ("engine cycle", 30.5),
    ("repeated cycle", "Model 2 at held spin"),
    ("stationary", "Model 1 at held spin", 60.0),
    ("passage", study.REPEATED, "in-house"),
)
"""Keys of those that are run again."""


def shipped() -> list[Job]:
    """Jobs of the study whose results come with the package."""
    found = [job for job in study.jobs() if _is_shipped(job)]
    return [replace(job, function=_THINNED.get(job.function, job.function)) for job in found]


def thinned(found: Passage) -> Passage:
    """A passage with few of its samples, that of the lowest spin among them."""
    last = found.times.size - 1
    kept = np.unique((*range(0, last, EVERY), int(np.argmin(found.spins)), last))
    names = ("times", "spins", "deviations", "linear")
    return replace(found, **{name: getattr(found, name)[kept] for name in names})


def follow(scenario: Scenario, end: float, source: Source) -> Passage:
    """`passage.follow`, thinned."""
    return thinned(passage.follow(scenario, end, source))


def slowed(lever: float, source: Source) -> Passage:
    """`passage.slowed`, thinned."""
    return thinned(passage.slowed(lever, source))


def witness(spin: float) -> Witness:
    """`engine_cycles.witness` with the ends of the cycle alone."""
    found = engine_cycles.witness(spin)
    cycle = found.cycle
    ends = replace(cycle, times=cycle.times[[0, -1]], states=cycle.states[[0, -1]])
    return replace(found, cycle=ends)


_THINNED: dict[Callable[..., Any], Callable[..., Any]] = {
    engine_cycles.witness: witness,
    passage.follow: follow,
    passage.slowed: slowed,
}


def jobs() -> list[Job]:
    """Jobs of the study that are run on the spot, and those that confirm the shipped ones."""
    again = [fresh(job) for job in shipped() if job.key in REPEATED]
    return [*(job for job in study.jobs() if not _is_shipped(job)), *again]


def _is_shipped(job: Job) -> bool:
    return isinstance(job.key, tuple) and job.key[0] in SHIPPED


def section(results: dict[Any, Any]) -> Section:
    """The study's section, and what of it is shipped."""
    made = study.section(results)
    told = samples.table("nonlinear", shipped(), _samples(results))
    text = (
        "The cycles of Model 4 and the portraits are computed on the spot. The spins of the "
        "connection, the engine's cycles, those of Models 1 and 2, the stationary motions and the "
        "passages come with the package: the first table says what of them is confirmed."
    )
    return replace(made, paragraphs=[*made.paragraphs, text], tables=[told, *made.tables])


def _samples(results: Mapping[Any, Any]) -> list[Sample]:
    steel, friction, witnesses, cycle, motions, passages = (
        (results[key], results[fresh_key(key)]) for key in REPEATED
    )
    both: tuple[tuple[HeldCycle, HeldCycle], tuple[HeldCycle, HeldCycle]] = cycle
    apart = [_cycles_apart(one, other) for one, other in zip(*both, strict=True)]
    return [
        _connection("heteroclinic connection of the paper's disk", steel),
        _connection("the same for μ = 0.1, ε = 0.01 m/s", friction),
        Sample(what="the same for other friction, and the disk as printed"),
        Sample(
            what="cycle of Model 4 in the engine, at 30.5 rad/s",
            how="repeated",
            quantity="spin in rad/s, period in s, amplitude in rad",
            difference=_cycles_apart(*(each.engine for each in witnesses)),
            limit=1e-7,
        ),
        Sample(what="the same at other spins"),
        Sample(
            what="cycle of Model 2 at held spin, in-house",
            how="repeated",
            quantity="spin in rad/s, period in s, amplitude in rad",
            difference=apart[0],
            limit=1e-7,
        ),
        Sample(
            what="cycle of Model 2 at held spin, engine",
            how="repeated",
            quantity="spin in rad/s, period in s, amplitude in rad",
            difference=apart[1],
            limit=1e-6,
        ),
        Sample(what="the other cycles at held spin"),
        Sample(
            what="stationary motions of Model 1 at 60 rad/s",
            how="repeated",
            quantity="β and γ in rad",
            difference=_motions_apart(*motions),
            limit=1e-6,
        ),
        Sample(what="the other stationary motions"),
        Sample(
            what=f"passage {study.REPEATED}, in-house",
            how="repeated",
            quantity="time of the loss in s, lowest spin in rad/s",
            difference=_passages_apart(*passages),
            limit=3e-3,
        ),
        Sample(
            what="the same in the engine",
            how="the in-house run",
            quantity="time of the loss in s, lowest spin in rad/s",
            difference=_passages_apart(results["passage", study.REPEATED, "engine"], passages[1]),
            limit=3e-3,
        ),
        Sample(what="the other passages and the slowed disks"),
    ]


def _cycles_apart(one: HeldCycle, other: HeldCycle) -> float:
    """Largest difference of two cycles in rad/s, s and rad."""
    names = ("spin", "period", "amplitude")
    return largest(abs(getattr(one, name) - getattr(other, name)) for name in names)


def _connection(what: str, pair: tuple[Connection, Connection]) -> Sample:
    return Sample(
        what=what,
        how="found again",
        quantity="spin in rad/s",
        difference=abs(pair[0].spin - pair[1].spin),
        limit=1e-6,
    )


def _passages_apart(one: Passage, other: Passage) -> float:
    """Largest difference in s and rad/s; infinite if one is lost and the other is not."""
    spins = abs(one.lowest_spin - other.lowest_spin)
    if one.lost is None or other.lost is None:
        return spins if one.lost is other.lost else float("inf")
    return largest((abs(one.lost - other.lost), spins))


def _motions_apart(one: Any, other: Any) -> float:
    """Largest difference in attitude; infinite if there are not as many motions."""
    if len(one) != len(other):
        return float("inf")
    attitudes = (np.array([(each.beta, each.gamma) for each in found]) for found in (one, other))
    return largest(np.abs(np.subtract(*attitudes)).ravel().tolist())
