"""Pictures, one function each, sized for print.

Every function returns a `matplotlib.figure.Figure`, which needs no window system: ``figure.savefig("name.png")``. It
draws on Axes of your own where ``ax`` gives them, one for each panel. ``Described(figure, words)`` shows one in a
notebook with alternative text.
"""

from .comfort import comfort, third_octaves
from .described import Described
from .designs import carpet
from .feedback import feedback
from .fitted import fitted_map
from .frequency import bode, bode_magnitude, psd, spectra, study_curves
from .modes import mode_shape, mode_shapes
from .pareto import pareto
from .ride import ride, ride_animation
from .road import road_chart
from .scan import scenario_scan
from .steering import steering
from .study import error_map, response_surfaces
from .style import COLUMN, DPI, LINES, STYLE, WIDTH
from .validation import learning_curves, parity, residuals

__all__ = [
    "COLUMN",
    "DPI",
    "LINES",
    "STYLE",
    "WIDTH",
    "Described",
    "bode",
    "bode_magnitude",
    "carpet",
    "comfort",
    "error_map",
    "feedback",
    "fitted_map",
    "learning_curves",
    "mode_shape",
    "mode_shapes",
    "pareto",
    "parity",
    "psd",
    "residuals",
    "response_surfaces",
    "ride",
    "ride_animation",
    "road_chart",
    "scenario_scan",
    "spectra",
    "steering",
    "study_curves",
    "third_octaves",
]
