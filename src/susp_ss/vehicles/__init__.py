"""Vehicles: parameters -> masses and links -> second-order matrices -> `control.StateSpace`."""

from .full import FullCar
from .half import PitchHalfCar, RollHalfCar
from .parameters import Corners, Sweep
from .quarter import QuarterCar, RigidTyreQuarterCar
from .vehicle import Vehicle

__all__ = [
    "Corners",
    "FullCar",
    "PitchHalfCar",
    "QuarterCar",
    "RigidTyreQuarterCar",
    "RollHalfCar",
    "Sweep",
    "Vehicle",
]
