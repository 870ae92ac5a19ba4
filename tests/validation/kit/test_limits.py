"""What is no agreement: no number, or nothing measured."""

from math import inf, nan

import pytest

from validation.kit.limits import holds, largest
from validation.kit.tables import at_most


@pytest.mark.parametrize("difference", [nan, inf, None])
@pytest.mark.parametrize("limit", [1.0, inf, nan])
def test_what_has_not_been_measured_never_holds(difference: float | None, limit: float) -> None:
    assert not holds(difference, limit)
    assert not holds(0.5, nan)
    assert holds(0.5, 0.5)


@pytest.mark.parametrize("found", [[], [nan, 1.0], [1.0, nan], [None, 1.0], [1.0, inf]])
def test_largest_of_what_is_not_all_measured_is_infinite(found: list[float | None]) -> None:
    assert largest(found) == inf
    assert largest([1.0, 2.0, 0.5]) == 2.0


@pytest.mark.parametrize(
    ("value", "told"),
    [(7.3e-10, "8e-10"), (2e-7, "2e-7"), (9.5e-3, "1e-2"), (0.0, "0"), (inf, "inf"), (nan, "nan")],
)
def test_a_difference_is_told_by_one_digit_that_it_does_not_exceed(
    value: float, told: str
) -> None:
    assert at_most(value) == told
