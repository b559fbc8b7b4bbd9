"""Responses of a vehicle to a road: over frequency, over time, and as exact covariance."""

from .frequency import frequency_response, psd
from .invariant import invariant_points
from .peaks import peaks
from .ratios import coherence, transmissibility
from .simulation import simulate

__all__ = ["coherence", "frequency_response", "invariant_points", "peaks", "psd", "simulate", "transmissibility"]
