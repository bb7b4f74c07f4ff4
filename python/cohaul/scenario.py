"""Types of the parts of a scenario, for type checkers, completion and documentation.

All are dicts in the format of scenarios. `python python/api.py` writes this file from the schema of
the format; the book's page on scenario keys has the rules and the defaults.

>>> from cohaul.scenario import Obstacle
>>> wall: Obstacle = {"name": "wall", "outline": {"polyline": {"points_m": [[0.1, -1.0], [0.1, 1.0]]}}}
"""

from __future__ import annotations

import sys
from typing import Literal, Sequence, Union

if sys.version_info >= (3, 11):
    from typing import NotRequired, TypedDict
else:
    from typing_extensions import NotRequired, TypedDict


class ScenarioKeys(TypedDict, total=False):
    """One run of collective transport. All units are SI units. Angles are in radians and
    counter-clockwise."""
    control_period_s: float
    """Control period, the time between two decisions of the ants and two rows of the trace (s).
    Every commanded velocity is constant within it."""
    drive: Drive
    """The motion of the tips: prescribed paths, or ants."""
    duration_s: float
    """Longest simulated time (s). A run with ants ends earlier when the load arrives at the
    nest."""
    format: int
    """Version of the scenario format (1). The default is 1, the first one. A newer version than the
    program reads is refused."""
    ground: Ground
    """The ground under the load."""
    load: Load
    """The load and its start."""
    name: str
    """Name of the run, in a few words."""
    obstacles: Sequence[Obstacle]
    """Bodies that the load can touch but not push away. The default is none."""
    seed: int
    """Seed of all random streams (1). The default is 1."""
    side_friction_rule: SideFrictionRule
    """Rule that combines the coefficients of side friction of the load and an obstacle. The default
    is "geometric-mean"."""
    springs: Sequence[Springs]
    """Springs of the load. A spring is named by its index, from 0. A group takes as many indices as
    it has springs."""


class Ants(TypedDict, total=False):
    """Ants that search for a tip, grasp it, pull and release it. The default of every key is that
    of the preset; the defaults stated here are those of the preset "paper", which has every value
    that the paper prints."""
    arrival_radius_m: float
    """Distance of the load's origin from the nest at which the load has arrived (m). The default is
    inferred: the paper says "small"."""
    avoidance: Avoidance
    """How ants avoid obstacles, and searching ants the load too. The default is "sidestep" in a
    scenario with obstacles and "none" in one without, inferred: the paper has no obstacles."""
    body_radius_m: float
    """Radius of the disc that an ant keeps clear about its position, that is, about its mandibles
    (m). It has no effect where ``avoidance`` is "none". The default is inferred: half the width of
    an ant."""
    control_offset_m: float
    """Distance from the mandibles of a searching ant to the point about which it turns (m). A
    pulling ant turns about its mandibles. The default is printed in the paper."""
    grasp_decision_period_s: float
    """Time between two grasp decisions (s). The default is inferred: the printed group sizes need
    grasps that are much faster than releases."""
    grasp_pace: GraspPace
    """Times at which an ant decides to grasp. The default, "hazard", is inferred: the paper does
    not print its time step."""
    grasp_probability: float
    """Probability of grasping a free tip in reach, per decision period (1). The default is printed
    in the paper."""
    kind: Literal["ants"]
    """Kind of the drive: "ants"."""
    look_ahead_m: float
    """Distance to an obstacle at which a searching ant begins to turn aside (m). It has no effect
    where ``avoidance`` is "none". The default is inferred: three lengths of an ant."""
    n_ants: int
    """Number of ants (1)."""
    nest_position_m: Sequence[float]
    """Position of the nest, to which the ants pull the load (m, world axes). The default is printed
    in the paper, with the start of the load as the origin."""
    preset: Preset
    """Named set of parameters for all keys that are left out. The default is "paper"."""
    pull_speed_m_per_s: float
    """Walking speed of a pulling ant (m/s). The default is inferred: with it the printed forces and
    group sizes are met best."""
    release_decision_period_s: float
    """Time between two release decisions (s). The default is inferred: with it the printed forces
    and group sizes are met best."""
    release_pace: ReleasePace
    """Times at which an ant decides to release. The default, "hazard", is inferred: the paper does
    not print its time step."""
    release_steepness_per_n: float
    """Steepness of the release probability over the pull (1/N). The default is printed in the paper
    without a unit."""
    search_speed_m_per_s: float
    """Walking speed of a searching ant (m/s). The default is printed in the paper."""
    sensing_range_m: float
    """Distance within which a searching ant senses the tip of a free spring (m). The default is
    inferred: the paper does not print it."""
    start_half_width_m: float
    """Half width of the square about the load in which the ants start, uniformly distributed (m).
    The default is inferred: the paper prints no size."""
    steering_gain_per_s: float
    """Turn rate of an ant over its heading error (1/s). The default is printed in the paper."""
    steering_half_angle_rad: float
    """Largest angle between the pull of an ant and the direction of its spring (rad). The default,
    60 degrees, is printed in the paper."""
    strong_pull_n: float
    """Force close to the largest that an ant can apply (N). The release probability is 1/2 at half
    of it. The default is printed in the paper."""
    target_redraw_period_s: float
    """Time between two draws of that position (s). The default is inferred: the paper draws at each
    time step, and does not print the step."""
    target_variance_m2: float
    """Variance, on each axis, of the position at which an ant believes the load to be (m^2). The
    default is printed in the paper without a unit."""


