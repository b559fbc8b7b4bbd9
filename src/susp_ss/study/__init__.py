"""The feasibility study, beside its published tables, and the scan over what it leaves unsaid."""

from .feasibility import Study, feasibility_study
from .scan import Scan, scan_scenarios

__all__ = ["Scan", "Study", "feasibility_study", "scan_scenarios"]
