"""What pairs of times tell."""

from math import comb

import pytest

from validation.measurement.timing import CONFIDENCE, in_turns, interval


def test_turns_are_taken_in_either_order_and_told_by_call_after_a_warm_up() -> None:
    made: list[str] = []

    def call(name: str) -> int:
        made.append(name)
        return len(made)

    results = in_turns(lambda: call("a"), lambda: call("b"), pairs=3)
    assert "".join(made) == "ab" + "ba" + "ab" + "ba"
    assert results == [[4, 5, 8], [3, 6, 7]]


@pytest.mark.parametrize("pairs", [8, 11, 31, 100])
def test_the_interval_of_a_median_is_the_narrowest_that_holds_it_as_surely_as_is_said(
    pairs: int,
) -> None:
    _, low, high = interval([float(each) for each in reversed(range(pairs))])

    def held(first: float) -> float:
        # By counting: it is missed if no more than so many of all pairs lie on one side of it.
        return 1.0 - sum(comb(pairs, each) for each in range(int(first) + 1)) / 2 ** (pairs - 1)

    assert high == pairs - 1 - low
    assert held(low + 1) < CONFIDENCE <= held(low)
