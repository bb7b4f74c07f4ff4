"""Scenes of the environments of `cohaul.gym`."""

from __future__ import annotations

from typing import Any

PAPER_LOAD: dict[str, Any] = {
    "name": "the paper's load on four springs",
    "duration_s": 30.0,
    "control_period_s": 0.05,
    "load": {"mass_kg": 0.0016, "radius_m": 0.0122},
    "ground": {"friction_coefficient": 1.4, "supports": {"tripod": {"radius_m": 0.0081333}}},
    "springs": [
        {
            "ring": {
                "n": 4,
                "radius_m": 0.0122,
                "rest_length_m": 0.0263,
                "radial_stiffness_n_per_m": 0.664,
                "torsional_stiffness_nm_per_rad": 4.52e-4,
            }
        }
    ],
    "drive": {"kind": "tips", "paths": []},
}
"""A ring on three feet, pulled by four springs."""


def _still(name: str, outline: dict[str, Any], x: float, y: float) -> dict[str, Any]:
    return {"name": name, "outline": outline, "position_m": [x, y], "friction_coefficient": 0.3}


def _disc(radius: float) -> dict[str, Any]:
    return {"disc": {"radius_m": radius}}


T_BLOCK: dict[str, Any] = {
    "name": "a T block that a disc pushes among posts",
    "duration_s": 40.0,
    "control_period_s": 0.1,
    "load": {
        "mass_kg": 0.3,
        # A bar of 120 x 30 mm on a stem of 30 x 90 mm, about the centroid.
        "outline": {
            "compound": {
                "parts": [
                    {"outline": {"rectangle": {"size_m": [0.12, 0.03]}}, "position_m": [0.0, 9.0 / 350.0]},
                    {"outline": {"rectangle": {"size_m": [0.03, 0.09]}}, "position_m": [0.0, -12.0 / 350.0]},
                ]
            }
        },
        "side_friction_coefficient": 0.3,
    },
    "ground": {"friction_coefficient": 0.4, "supports": {"uniform": {"n": 16}}},
    "springs": [],
    "obstacles": [
        _still("pusher", _disc(0.015), 0.0, 0.1),
        _still("left post", _disc(0.02), -0.25, 0.15),
        _still("right post", _disc(0.02), 0.25, -0.15),
    ],
    "drive": {"kind": "tips", "paths": []},
}
"""The block of many papers on pushing, with the pusher as obstacle 0."""

DOORWAY: dict[str, Any] = {
    "name": "a crate that two robots tow through a doorway",
    "duration_s": 40.0,
    "control_period_s": 0.1,
    "load": {"mass_kg": 2.0, "outline": {"rectangle": {"size_m": [0.4, 0.3]}}, "side_friction_coefficient": 0.3},
    "ground": {"friction_coefficient": 0.4, "supports": {"uniform": {"n": 16}}},
    "springs": [
        {
            "root_m": [0.2, y],
            "bearing_rad": 0.0,
            "rest_length_m": 0.12,
            "radial_stiffness_n_per_m": 300.0,
            "torsional_stiffness_nm_per_rad": 0.2,
            "damping_ratio": 0.1,
        }
        for y in (0.1, -0.1)
    ],
    "obstacles": [_still("left post", _disc(0.06), 0.9, 0.25), _still("right post", _disc(0.06), 0.9, -0.25)],
    "drive": {"kind": "tips", "paths": []},
}
"""Towing: the tips of two springs move."""
