"""An obstacle that is held by a spring."""

from __future__ import annotations

import math
import numbers
from collections.abc import Mapping, Sequence, Set
from dataclasses import dataclass
from typing import Any

import numpy as np

from .results import FloatArray


@dataclass(frozen=True)
class Hand:
    """A spring that pushes an obstacle along an axis, as a robot under impedance control holds its
    finger.

    A controller gives it to ``view.steer``, and a loop of its own to ``advance``, in place of a pose.
    The hand has no mass. In each period it goes along the axis to where the force of the spring is
    the force that the load withstands at the end, and with inertia the mean force; a load that stands
    lets it stand. What touches nothing is at its target. Across the axis and in its heading it is
    stiff. There is one hand at an instant, and no other obstacle moves meanwhile.

    >>> import cohaul
    >>> sim = cohaul.Simulation("scenarios/contact/pusher.json", "quasi-static")
    >>> for tick in range(1, 501):
    ...     hand = cohaul.Hand((-0.0172 + 1e-4 * tick, 0.0), stiffness_n_per_m=1.0, force_limit_n=0.1)
    ...     status = sim.advance([], 0.001, pushers={0: hand})
    >>> bool(abs(hand.force_n(sim.obstacles[0]) - sim.scenario.slip_limit_n) < 1e-8)
    True

    :param target_m: where the spring pulls the origin of the obstacle (x, y in m, world); what of it
        lies across the axis has no effect
    :param axis: direction of the spring (world), of any length above 0
    :param stiffness_n_per_m: stiffness of the spring (N/m)
    :param force_limit_n: largest force of the spring (N)
    """

    target_m: tuple[float, float]
    axis: tuple[float, float] = (1.0, 0.0)
    stiffness_n_per_m: float = 100.0
    force_limit_n: float = math.inf

    def __post_init__(self) -> None:
        target, axis = _pair("target_m", self.target_m), _pair("axis", self.axis)
        length = math.hypot(*axis)
        if not 1e-100 < length < math.inf:
            raise ValueError(f"axis: must have a length above 0, found {self.axis!r}")
        for name, least in (("stiffness_n_per_m", "above 0 and finite"), ("force_limit_n", "at least 0")):
            value = _number(name, getattr(self, name))
            if not (value >= 0.0) or (name == "stiffness_n_per_m" and not 0.0 < value < math.inf):
                raise ValueError(f"{name}: must be {least}, found {value!r}")
            object.__setattr__(self, name, value)
        object.__setattr__(self, "target_m", target)
        object.__setattr__(self, "axis", (axis[0] / length, axis[1] / length))

    def force_n(self, pose: Sequence[float] | FloatArray) -> float:
        """Force of the spring along the axis, on an obstacle at this pose (N).

        At the end of a period it balances what the load withstands: the contact force there of a load
        that moves without inertia, and the mean contact force of the period with inertia. A load that
        stands may have any contact force up to it in the results.
        """
        if len(pose) < 2:
            raise ValueError(f"pose: must have x and y, found {pose!r}")
        ahead = sum(axis * (target - float(at)) for axis, target, at in zip(self.axis, self.target_m, pose))
        return ahead if math.isnan(ahead) else max(-self.force_limit_n, min(self.stiffness_n_per_m * ahead, self.force_limit_n))


def _number(name: str, value: Any) -> float:
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, numbers.Real):
        raise TypeError(f"{name}: must be a number, found {value!r}")
    try:
        return float(value)
    except OverflowError:
        raise ValueError(f"{name}: must be a number of double precision, found one beyond") from None


def _pair(name: str, value: Any) -> tuple[float, float]:
    is_list = hasattr(value, "__iter__") and not isinstance(value, (str, bytes, Mapping, Set))
    entries = list(value) if is_list else []
    if len(entries) != 2:
        raise TypeError(f"{name}: must be two numbers, found {value!r}")
    x, y = (_number(name, entry) for entry in entries)
    if not (math.isfinite(x) and math.isfinite(y)):
        raise ValueError(f"{name}: must be finite, found {value!r}")
    return x, y
