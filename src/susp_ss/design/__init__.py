"""Design: search over parameters. Vehicles and roads in; the designs that no other beats out."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach(
    __name__, submod_attrs={"pareto": ["ParetoFront", "pareto_front"], "scenarios": ["Scenarios"]}
)
