"""Prices: what an option costs, from pairs of runs in turns."""

import dataclasses
from typing import Any

import pytest

from mbs_models import Integrator
from tests.helpers import not_none
from validation.studies.work_precision import prices
from validation.studies.work_precision.methods import EngineMethod
from validation.studies.work_precision.problems import PROBLEMS

RK44 = EngineMethod(formulation="contact-tree", integrator=Integrator(name="RK44"))


def test_price_is_the_median_of_pairs_and_says_when_it_is_noise() -> None:
    price = prices.Price(
        what="x",
        problem="model-1",
        formulation="floating",
        ratios=(1.1, 0.5, 1.2, 1.3, 9.0, 1.15, 1.1, 1.12, 1.2, 1.3, 1.2),
        work=1.0,
        error=1.0,
    )
    assert price.ratio == 1.2
    assert price.interval == (1.1, 1.3)
    assert price.told
    noise = dataclasses.replace(price, ratios=(0.98, 1.3, 1.01, 1.02, 1.1))
    assert not noise.told


@pytest.mark.slow
def test_price_takes_both_sides_in_turns(monkeypatch: pytest.MonkeyPatch) -> None:
    order: list[bool] = []
    run = EngineMethod.run

    def watched(method: EngineMethod, problem: Any, setting: float) -> Any:
        order.append(not_none(method.integrator.newton).modified)
        return run(method, problem, setting)

    monkeypatch.setattr(EngineMethod, "run", watched)
    case = next(case for case in prices.cases(True) if "full for" in case.what)
    price = prices.measure_price(case, True)
    assert order == [False, True] * (1 + prices.QUICK_PAIRS)
    assert price.error == pytest.approx(1.0, rel=1e-3)


def test_price_of_extrapolation_compares_equal_errors(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(prices, "QUICK_PAIRS", 1)
    side = prices.Side(problem=PROBLEMS["model-1"], method=RK44)
    case = prices.Comparison(what="x", one=side, other=side, goal=1e-4)
    price = prices.measure_price(case, True)
    # 100, 200 and 400 steps together against 400.
    assert price.work == 1.75
    assert price.error < 1.0


def test_price_of_extrapolation_passes_over_steps_that_fail(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    run = EngineMethod.run

    def failing(method: EngineMethod, problem: Any, setting: float) -> Any:
        if setting == 0.02:
            raise ArithmeticError("stopped")
        return run(method, problem, setting)

    monkeypatch.setattr(EngineMethod, "run", failing)
    monkeypatch.setattr(prices, "QUICK_PAIRS", 1)
    side = prices.Side(problem=PROBLEMS["model-1"], method=RK44)
    case = prices.Comparison(what="x", one=side, other=side, goal=1e-5)
    # 200, 400 and 800 steps together against 800.
    assert prices.measure_price(case, True).work == 1.75
