"""Compute the long results that come with the package, and put them into it.

    python -m validation.studies.ship DIR [SECTION...]

Finished results are kept in DIR, so that it goes on there after an interruption, and takes what a
command of a study has left there. Sections that take longer are made only where they are named.
"""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from validation.kit import shipped
from validation.kit.provenance import Provenance
from validation.kit.report import run_kept
from validation.studies.full_report import STUDIES


def compute(section: str, folder: Path) -> shipped.Shipment:
    """Compute what is shipped for a section.

    Parameters
    ----------
    section : str
        Name of one of `full_report.STUDIES`.
    folder : Path
        Gets what is finished.
    """
    (study,) = (study for study in STUDIES if study.name == section)
    # The commit may move on meanwhile.
    provenance = Provenance.here()
    jobs = [*study.shipped(), *study.long()]
    seconds = study.expected_seconds(quick=False)
    parts = run_kept(jobs, folder, workers=study.workers, title=section, seconds=seconds)
    return shipped.gather(jobs, parts, provenance)


def main(arguments: Sequence[str] | None = None) -> int:
    """Ship the results of some sections; exit code."""
    usual = [study.name for study in STUDIES if study.shipped()]
    longer = [study.name for study in STUDIES if study.long()]
    parser = argparse.ArgumentParser(
        prog="python -m validation.studies.ship", description=(__doc__ or "").split("\n")[0]
    )
    parser.add_argument("folder", metavar="DIR", type=Path, help="for what is finished")
    parser.add_argument(
        "sections",
        metavar="SECTION",
        nargs="*",
        help=f"{', '.join(usual)}; all of these by default; only by name: {', '.join(longer)}",
    )
    options = parser.parse_args(arguments)
    names = [*usual, *longer]
    if unknown := set(options.sections) - set(names):
        parser.error(f"SECTION must be one of {', '.join(names)}, got {min(unknown)!r}")
    # All of them first: a file that is written is a change of the sources.
    found = {name: compute(name, options.folder) for name in options.sections or usual}
    for name, made in found.items():
        made.write(shipped.path_of(name))
        size = shipped.path_of(name).stat().st_size
        sys.stdout.write(
            f"{name}: {len(made.parts)} results, {made.seconds:.0f} s of processor time, "
            f"{size / 1000:.0f} kB; {made.provenance.text()}\n"
        )
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
