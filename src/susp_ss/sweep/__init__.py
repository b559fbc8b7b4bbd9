"""Grids of designs past one machine."""

from .store import Swept, sweep

__all__ = ["Swept", "sweep"]
