"""Parts of a scenario from keywords. Each function returns a dict of the scenario format.

Keys that are not given are left out, so that the format's defaults hold. The book's page on
scenario keys describes each of them.
"""

from __future__ import annotations

from typing import Any, Sequence

Point = Sequence[float]


def _given(keys: dict[str, Any], more: dict[str, Any]) -> dict[str, Any]:
    return {name: value for name, value in {**keys, **more}.items() if value is not None}


def load(*, mass_kg: float, radius_m: float | None = None, **keys: Any) -> dict[str, Any]:
    """A load of this mass (kg): a disc of this radius (m), or any ``outline``.

    Other keys: ``outline``, ``inertia_kg_m2``, ``position_m``, ``heading_rad``,
    ``velocity_m_per_s``, ``turn_rate_rad_per_s``, ``side_friction_coefficient`` ...

    >>> load(mass_kg=0.0016, radius_m=0.0122)
    {'mass_kg': 0.0016, 'radius_m': 0.0122}
    """
    return _given({"mass_kg": mass_kg, "radius_m": radius_m}, keys)


def ground(
    *,
    friction_coefficient: float,
    tripod_radius_m: float | None = None,
    uniform_n: int | None = None,
    supports: Any = None,
    gravity_m_per_s2: float | None = None,
    **keys: Any,
) -> dict[str, Any]:
    """The ground: its friction coefficient (1), and the supports of the load.

    Supports are three on a circle of ``tripod_radius_m`` (m), ``uniform_n`` points spread over
    the outline, or any ``supports`` of the format.

    >>> ground(friction_coefficient=0.3, uniform_n=16)
    {'friction_coefficient': 0.3, 'supports': {'uniform': {'n': 16}}}
    """
    if tripod_radius_m is not None:
        supports = {"tripod": {"radius_m": tripod_radius_m}}
    elif uniform_n is not None:
        supports = {"uniform": {"n": uniform_n}}
    first = {"friction_coefficient": friction_coefficient, "gravity_m_per_s2": gravity_m_per_s2}
    return _given({**first, "supports": supports}, keys)


def spring(
    *,
    root_m: Point,
    radial_stiffness_n_per_m: float,
    bearing_rad: float = 0.0,
    rest_length_m: float = 0.0,
    torsional_stiffness_nm_per_rad: float = 0.0,
    damping_ratio: float | None = None,
    **keys: Any,
) -> dict[str, Any]:
    """A spring at ``root_m`` (m, load frame), undeformed in the direction ``bearing_rad`` (rad).

    Without rest length (m) and torsional stiffness (N m/rad) it is isotropic.
    """
    return _given(
        {
            "root_m": list(root_m),
            "bearing_rad": bearing_rad,
            "rest_length_m": rest_length_m,
            "radial_stiffness_n_per_m": radial_stiffness_n_per_m,
            "torsional_stiffness_nm_per_rad": torsional_stiffness_nm_per_rad,
            "damping_ratio": damping_ratio,
        },
        keys,
    )


def path(spring: int, waypoints: Sequence[Point], *, release_s: float | None = None, **keys: Any) -> dict[str, Any]:
    """A path of one tip through ``waypoints``: time (s), x (m) and y (m, world) of each.

    The spring is attached at the time of the first one and released at ``release_s`` (s).
    """
    return _given({"spring": spring, "waypoints": [list(point) for point in waypoints], "release_s": release_s}, keys)


def tips(*paths: dict[str, Any]) -> dict[str, Any]:
    """A drive by given paths of the tips.

    >>> tips(path(0, [(0.0, 0.04, 0.0), (1.0, 0.1, 0.0)]))["kind"]
    'tips'
    """
    return {"kind": "tips", "paths": list(paths)}


def ants(n_ants: int, **keys: Any) -> dict[str, Any]:
    """A drive by ants. Other keys: ``nest_position_m``, ``preset``, ``pull_speed_m_per_s`` ...

    >>> ants(4, nest_position_m=(0.2, -0.17))
    {'kind': 'ants', 'n_ants': 4, 'nest_position_m': (0.2, -0.17)}
    """
    return _given({"kind": "ants", "n_ants": n_ants}, keys)
