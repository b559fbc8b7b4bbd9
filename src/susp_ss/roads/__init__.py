"""Roads: spectra of the surface under the wheels, and profiles drawn from them."""

from .profiles import synthesise, wheel_heights
from .road import CLASSES, DEFAULT_ROAD, REFERENCE_WAVENUMBER, TRACKS, Road

__all__ = ["CLASSES", "DEFAULT_ROAD", "REFERENCE_WAVENUMBER", "TRACKS", "Road", "synthesise", "wheel_heights"]