class Compound(TypedDict):
    """The union of several outlines."""
    parts: Sequence[Part]
    """Parts. Those of a load must not overlap, since its mass would count twice there."""


class Disc(TypedDict):
    """A disc about the origin."""
    radius_m: float
    """Radius (m)."""


class Ground(TypedDict, total=False):
    """Level ground with Coulomb friction under the load."""
    friction_coefficient: float
    """Coulomb's coefficient of friction of all supports without one of their own, the same for
    sticking and slipping (1)."""
    gravity_m_per_s2: float
    """Gravity, from which normal loads follow that are left out (m/s^2). It has no other effect.
    The default is 9.81."""
    supports: Supports
    """Points at which the load stands on the ground: a list, or a short form for points at equal
    angles or under a uniform pressure."""


class Load(TypedDict, total=False):
    """The load, a rigid body in the plane. The origin of its frame is its centre of mass."""
    density_kg_per_m2: float
    """Mass per area of the outline (kg/m^2), in place of ``mass_kg``."""
    heading_rad: float
    """Heading at the start (rad). The default is 0."""
    inertia_kg_m2: float
    """Moment of inertia about the centre of mass (kg m^2). The default is that of a mass spread
    uniformly over the outline, m R^2 / 2 for a disc. The centroid of the outline must then be the
    origin."""
    mass_kg: float
    """Mass (kg). Either this or ``density_kg_per_m2`` is given."""
    outline: Outline
    """Outline in the load's frame, which obstacles touch. Either this or ``radius_m`` is given. Its
    centroid must be the origin unless mass, inertia and supports say where the mass is."""
    position_m: Sequence[float]
    """Position of the origin at the start (m, world axes). The default is [0, 0]."""
    radius_m: float
    """Radius of a disc about the origin (m), the short form of such an ``outline``."""
    restitution: float
    """Coefficient of restitution of the load, from 0 for plastic impacts to 1 for elastic ones (1).
    Impacts have the larger one of this and that of the obstacle. The default is 0."""
    side_friction_coefficient: float
    """Coulomb's coefficient of side friction of the load's edge (1). ``side_friction_rule``
    combines it with that of an obstacle. The default is 0."""
    turn_rate_rad_per_s: float
    """Turn rate at the start (rad/s). The default is 0."""
    velocity_m_per_s: Sequence[float]
    """Velocity of the origin at the start (m/s, world axes). The default is [0, 0]."""


class Obstacle(TypedDict, total=False):
    """A body that the load touches but cannot push away. It stands still, or moves along a given
    path as a position-controlled pusher does. The ground has no effect on it."""
    friction_coefficient: float
    """Coulomb's coefficient of side friction of the obstacle's edge (1). ``side_friction_rule``
    combines it with that of the load. The default is 0."""
    heading_rad: float
    """Heading of the obstacle (rad). It excludes ``path``. The default is 0."""
    name: str
    """Name in reports. No other obstacle has the same."""
    outline: Outline
    """Outline in the obstacle's frame."""
    path: ObstaclePath
    """Motion of a pusher. The default is an obstacle that stands still."""
    position_m: Sequence[float]
    """Position of the obstacle's origin (m, world axes). It excludes ``path``. The default is [0,
    0]."""
    restitution: float
    """Coefficient of restitution of the obstacle, from 0 for plastic impacts to 1 for elastic ones
    (1). Impacts have the larger one of this and that of the load. The default is 0."""


