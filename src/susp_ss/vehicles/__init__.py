"""Vehicles: parameters -> masses and links -> second-order matrices -> `control.StateSpace`."""

import lazy_loader

MODELS = {
    "full": "full.FullCar",
    "quarter": "quarter.QuarterCar",
    "quarter-seat": "quarter.QuarterCarWithSeat",
    "rigid-tyre": "quarter.RigidTyreQuarterCar",
    "pitch-half": "half.PitchHalfCar",
    "roll-half": "half.RollHalfCar",
    "ride-handling": "ride_handling.RideHandlingCar",
    "three-axle": "truck.ThreeAxleTruck",
}
"""Every vehicle: its name in files and on the command line, its module and its class."""

CLASSES: dict[str, list[str]] = {}
for _place in MODELS.values():
    _module, _, _class = _place.partition(".")
    CLASSES.setdefault(_module, []).append(_class)

__getattr__, __dir__, __all__ = lazy_loader.attach(
    __name__,
    submod_attrs=CLASSES
    | {
        "linear": ["LinearVehicle"],
        "parameters": ["Corners"],
        "curves": ["DamperCurve", "SpringCurve"],
        "seats": ["Seat"],
        "vehicle": ["Vehicle"],
    },
)
