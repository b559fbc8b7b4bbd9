"""Roads: spectra of the surface under the wheels, and profiles drawn from them."""

from .iri import iri, mean_iri
from .profiles import synthesise, wheel_heights
from .road import CLASSES, DEFAULT_ROAD, REFERENCE_WAVENUMBER, TRACKS, Road

__all__ = [
    "CLASSES",
    "DEFAULT_ROAD",
    "REFERENCE_WAVENUMBER",
    "TRACKS",
    "Road",
    "iri",
    "mean_iri",
    "synthesise",
    "wheel_heights",
]
