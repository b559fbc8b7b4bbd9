"""Models across the border: vehicles as FMUs and MATLAB files, FMUs of other programs as runs."""

from .exporting import export

__all__ = ["export"]
