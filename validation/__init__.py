"""Cross-checks, studies, figures, report and command line."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from validation.animation.player import Page


def play() -> "Page":
    """Page on which the disk of Model 1 is spun by hand, with sliders, which a notebook shows.

    The equations are integrated in the browser: no kernel, network or other file is needed.

    Returns
    -------
    Page

    Examples
    --------
    >>> from validation import play
    >>> "friction coefficient" in play().text
    True
    """
    # The command line imports this package, and has its help without NumPy.
    from validation.animation.play import page  # noqa: PLC0415

    return page()
