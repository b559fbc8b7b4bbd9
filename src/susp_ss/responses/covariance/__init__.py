"""The exact covariance route: variances without a spectrum or a record, each design by the fastest way it admits."""

from .linearisation import linearised
from .matrices import covariance

__all__ = ["covariance", "linearised"]
