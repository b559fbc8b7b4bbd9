"""A user's own expensive runs: read, fitted by every surrogate, ranked, and kept as a file."""

from .fitting import Fit, fit_runs
from .histories import read_histories
from .low_fidelity import LowFidelity
from .runs import Runs, read_runs
from .surrogate_file import SuspensionSurrogate, load_surrogate

__all__ = [
    "Fit",
    "LowFidelity",
    "Runs",
    "SuspensionSurrogate",
    "fit_runs",
    "load_surrogate",
    "read_histories",
    "read_runs",
]
