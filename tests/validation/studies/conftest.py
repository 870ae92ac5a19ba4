"""Runs that several tests look at."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from analysis import simulate
from analysis.problem.choices import SOURCES
from validation.studies import inversion


@pytest.fixture(scope="session")
def inversions() -> pd.DataFrame:
    """Rows of the inversion from in-house runs, which take the engine's place as well."""
    rows = []
    for case, (scenario, end) in inversion.cases().items():
        times = np.linspace(0.0, end, round(end / inversion.SPACING) + 1)
        run = simulate(scenario, times, local_tolerance=1e-6)
        run = replace(run, error_estimate=1e-8)
        told = {"case": case, "formulation": "index-1", "error_estimate": 1e-8}
        told |= inversion.agreement(run, run)
        told |= {name: getattr(run, name).tolist() for name in inversion.CURVES}
        rows += [told | {"source": source} for source in SOURCES]
    return pd.DataFrame(rows)
