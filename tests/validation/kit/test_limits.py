"""What counts as agreement."""

from math import inf, nan

import pytest

from validation.kit.limits import holds, largest

NOTHING = (nan, inf, None)


@pytest.mark.parametrize("value", NOTHING)
def test_what_is_no_number_is_within_no_limit(value: float | None) -> None:
    assert not holds(value, 1.0)
    assert not holds(value, inf)
    assert not holds(0.0, nan)
    assert holds(1.0, 1.0)


@pytest.mark.parametrize("value", NOTHING)
def test_largest_of_what_is_not_all_measured_is_beyond_every_limit(value: float | None) -> None:
    assert largest([1.0, value]) == largest([value, 1.0]) == largest([]) == inf
    assert largest([1.0, 2.0, 0.5]) == 2.0
