"""The subcommand `robustness`: numerical stability on stiff and extreme cases."""

import argparse
import time

from validation.commands.options import output_folder


def robustness(options: argparse.Namespace) -> int:
    """Run the study and write its page, the full one as data, too; options are out and quick.

    Returns 1 if a result came back as right and is not, or if a run took the interpreter down.
    """
    from validation.kit.provenance import Provenance
    from validation.kit.report import run_jobs, write
    from validation.studies.robustness import section as study
    from validation.studies.robustness import stored

    folder = output_folder("--out", options.out)
    begin, provenance = time.perf_counter(), Provenance.here()
    results = run_jobs(study.jobs(quick=options.quick), title="robustness")
    section = study.section(results, quick=options.quick)
    page = write([section], folder, seconds=time.perf_counter() - begin)
    if not options.quick:
        outcomes = tuple(study.cases(results, quick=False))
        full = stored.Study(provenance=provenance, outcomes=outcomes)
        stored.write_study(full, folder / stored.FULL_STUDY)
    for table in section.tables[:2]:
        print(f"\n{table.title}\n{table.to_text()}")
    wrong = study.wrong(results)
    verdict = "No case crashed or broke its promise" if not wrong else f"{wrong} cases FAIL"
    print(f"\n{verdict}. Open {page}")
    return 1 if wrong else 0
