"""Cross-checks, studies, figures, report and command line."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from analysis import StoredRun
    from validation.kit.animation.player import Animation, Page


def animate(
    run: "StoredRun",
    *,
    begin: float | None = None,
    end: float | None = None,
    speed: float | None = None,
    title: str = "The tippedisk",
) -> "Animation":
    """Player of a motion, which a notebook shows and `save` writes as a page or a GIF.

    Parameters
    ----------
    run : Trajectory or SpatialMotion
    begin, end : float, optional
        Part of it in s, by default all.
    speed : float, optional
        1 for real time; by default slow enough for the inversion to be seen.
    title : str

    Returns
    -------
    Animation

    Raises
    ------
    ValueError
        If the part is none of the motion, its samples are too far apart to be animated, or the
        speed is out of range.

    Examples
    --------
    >>> import numpy as np
    >>> from analysis import Scenario, simulate
    >>> from validation import animate
    >>> animate(simulate(Scenario(), np.linspace(0.0, 0.1, 11)), end=0.05).poses.times[-1]
    np.float64(0.05)
    """
    # The command line imports this package, and has its help without NumPy.
    from validation.kit.animation.keyframes import keyframes  # noqa: PLC0415
    from validation.kit.animation.player import player  # noqa: PLC0415

    poses = keyframes(run, begin, end)
    return player(poses, title=title, speed=speed)


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
    from validation.kit.animation.play import page  # noqa: PLC0415

    return page()