class ObstaclePath(TypedDict):
    """Motion of an obstacle."""
    waypoints: Sequence[Sequence[float]]
    """Waypoints [time (s), x (m), y (m), heading (rad)] of the obstacle's frame in world axes.
    Between two of them position and heading change at constant rates. The obstacle stands still
    before the first and after the last one. Within one control period no point of the obstacle may
    move farther than the load is wide, since it would pass through the load."""


class Outline(TypedDict):
    """Shape in the plane, in the frame of its body. It has exactly one of these keys."""
    compound: NotRequired[Compound]
    """The union of several outlines."""
    disc: NotRequired[Disc]
    """A disc about the origin."""
    polygon: NotRequired[Polygon]
    """A polygon that does not cross itself, convex or not."""
    polyline: NotRequired[Polyline]
    """An open chain of straight walls without thickness, for obstacles only. Both sides of a wall
    can be touched."""
    rectangle: NotRequired[Rectangle]
    """A rectangle about the origin, with its sides along the axes."""


class Part(TypedDict):
    """Part of a compound outline."""
    heading_rad: NotRequired[float]
    """Heading of the part in the frame of the body (rad). The default is 0."""
    outline: Outline
    """Outline in the frame of the part."""
    position_m: NotRequired[Sequence[float]]
    """Position of the part's origin in the frame of the body (m). The default is [0, 0]."""


class Path(TypedDict):
    """The path of one tip."""
    release_s: NotRequired[float]
    """Time at which the spring is released (s). The default is never."""
    spring: int
    """Index of the spring, from 0 (1)."""
    waypoints: Sequence[Sequence[float]]
    """Waypoints [time (s), x (m), y (m)] in world axes. The spring is attached at the time of the
    first one. The tip moves in straight lines at constant speed between waypoints, and stays at the
    last one."""


class Polygon(TypedDict):
    """A polygon that does not cross itself, convex or not."""
    points_m: Sequence[Sequence[float]]
    """Corners in the frame of the body (m), one after another along the edge, in either direction.
    The last one is joined to the first."""


class Polyline(TypedDict):
    """An open chain of straight walls without thickness."""
    points_m: Sequence[Sequence[float]]
    """Ends of the walls in the frame of the body (m), one after another."""


class Rectangle(TypedDict):
    """A rectangle about the origin, with its sides along the axes."""
    size_m: Sequence[float]
    """Lengths of the sides along the x and the y axis (m)."""


class RingOfSprings(TypedDict):
    """Equal springs at equal angles about the centre of mass. Each points outwards."""
    damping_ratio: NotRequired[float]
    """Damping over the critical damping of the load's mass on one spring (1). The default is 0: no
    damping."""
    first_bearing_rad: NotRequired[float]
    """Direction of the first spring in the load's frame (rad). The default is 0: along the x
    axis."""
    law: NotRequired[SpringLaw]
    """Law of the springs. The default is "polar"."""
    n: int
    """Number of springs (1)."""
    radial_stiffness_n_per_m: float
    """Stiffness against a change of length (N/m)."""
    radius_m: float
    """Distance of the roots from the centre of mass (m)."""
    rest_length_m: float
    """Length of the spring without force (m)."""
    torsional_stiffness_nm_per_rad: float
    """Stiffness against a swing about the root (N m/rad)."""


class RingOfSpringsForm(TypedDict):
    """Short form for equal springs on a circle."""
    ring: RingOfSprings
    """The springs on the circle."""


class RingOfSupports(TypedDict):
    """Supports at equal angles about the centre of mass, all with the same normal load."""
    first_bearing_rad: NotRequired[float]
    """Direction of the first support in the load's frame (rad). The default is 0: the first support
    is on the x axis."""
    n: int
    """Number of supports (1)."""
    normal_load_n: NotRequired[float]
    """Normal load of each support (N). It may be left out for three supports: each then carries a
    third of the weight."""
    radius_m: float
    """Distance of the supports from the centre of mass (m)."""


