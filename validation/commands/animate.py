"""The commands that write pages to play with: `animate` and `play`."""

from pathlib import Path

import validation
from validation.commands.output import name_of
from validation.commands.scenarios import stored_runs
from validation.parser.kinds import AnimationOut, Own, PageOut, Run


def animate(
    file: Run,
    *,
    out: AnimationOut = None,
    begin: float | None = None,
    end: float | None = None,
    speed: float | None = None,
    fps: float | None = None,
    width: int | None = None,
    own: Own,
) -> int:
    """Turn a stored motion into a page that plays it, or a GIF.

    Write a page that plays a motion stored by simulate or rest, and needs no network; or, with
    --out FILE.gif, an animated picture.

    Parameters
    ----------
    file
        Motion written by simulate or rest, .npz.
    out
        .html or .gif to write (FILE with .html).
    begin
        In s (that of the motion).
    end
        In s (that of the motion).
    speed
        1 for real time (0.1 until the disk is inverted).
    fps
        GIF only: frames per second (20).
    width
        GIF only: width and height in pixels (480).
    """
    out = out or file.with_suffix(".html")
    of_gif = {"fps": fps, "width": width}
    (run,) = stored_runs([file], **own)
    title = f"The tippedisk: {name_of(file)}"
    shown = validation.animate(run, begin=begin, end=end, speed=speed, title=title)
    given = {name: value for name, value in of_gif.items() if value is not None}
    detail, poses = shown.save(out, **given), shown.poses
    print(f"{out}: {poses.times[0]:g} to {poses.times[-1]:g} s, {detail}")
    return 0


def play(*, out: PageOut = Path("play.html")) -> int:
    """Write a page on which the disk is spun by hand.

    Its sliders set the start, the friction and the disk; the equations of Model 1 are integrated
    in the browser, without a network.

    Parameters
    ----------
    out
        Page to write, .html or -.
    """
    from analysis.motion.files import write_whole
    from validation.kit.animation.play import page

    made = page()
    write_whole(out, made)
    size = len(made.encode()) / 1e3
    print(f"{out}: a page of {size:.0f} kB; open it in a browser")
    return 0
