"""What Python raises within an engine run: it ends the run and comes out as it was raised."""

import signal
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import pytest

import mbs_models
from analysis import SmoothCoulomb, State
from mbs_models import FORMULATIONS, Formulation
from tests.scenes import LOADED, TIMES, rest_scene, runner, scene_of


class Beyond(BaseException):
    pass


@dataclass(frozen=True, slots=True, kw_only=True)
class Failing(SmoothCoulomb):
    """A law that raises at one of its next calls, once it is told to."""

    def per_speed(self, speed: float) -> float:
        if PENDING:
            calls, error = PENDING.pop()
            if not calls:
                raise error
            PENDING.append((calls - 1, error))
        return SmoothCoulomb.per_speed(self, speed)


PENDING: list[tuple[int, BaseException]] = []
"""After how many calls a law raises what."""


@pytest.mark.parametrize(
    "error",
    [LookupError("no such friction"), ValueError("law"), KeyboardInterrupt(), Beyond()],
    ids=lambda error: type(error).__name__,
)
@pytest.mark.parametrize("formulation", [*FORMULATIONS, "to rest"])
@pytest.mark.parametrize("by_steps", [False, True], ids=["tolerance", "step"])
def test_what_a_law_raises_ends_a_run_and_comes_out_as_it_is(
    formulation: Any, by_steps: bool, error: BaseException
) -> None:
    PENDING[:] = [(500, error)]
    call = runner(formulation, TIMES, friction=Failing())
    with pytest.raises(type(error)) as caught:
        call(**({"step": 1e-5} if by_steps else {"tolerance": 1e-6}))
    assert caught.value is error
    assert caught.value.__cause__ is None


@pytest.mark.parametrize("formulation", FORMULATIONS)
def test_what_a_condition_raises_comes_out_as_it_is(formulation: Formulation) -> None:
    error = LookupError("condition")

    def failing(state: State) -> float:
        if state.rates[4] > 0.5:
            raise error
        return 1.0

    with pytest.raises(LookupError) as caught:
        mbs_models.simulate(scene_of(1, formulation), TIMES, tolerance=1e-5, stop_when=failing)
    assert caught.value is error


SMOOTH = SmoothCoulomb(coefficient=0.0)
long_run = partial(mbs_models.simulate, times=[0.0, 60.0])


@pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="needs a timer that interrupts")
@pytest.mark.parametrize("call", [
    partial(long_run, scene_of(1, "contact-tree", friction=SMOOTH), step=1e-5),
    partial(long_run, scene_of(1, friction=LOADED), times=[0.0, 600.0]),
    partial(long_run, scene_of(2, "floating", friction=SMOOTH), step=1e-5),
    partial(long_run, scene_of(2, "euler-tree"), step=1e-5),
    partial(mbs_models.simulate_to_rest, rest_scene(), 600.0),
], ids=["no user function", "accelerations", "no friction", "friction", "to rest"])  # fmt: skip
def test_a_signal_ends_a_run_at_once(call: Callable[[], object]) -> None:
    def interrupt(*_unused: object) -> None:
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGALRM, interrupt)
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.1)
        begin = time.monotonic()
        with pytest.raises(KeyboardInterrupt):
            call()
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
    # Whole, it takes a minute or more.
    assert time.monotonic() - begin < 10.0