class RingOfSupportsForm(TypedDict):
    """Short form for equal supports on a circle."""
    ring: RingOfSupports
    """The supports on the circle."""


class Spring(TypedDict, total=False):
    """One spring, or a rope. A spring without rest length and torsional stiffness is isotropic: its
    force is linear in the position of its tip."""
    bearing_rad: float
    """Direction of the undeformed spring in the load's frame (rad)."""
    damping_ratio: float
    """Damping over the critical damping of the load's mass on this spring (1). The default is 0: no
    damping."""
    law: SpringLaw
    """Law of the spring. The default is "polar"."""
    radial_stiffness_n_per_m: float
    """Stiffness against a change of length (N/m)."""
    rest_length_m: float
    """Length of the spring without force (m)."""
    root_m: Sequence[float]
    """Position of the root in the load's frame (m)."""
    torsional_stiffness_nm_per_rad: float
    """Stiffness against a swing about the root (N m/rad)."""


class Support(TypedDict):
    """One point at which the load stands on the ground."""
    friction_coefficient: NotRequired[float]
    """Coulomb's coefficient of friction of this support (1), as of a foot of another material. The
    default is that of the ground."""
    normal_load_n: NotRequired[float]
    """Normal load (N). It may be left out for all of exactly three supports: it then follows from
    the weight and the centre of mass."""
    offset_m: Sequence[float]
    """Position in the load's frame (m)."""


class Tips(TypedDict):
    """Prescribed paths of the tips."""
    kind: Literal["tips"]
    """Kind of the drive: "tips"."""
    paths: Sequence[Path]
    """Paths of the tips. A spring may have several, one after another: each but the last one is
    released before the next one begins, or at that instant. A spring without a path stays free."""


class Tripod(TypedDict):
    """Three supports at equal angles about the centre of mass, each with a third of the weight."""
    first_bearing_rad: NotRequired[float]
    """Direction of the first support in the load's frame (rad). The default is a quarter turn: the
    first support is on the y axis."""
    radius_m: float
    """Distance of the supports from the centre of mass (m)."""


class TripodForm(TypedDict):
    """Short form for three equal supports."""
    tripod: Tripod
    """The three supports."""


class UniformSupports(TypedDict):
    """Supports that stand for a uniform pressure on the whole outline. They carry the weight, with
    its centre below the centre of mass. The centroid of the outline must be the origin."""
    n: NotRequired[int]
    """Number of supports, at least 3 (1). The program takes a number near it that fills the outline
    evenly. The error of friction is about 1.5 / n of the weight's at worst. Either this or
    ``tolerance`` is given."""
    tolerance: NotRequired[float]
    """Largest error of friction force or torque, over that of the whole weight (1). The number of
    supports follows from it, and is 2 / ``tolerance``."""


class UniformSupportsForm(TypedDict):
    """Short form for a weight that is spread over the outline."""
    uniform: UniformSupports
    """The weight, spread uniformly over the outline."""


Avoidance = Literal["none", "sidestep", "turn"]
"""How walkers avoid obstacles and the load."""

Drive = Union[Tips, Ants]
"""The motion of the tips: prescribed paths, or ants."""

GraspPace = Literal["hazard", "per-tick"]
"""Times at which an ant decides to grasp."""

Preset = Literal["paper", "fitted", "paper-speed", "aged", "literal-newtons", "literal-millinewtons"]
"""Named set of the ants' parameters.  Section VII of the paper prints eight of them. The preset
"paper", which is the default, has all eight. The others say which they replace, and why."""

ReleasePace = Literal["aged", "hazard", "per-tick"]
"""Times at which an ant decides to release."""

SideFrictionRule = Literal["geometric-mean", "average", "min", "multiply", "max"]
"""Combination of the coefficients of side friction of the load and an obstacle."""

SpringLaw = Literal["polar", "rope"]
"""Law of a spring."""

Springs = Union[RingOfSpringsForm, Spring]
"""A spring, or a group of equal springs."""

Supports = Union[TripodForm, RingOfSupportsForm, UniformSupportsForm, Sequence[Support]]
"""Points at which the load stands on the ground."""
