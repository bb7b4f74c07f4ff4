"""Parts of a scenario from keywords. Each function returns a dict of the scenario format.

Keywords are the keys of the format, as the types of :mod:`cohaul.scenario` have them. Those that
are not given are left out, so that the format's defaults hold; :class:`Scenario` names what misses.
"""

from __future__ import annotations

import sys
from typing import Any, Mapping, Sequence

from .scenario import Ants, Ground, Load, Obstacle, Path, Spring, Tips

if sys.version_info >= (3, 11):
    from typing import Unpack
else:
    from typing_extensions import Unpack

Point = Sequence[float]


def _given(keys: Mapping[str, Any]) -> Any:
    return {name: value for name, value in keys.items() if value is not None}


def load(**keys: Unpack[Load]) -> Load:
    """A load of some ``mass_kg``: a disc of some ``radius_m``, or any ``outline``.

    Other keywords: ``inertia_kg_m2``, ``position_m``, ``heading_rad``, ``velocity_m_per_s``,
    ``turn_rate_rad_per_s``, ``side_friction_coefficient``, ``restitution``, ``density_kg_per_m2``.

    >>> load(mass_kg=0.0016, radius_m=0.0122)
    {'mass_kg': 0.0016, 'radius_m': 0.0122}
    """
    found: Load = _given(keys)
    return found


def ground(*, tripod_radius_m: float | None = None, uniform_n: int | None = None, **keys: Unpack[Ground]) -> Ground:
    """The ground: its ``friction_coefficient`` (1), and the supports of the load.

    Supports are three on a circle of ``tripod_radius_m`` (m), ``uniform_n`` points spread over
    the outline, or any ``supports`` of the format.

    >>> ground(friction_coefficient=0.3, uniform_n=16)
    {'friction_coefficient': 0.3, 'supports': {'uniform': {'n': 16}}}
    """
    found: Ground = _given(keys)
    if tripod_radius_m is not None:
        found["supports"] = {"tripod": {"radius_m": tripod_radius_m}}
    elif uniform_n is not None:
        found["supports"] = {"uniform": {"n": uniform_n}}
    return found


def spring(**keys: Unpack[Spring]) -> Spring:
    """A spring at ``root_m`` (m, load frame), undeformed in the direction ``bearing_rad`` (rad).

    Bearing, rest length (m) and torsional stiffness (N m/rad) are zero by default. Without the last
    two it is isotropic. Other keywords: ``radial_stiffness_n_per_m``, which must be given,
    ``damping_ratio``, and ``law="rope"`` for a spring that pulls only.

    >>> spring(root_m=(0.0, 0.0), radial_stiffness_n_per_m=2.0)["rest_length_m"]
    0.0
    """
    at_zero: Spring = {"bearing_rad": 0.0, "rest_length_m": 0.0, "torsional_stiffness_nm_per_rad": 0.0}
    found: Spring = _given({**at_zero, **keys})
    return found


def obstacle(**keys: Unpack[Obstacle]) -> Obstacle:
    """A body of a ``name`` and an ``outline`` that the load can touch but not push away. It stands,
    or moves along a ``path``.

    >>> obstacle(name="post", outline={"disc": {"radius_m": 0.01}}, position_m=(0.1, 0.0))["name"]
    'post'
    """
    found: Obstacle = _given(keys)
    return found


def path(spring: int, waypoints: Sequence[Point], *, release_s: float | None = None) -> Path:
    """A path of one tip through ``waypoints``: time (s), x (m) and y (m, world) of each.

    The spring is attached at the time of the first one and released at ``release_s`` (s).
    """
    found: Path = _given({"spring": spring, "waypoints": [list(point) for point in waypoints], "release_s": release_s})
    return found


def tips(*paths: Path) -> Tips:
    """A drive by given paths of the tips.

    >>> tips(path(0, [(0.0, 0.04, 0.0), (1.0, 0.1, 0.0)]))["kind"]
    'tips'
    """
    return {"kind": "tips", "paths": list(paths)}


def ants(n_ants: int | None = None, /, **keys: Unpack[Ants]) -> Ants:
    """A drive by ants. Other keywords: ``nest_position_m``, ``preset``, ``pull_speed_m_per_s`` ...

    >>> ants(4, nest_position_m=(0.2, -0.17))
    {'kind': 'ants', 'n_ants': 4, 'nest_position_m': (0.2, -0.17)}
    """
    if n_ants is not None and "n_ants" in keys:
        raise TypeError(f"n_ants: must be given once, found {n_ants!r} and {keys['n_ants']!r}")
    found: Ants = _given({"kind": "ants", "n_ants": n_ants, **keys})
    return found
