"""Cars of curved springs and dampers by statistical linearisation: the linear car whose forces come closest.

Each damper's force f(v) is replaced by ``c v + f0`` with ``c = E[f v] / E[v^2]`` and ``f0 = E[f]``, each spring's by
``k (d - m) + E[f]`` with ``k = E[f'(d)]`` about the mean deflection m, under the Gaussian motion of that very linear
car (Caughey 1963; Roberts and Spanos 1990). The mean is where the mean forces balance: unequal slopes of a damper pump
the body up or down. Nothing dissipates but dampers, so that on a white road a quarter car's power ``c E[v^2]`` is
``q kt / 2`` whatever c is, and its ``c E[d^2]`` is ``q (ms + mu) / 2``: what the rounds below go by is the logarithm of
these two at each corner, which hardly change from car to car, and not c and k themselves. A round asks the fast routes
for the variances of the designs that still move; where they are few it asks for their neighbours' as well and takes
Newton's steps, else Broyden's rank-one updates take them.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...roads.road import Road
from ...vehicles.curves import Curve, DamperCurve, SpringCurve
from ...vehicles.laws import Means
from ...vehicles.parameters import DesignSpace
from ...vehicles.vehicle import Vehicle
from ..balance import balanced
from ..excitation import check_kinds, spanned
from .routes import covariance_variances

Array = NDArray[np.float64]

# Powers (relative) and with them rates and mean deflections stand still to this; rounds after which a design is
# refused; and the longest step of a round at first, as a power of e.
CONVERGED, ROUNDS, LONGEST = 1e-10, 50, 1.0

# A round of so few designs, neighbours counted, takes hardly longer than one of a single design. How far neighbours are
# in each x; a step no longer than that is Newton's last, along which powers and variances are known: what is left is of
# the order of its square.
FEW, NEAR = 250, 5e-6

# No variance is taken as smaller.
STILL = 1e-24

# Newton's steps to the deviation of one corner's velocity, and the step from which on it is found.
STEPS, SETTLED = 60, 1e-11


class State(NamedTuple):
    """Rates at every corner, their means where they come of curves, and mean deflections (N, corners)."""

    cs: list[Any]
    ks: list[Any]
    damping: list[Means | None]
    stiffness: list[Means | None]
    mean: Array


class Linearised(NamedTuple):
    """The linear cars of N designs, the state that made them, and variances (N, outputs) of all outputs."""

    vehicle: Any
    state: State
    variances: Array
    rounds: NDArray[np.int_]

    @property
    def shift(self) -> Array:
        """Mean deflections (N, corners)."""
        return self.state.mean

    def select(self, designs: slice) -> Linearised:
        """The same of some of the designs."""

        def some(x: Any) -> Any:
            if isinstance(x, list):
                return [some(part) for part in x]
            if isinstance(x, Means):
                return Means(*map(some, x))
            return x[designs] if isinstance(x, np.ndarray) else x

        state = State(*map(some, self.state))
        return Linearised(self.vehicle.select(designs), state, self.variances[designs], self.rounds[designs])


def linearised(vehicle: Vehicle, road: Road) -> Vehicle:
    """The linear vehicle whose springs and dampers come closest to a vehicle's curves on a random road.

    Statistical linearisation: with Gaussian motion, the damping rate ``E[f v] / E[v^2]`` and the stiffness
    ``E[f'(d)]``, of the motion of the vehicle that they make, to a fixed point of 1e-10.

    Parameters
    ----------
    vehicle : Vehicle
        With a `DamperCurve` for some ``cs``, a `SpringCurve` for some ``ks``, or both; parameters may be arrays. One
        without curves is returned as it is.
    road : Road
        What it rides on. Its speed, roughness and cut-off may be arrays, whose dims the result's rates then have.

    Returns
    -------
    Vehicle
        Of the same kind, with numbers (for a sweep arrays) in place of the curves, for modes, frequency responses and
        python-control.

    Raises
    ------
    TypeError, ValueError
        No vehicle or road; a damper without force; a damper or spring whose motion has no finite variance; a design
        that does not settle, by its place.

    Notes
    -----
    Exact where forces are linear, and as good as motion is Gaussian where they are not. Errors in per cent against
    simulations of 600 s of a quarter car (3 kN s/m in both slopes together, 20 m/s, classes A to D; digressive: knee at
    0.2 m/s, 0.3 of the slope beyond; stops: 150 kN/m from 40 mm in bump and 50 mm in rebound):

    =============================  =====  ============  ============  ============  ============
    damper (bump:rebound), spring  class  bacc          sws           dtl           damper_power
    =============================  =====  ============  ============  ============  ============
    two slopes 1:2                 A-D    -0.9          -2.6          -1.0          -0.1
    two slopes 1:3                 A-D    -2.0          -5.9          -2.4          -0.2
    two slopes 1:4                 A-D    -3.0          -8.4          -3.4          -0.3
    digressive 1:1                 A-D    -0.9 to 0     -1.1 to -0.1  -1.0 to -0.1  -0.1
    digressive 1:3                 A-D    -2.9 to -2.2  -5.9 to -3.5  -2.6 to -1.4  -0.3
    two slopes 1:3, stops          C, D   -2.4, -3.3    -5.7, -5.3    -2.3, -2.6    -0.2, 0.9
    digressive 1:1, stops          C, D   -1.2, 3.8     -1.3, 1.8     -1.1, -0.2    -0.1, 0.6
    digressive 1:3, stops          C, D   -4.5, 1.0     -4.6, 0.7     -2.4, -0.8    -0.3, 0.6
    =============================  =====  ============  ============  ============  ============

    So it is good to 2 % in body acceleration and tyre load up to 1:2.5 (1:2 if digressive, too) and for symmetric
    digression, and in damper power always; not in the deflection beyond 1:1.8, nor where stops are hit often.

    Examples
    --------
    >>> from susp_ss import DamperCurve, QuarterCar, Road, linearised
    >>> car = QuarterCar(cs=DamperCurve.digressive(bump=1500.0, rebound=3500.0, knee=0.15, final=0.3))
    >>> smooth, rough = (linearised(car, Road.iso8608(name, speed=20.0)) for name in "AC")
    >>> round(smooth.cs), round(rough.cs)
    (2362, 1494)
    >>> smooth.modes()["damping_ratio"].round(2).tolist()
    [0.44, 0.4]
    """
    check_kinds(vehicle, road)
    if not vehicle.curved:
        return vehicle
    space, flat, ground = spanned(vehicle, road)
    straight = linearise(flat, space, ground).vehicle
    known: dict[int, Any] = {}

    def number(own: Any, found: Any) -> Any:
        if not isinstance(own, Curve):
            return own
        if id(found) not in known:
            values = np.broadcast_to(found, space.size)
            known[id(found)] = space.unflatten(values) if space.dims else float(values[0])
        return known[id(found)]

    numbers = {
        field: [number(*pair) for pair in zip(vehicle.at_wheels(field), straight.at_wheels(field), strict=True)]
        for field in ("cs", "ks")
        if any(isinstance(x, Curve) for x in vehicle.at_wheels(field))
    }
    return vehicle.straightened(numbers)


def linearise(
    flat: Vehicle, space: DesignSpace, road: Road, designs: int = 1, leaders: NDArray[np.int_] | None = None
) -> Linearised:
    """Linearise a flattened vehicle's designs, which may be part of a sweep of more ``designs``.

    Each takes the state of the one that ``leaders`` (N,) names for it, its own by default: through a weighting on the
    road, a car is the one that it is on the road itself.
    """
    every = np.arange(space.size)
    leaders = every if leaders is None else leaders
    rounds = _Rounds(flat, road, space, designs)
    pushing = np.all([np.broadcast_to(rounds.first_cs[i], space.size) > 0.0 for i, *_ in rounds.damped], axis=0)
    if not np.all(pushing):
        raise ValueError(
            f"{type(flat).__name__}{space.place(int(np.argmin(pushing)))} has a damper whose curve gives no force as "
            "it moves; pass one that rises in bump or rebound"
        )
    x, variances, count = _settled(rounds, leaders)
    straight, state = rounds.straight(x, every)
    return Linearised(straight, state._replace(mean=rounds.shift(state)), variances, count)


def _settled(rounds: _Rounds, leaders: NDArray[np.int_]) -> tuple[Array, Array, NDArray[np.int_]]:
    """Where all designs stand still, their variances there, and after how many rounds."""
    x, moving = rounds.first(), np.unique(leaders)
    N, n = x.shape
    last, step, inverse = np.zeros_like(x), np.zeros_like(x), np.tile(-np.eye(n), (N, 1, 1))
    variances, count = np.empty((N, len(rounds.flat.layout().outputs))), np.zeros(N, dtype=int)
    away, longest, alone = np.full(N, np.inf), np.full(N, LONGEST), np.zeros((1, n))
    neighbours = np.concatenate([alone, NEAR * np.eye(n)])
    for number in range(ROUNDS):
        newton = len(moving) * len(neighbours) <= FEW
        # Newton may arrive with the second round, and those that follow come along from there.
        chosen = np.flatnonzero(np.isin(leaders, moving)) if newton and number else moving
        powers, found = rounds.answer(x[leaders[chosen]], chosen, neighbours if newton else alone)
        powers, count[chosen] = powers[np.isin(chosen, moving)], number + 1
        finite = np.isfinite(powers).all(axis=(1, 2))
        if not finite.all():
            raise rounds.unbounded(int(moving[np.argmin(finite)]))
        residual = powers[:, 0] - x[moving]
        if newton:
            inverse[moving] = np.linalg.inv((powers[:, 1:] - powers[:, :1]).mT / NEAR - np.eye(n))
        elif number:
            inverse[moving] = _updated(inverse[moving], step[moving], residual - last[moving])
        last[moving], step[moving] = residual, -(inverse[moving] @ residual[..., None])[..., 0]
        # No first step goes further than powers do; those of Newton's that lead astray were too long.
        far, away[moving] = away[moving], np.abs(residual).max(axis=-1)
        longest[moving] *= np.where(newton & (away[moving] > far), 0.5, 1.0)
        most = longest[moving] if number else np.maximum(away[moving], LONGEST)
        step[moving] /= np.maximum(np.abs(step[moving]).max(axis=-1) / most, 1.0)[:, None]
        x[moving] += step[moving]
        variances[chosen] = _after(step[leaders[chosen]], found) if newton else found[:, 0]
        moving = moving[np.abs(step[moving]).max(axis=-1) > (NEAR if newton else CONVERGED)]
        if not len(moving):
            break
    else:
        raise rounds.unsettled(int(moving[0]))
    behind = np.flatnonzero(count < count[leaders])
    if len(behind):
        variances[behind] = rounds.answer(x[leaders[behind]], behind, alone)[1][:, 0]
    return x[leaders], variances, count[leaders]


def _after(step: Array, found: Array) -> Array:
    """Variances (m, outputs) after steps (m, n), from those (m, 1 + n, outputs) of designs and of their neighbours."""
    here = found[:, 0]
    with np.errstate(invalid="ignore"):
        after = here + np.einsum("mi,mio->mo", step, found[:, 1:] - here[:, None]) / NEAR
    return np.where(np.isfinite(here), np.maximum(after, 0.0), here)


def _updated(inverse: Array, step: Array, change: Array) -> Array:
    """Broyden's update of inverse Jacobians (N, n, n), after a step has changed the residual."""
    moved = (inverse @ change[..., None])[..., 0]
    along = (step[:, None] @ inverse)[:, 0]
    size = np.einsum("ni,ni->n", step, moved)
    size = np.where(np.abs(size) > 1e-12 * np.einsum("ni,ni->n", step, step), size, np.inf)
    return np.asarray(inverse + ((step - moved) / size[:, None])[..., None] * along[:, None])


class _Rounds:
    """From the logarithms x (N, n) of powers to linear cars, and from these back to powers."""

    def __init__(self, flat: Vehicle, road: Road, space: DesignSpace, designs: int):
        self.flat, self.road, self.space, self.designs, self.N = flat, road, space, designs, space.size
        dampers, springs = flat.at_wheels("cs"), flat.at_wheels("ks")
        self.start = flat.middling()
        self.first_cs, self.first_ks = self.start.at_wheels("cs"), self.start.at_wheels("ks")
        self.groups = self._groups(dampers, springs)
        self.damped = [group for group in self.groups if isinstance(dampers[group[0]], Curve)]
        self.sprung = [group for group in self.groups if isinstance(springs[group[0]], Curve)]
        # Deviations of the dampers' velocities that were found last.
        self.sigma = np.empty((self.N, len(self.damped)))
        self._compliance: Array | None = None

    def _groups(self, dampers: tuple[Any, ...], springs: tuple[Any, ...]) -> list[list[int]]:
        """Corners that move alike, as left and right of a symmetric car; they must have such curves and such a road."""
        names = list(self.flat.wheels)
        met = [self.road.wheels is None or name in self.road.wheels for name in names]
        mean = self.start.halves()[:1]
        groups = [[names.index(corner) for corner in strut] for half in mean for strut in half.struts]
        alike = all(
            met[i] == met[group[0]] and (not isinstance(at[group[0]], Curve) or at[group[0]].alike(at[i]))
            for at in (dampers, springs)
            for group in groups
            for i in group
        )
        return groups if groups and alike else [[i] for i in range(len(names))]

    def first(self) -> Array:
        """Where the rounds begin: with what the tyres take in, if there are any."""
        powers = [self._taken_in(i) for i, *_ in self.damped]
        for j, ((i, *_), power) in enumerate(zip(self.damped, powers, strict=True)):
            self.sigma[:, j] = np.sqrt(power / self.first_cs[i])
        powers += [_weight(self.first_cs[i]) * SpringCurve.middling**2 for i, *_ in self.sprung]
        return np.log(np.stack([np.broadcast_to(power, self.N) for power in powers], axis=-1))

    def _taken_in(self, i: int) -> Any:
        """Power at a corner: on a white road half its intensity times the tyre's stiffness, whatever the dampers."""
        if not hasattr(self.flat, "kt"):
            return self.first_cs[i] * DamperCurve.middling**2
        kt, road = self.flat.at_wheels("kt")[i], self.road
        hop = np.sqrt(kt / self.flat.at_wheels("mu")[i])
        white = 0.5 * hop**2 * road.psd(hop / (2.0 * np.pi * road.speed)) / road.speed
        return 0.5 * kt * white

    def straight(self, x: Array, chosen: NDArray[np.int_]) -> tuple[Vehicle, State]:
        """The linear cars of some designs, their rates and about which mean they are."""
        some, columns = self.flat.select(chosen), iter(np.exp(x).T)
        dampers, springs = some.at_wheels("cs"), some.at_wheels("ks")
        cs, ks = list(dampers), list(springs)
        damping, stiffness = (list[Means | None]([None] * len(cs)) for _ in range(2))
        for j, group in enumerate(self.damped):
            damper = dampers[group[0]]
            self.sigma[chosen, j], means = _deviation(damper, next(columns), self.sigma[chosen, j])
            for i in group:
                cs[i], damping[i] = means.slope, means
        mean, travel = np.zeros((len(chosen), len(cs))), np.ones((len(chosen), len(cs)))
        if self.sprung:
            for group in self.sprung:
                travel[:, group] = np.sqrt(next(columns) / _weight(cs[group[0]]))[:, None]
            mean = self._mean(springs, travel, damping, chosen)
        for group in self.sprung:
            first = group[0]
            means = springs[first].means(travel[:, first], mean[:, first])
            for i in group:
                ks[i], stiffness[i] = means.slope, means
        return some.straightened({"cs": cs, "ks": ks}), State(cs, ks, damping, stiffness, mean)

    def answer(self, x: Array, chosen: NDArray[np.int_], around: Array) -> tuple[Array, Array]:
        """Powers (m, k, n) and variances (m, k, outputs) of the linear cars of designs (m,) at ``x + around``.

        These are (m, n) and (k, n).
        """
        k, n = around.shape
        every = np.repeat(chosen, k)
        cars, state = self.straight((x[:, None] + around).reshape(-1, n), every)
        variances = covariance_variances(cars, self.space.some(every), self.road.select(every), self.designs)
        table = self.flat.layout().outputs
        rates, travels = (np.maximum(variances[:, table.of(name)], STILL) for name in ("sws_rate", "sws"))
        powers = [np.log(state.cs[i] * rates[:, i]) for i, *_ in self.damped]
        powers += [np.log(_weight(state.cs[i]) * travels[:, i]) for i, *_ in self.sprung]
        return np.stack(powers, axis=-1).reshape(-1, k, n), variances.reshape(len(chosen), k, -1)

    def shift(self, state: State) -> Array:
        """Mean deflection (N, corners) at every corner."""
        if self.sprung:
            return state.mean
        every = np.arange(self.N)
        return self._mean(self.flat.at_wheels("ks"), np.ones_like(state.mean), state.damping, every)

    def _mean(
        self, springs: tuple[Any, ...], sigma: Array, damping: list[Means | None], chosen: NDArray[np.int_]
    ) -> Array:
        """Where the mean forces of springs, dampers, bars and tyres balance, (N, corners)."""
        compliance = self.compliance[chosen] if self.compliance.ndim == 3 else self.compliance
        pump = np.stack([np.broadcast_to(x.force if x else 0.0, len(chosen)) for x in damping], axis=-1)
        first = [k[chosen] if isinstance(k, np.ndarray) else k for k in self.first_ks]
        return balanced(compliance, springs, first, sigma, pump, np.zeros_like(pump))

    def unbounded(self, design: int) -> ValueError:
        """What to say of a design whose powers are not finite."""
        return ValueError(
            f"{type(self.flat).__name__}{self.space.place(design)} has a curve along which the motion has no finite "
            "variance on this road; a damper on a rigid tyre needs a road of a waviness above 3 or a contact of some "
            "length"
        )

    def unsettled(self, design: int) -> ValueError:
        """What to say of a design that goes on moving."""
        return ValueError(
            f"{type(self.flat).__name__}{self.space.place(design)} has springs and dampers whose linearisation did not "
            f"settle in {ROUNDS} rounds; pass gentler curves or a smoother road"
        )

    @property
    def compliance(self) -> Array:
        """Deflection at every corner per force that pushes there, of the first linear cars."""
        if self._compliance is None:
            model = self.start.assemble()
            rows = model.R[..., model.suspensions, :]
            self._compliance = rows @ np.linalg.solve(model.K, rows.mT)
        return self._compliance


def _weight(cs: Any) -> Any:
    """By which a variance of deflection hardly changes any more: the damping rate, if there is any."""
    return np.where(cs > 0.0, cs, 1.0)


def _deviation(damper: Curve, power: Array, guess: Array) -> tuple[Array, Means]:
    """The deviation of a velocity that has the damper dissipate a power, ``E[f v] = power``, and the means there.

    Newton in logarithms.
    """
    log_sigma = np.log(guess)
    for _ in range(STEPS):
        sigma = np.exp(log_sigma)
        means = damper.means(sigma)
        step = (np.log(power / means.slope) - 2.0 * log_sigma) / (2.0 + sigma**2 * means.third / means.slope)
        if np.all(np.abs(step) < SETTLED):
            break
        log_sigma = log_sigma + np.clip(step, -2.0, 2.0)
    return sigma, means
