"""A user's own expensive runs: read, fitted by every surrogate, ranked, and kept as a file."""

from .fitting import Fit, fit_runs
from .histories import read_histories
from .low_fidelity import LowFidelity
from .next_runs import next_runs
from .runs import Runs, read_runs
from .surrogate_file import SuspensionSurrogate, load_surrogate

__all__ = [
    "Fit",
    "LowFidelity",
    "Runs",
    "SuspensionSurrogate",
    "fit_runs",
    "load_surrogate",
    "next_runs",
    "read_histories",
    "read_runs",
]
