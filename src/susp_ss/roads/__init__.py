"""Roads: spectra of the surface under the wheels, and profiles drawn from them."""

from .iri import iri, mean_iri
from .obstacles import obstacle
from .profile_files import read_profile
from .profiles import synthesise, wheel_heights
from .road import CLASSES, DEFAULT_ROAD, REFERENCE_WAVENUMBER, TRACKS, Road
from .road_fit import FittedRoad, fit_road

__all__ = [
    "CLASSES",
    "DEFAULT_ROAD",
    "REFERENCE_WAVENUMBER",
    "TRACKS",
    "FittedRoad",
    "Road",
    "fit_road",
    "iri",
    "mean_iri",
    "obstacle",
    "read_profile",
    "synthesise",
    "wheel_heights",
]
