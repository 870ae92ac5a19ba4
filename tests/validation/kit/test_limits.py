"""What is no agreement: no number, or nothing measured."""

from math import inf, nan

import pytest

from validation.kit.limits import holds, largest


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
