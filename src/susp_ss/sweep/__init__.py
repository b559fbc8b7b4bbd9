"""Grids of designs past one machine."""

from .run import Swept, sweep

__all__ = ["Swept", "sweep"]
