"""Models across the border: vehicles as FMUs and MATLAB files, FMUs of other programs as runs."""

from .exporting import export
from .fmu import FMU

__all__ = ["FMU", "export"]
