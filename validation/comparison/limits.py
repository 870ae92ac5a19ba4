"""What counts as agreement: the one place that says whether a difference holds."""

from collections.abc import Iterable
from math import inf, isfinite, isnan


def holds(difference: float | None, limit: float) -> bool:
    """Whether a difference has been measured and is at most a limit, both of them finite.

    Parameters
    ----------
    difference : float or None
        None if nothing has been measured.
    limit : float

    Examples
    --------
    >>> from math import inf, nan
    >>> [holds(difference, 1.0) for difference in (1.0, 1.1, nan, inf, None)]
    [True, False, False, False, False]
    >>> holds(inf, inf)
    False
    """
    return difference is not None and isfinite(difference) and bool(difference <= limit < inf)


def largest(differences: Iterable[float | None]) -> float:
    """Largest of some differences; infinite if there is none, or one has not been measured.

    Parameters
    ----------
    differences : iterable of float or None
        NaN and None are what has not been measured.

    Examples
    --------
    >>> from math import nan
    >>> largest([1.0, 2.0]), largest([1.0, nan]), largest([nan, 1.0]), largest([])
    (2.0, inf, inf, inf)
    """
    found = [inf if each is None or isnan(each) else float(each) for each in differences]
    return max(found, default=inf)
