"""Pictures, one function each, sized for print.

Every function returns a `matplotlib.figure.Figure`, which needs no window system: ``figure.savefig("name.png")``.
"""

from .frequency import bode_magnitude, study_curves
from .study import error_map, response_surfaces
from .style import DPI, LINES, STYLE, WIDTH
from .validation import learning_curves, parity, residuals

__all__ = [
    "DPI",
    "LINES",
    "STYLE",
    "WIDTH",
    "bode_magnitude",
    "error_map",
    "learning_curves",
    "parity",
    "residuals",
    "response_surfaces",
    "study_curves",
]
