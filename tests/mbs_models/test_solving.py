"""What Python raises within an engine run: it ends the run and comes out as it was raised."""

import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import mbs_models
from analysis import SmoothCoulomb, State
from mbs_models import FORMULATIONS, Formulation, Scene
from tests.scenes import rest_scene, scene_of

ROOT = Path(__file__).parents[2]
TIMES = np.linspace(0.0, 0.5, 51)


class UnheardError(Exception):
    pass


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


@pytest.fixture(autouse=True)
def _nothing_pending() -> Iterator[None]:
    yield
    PENDING.clear()


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
    PENDING.append((500, error))
    if formulation == "to rest":
        call: Callable[..., object] = partial(
            mbs_models.simulate_to_rest, rest_scene(friction=Failing()), 0.4
        )
    else:
        call = partial(mbs_models.simulate, scene_of(1, formulation, friction=Failing()), TIMES)
    with pytest.raises(type(error)) as caught:
        call(**({"step": 1e-5} if by_steps else {"tolerance": 1e-6}))
    assert caught.value is error
    assert caught.value.__cause__ is None


@pytest.mark.parametrize("formulation", FORMULATIONS)
def test_what_a_condition_raises_comes_out_as_it_is(formulation: Formulation) -> None:
    error = UnheardError("condition")

    def failing(state: State) -> float:
        if state.rates[4] > 0.5:
            raise error
        return 1.0

    with pytest.raises(UnheardError) as caught:
        mbs_models.simulate(scene_of(1, formulation), TIMES, tolerance=1e-5, stop_when=failing)
    assert caught.value is error


@pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="needs a timer that interrupts")
@pytest.mark.parametrize("scene", [
    scene_of(1, "contact-tree", friction=SmoothCoulomb(coefficient=0.0)),
    scene_of(2, "floating", friction=SmoothCoulomb(coefficient=0.0)),
    scene_of(2, "euler-tree"),
], ids=["no user function", "no friction", "friction"])  # fmt: skip
def test_a_signal_ends_a_run_at_once(scene: Scene) -> None:
    def interrupt(*_unused: object) -> None:
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGALRM, interrupt)
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.1)
        begin = time.monotonic()
        with pytest.raises(KeyboardInterrupt):
            mbs_models.simulate(scene, [0.0, 60.0], step=1e-5)
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
    # Whole, it takes minutes.
    assert time.monotonic() - begin < 10.0


CALLS = [
    "simulate --load contact --end 60",
    "simulate --model 2 --formulation floating --end 600",
    "simulate --model 2 --formulation euler-tree --end 600",
    "simulate --model 1 --mu 0 --tolerance 1e-11 --end 60",
    "rest",
]


@pytest.mark.slow
@pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="needs env of GNU")
@pytest.mark.parametrize("delay", [1.0, 2.0])
@pytest.mark.parametrize("call", CALLS)
def test_an_interrupted_command_ends_at_once_and_writes_nothing(
    call: str, delay: float, tmp_path: Path
) -> None:
    out = tmp_path / "run.npz"
    # What runs in the background of a script is born deaf to Ctrl-C.
    words = ["env", "--default-signal=INT", sys.executable, "-m", "validation", *call.split()]
    process = subprocess.Popen([*words, "--out", str(out)], cwd=ROOT, stderr=subprocess.PIPE)
    wait_for_engine(process.pid)
    time.sleep(delay)
    assert process.poll() is None
    process.send_signal(signal.SIGINT)
    said = process.communicate(timeout=10.0)[1]
    # A shell calls both 130.
    assert process.returncode in {130, -signal.SIGINT}
    assert said.endswith(b"interrupted\n")
    assert not list(tmp_path.iterdir())


def wait_for_engine(process: int) -> None:
    """Until a process has loaded the engine."""
    limit = time.monotonic() + 60.0
    while "exudyn" not in Path(f"/proc/{process}/maps").read_text():
        assert time.monotonic() < limit
        time.sleep(0.02)
