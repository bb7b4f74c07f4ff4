"""Types of the answers: which keys they have, which words stand there, and what is a number.

All are dicts as the program prints them with ``--json``: these types exist for type checkers,
completion and documentation. Keys end in their units. A key that some answers lack is
``NotRequired``.

>>> from cohaul.results import QuantityVerdict
>>> def exceeds(verdict: QuantityVerdict) -> bool:
...     return verdict["inertia_effect"] > verdict["tolerance"]
>>> exceeds(cohaul.compare("scenarios/analytic/release-jump.json").verdicts["path"])
True
"""

# Annotations are evaluated here: which keys are required is known at run time, to tests too.

import sys
from typing import Any, Literal, Union

import numpy as np
import numpy.typing as npt

if sys.version_info >= (3, 11):
    from typing import NotRequired, TypedDict
else:
    from typing_extensions import NotRequired, TypedDict

FloatArray = npt.NDArray[np.float64]
"""An array of numbers in double precision."""
BackendName = Literal["quasi-static", "inertial", "rapier"]
"""Name of a backend."""
TierName = Literal["prescribed", "replayed", "controlled", "closed-loop", "closed_loop"]
"""Name of a tier of a comparison; ``closed-loop`` and ``closed_loop`` are the same."""
PathTier = Literal["prescribed", "replayed", "controlled"]
"""Tiers that compare paths."""
Status = Literal["converged", "not_converged", "failed"]
"""How steps ended: every one met its tolerance, some did not, or some had no finite answer."""
Health = Literal["ok", "doubtful", "failed"]
"""Whether the numbers of a run can be trusted."""
Integrator = Literal["midpoint", "euler"]
"""Method of the inertial backend at fixed steps."""
SkipName = Literal["free-load", "still-tips", "stick-certificate", "distant-ants"]
"""Work that a run skips because its outcome is known, unless ``no_skip`` names it."""
VerdictWord = Literal[
    "agree", "inertia", "engine", "inertia and engine", "inconclusive", "nothing moved", "decorrelated", "not computed"
]
"""Which difference exceeds its tolerance."""
InertiaAnswer = Literal["negligible", "not negligible", "open", "nothing moved"]
"""Whether the quasi-static model is valid."""
EngineAnswer = Literal["within", "not within", "open"]
"""Whether the engine error is within the tolerance."""
Cause = Literal["inertia", "impact", "not unique", "time step", "engine model", "engine"]
"""Cause of a difference that exceeds its tolerance."""
TriggerKind = Literal[
    "start", "grasp", "release", "slip_onset", "stop", "pinning", "unpinning", "jump", "contact", "driving"
]
"""What an inertia effect or a divergence is attributed to."""
Quantity = Literal["path", "heading", "pulls", "contacts", "speed", "energy", "measure"]
"""What a comparison of paths has a verdict on."""
Grade = Literal["exact", "to 1 %", "to 10 %", "beyond"]
"""How large a relative error is: at most 1e-9, 0.01, 0.1, or more."""


TraceColumn = Literal[
    "time_s", "x_m", "y_m", "heading_rad", "vx_m_per_s", "vy_m_per_s", "turn_rate_rad_per_s", "elastic_j", "kinetic_j", "friction_j",
    "tip_work_j", "dissipated_j", "defect_j", "interaction_n", "n_transporting", "tips_m", "pulls_n", "obstacles", "contact_forces_n",
]  # fmt: skip
"""Column of a :class:`cohaul.Trace`."""


class Format(TypedDict):
    """Name and version of a format. A key that changes changes the version."""

    name: str
    version: int


class RapierOptions(TypedDict, total=False):
    """Options of rapier; those that are left out have the defaults of ``cohaul run``."""

    friction: Literal["aligned", "polygon", "box"]
    springs: Literal["joint", "aggregate", "force"]
    precision: Literal["f64", "f32"]
    settings: Literal["recommended", "engine-defaults"]


class RapierUsed(TypedDict):
    """Options of rapier that were used."""

    friction: Literal["aligned", "polygon", "box"]
    springs: Literal["joint", "aggregate", "force"]
    precision: Literal["f64", "f32"]
    settings: Literal["recommended", "engine-defaults"]


class AccountFinding(TypedDict):
    """What a rule says of a run."""

    cause: Literal[
        "squeezed", "no_solution", "tolerance_missed", "bound_not_known", "not_solved", "engine_not_solved", "energy_gained",
        "ledger_open", "energy_lost", "steps_too_long", "unresolved_oscillation", "tip_near_root", "overlap", "not_unique", "lost_digits",
    ]  # fmt: skip
    health: Health
    found: float
    """The measure of the rule, in its unit."""
    since_s: NotRequired[float]
    """Time at which it was found first (s)."""


class Account(TypedDict):
    """Whether the numbers of a run can be trusted, and what was found."""

    health: Health
    defect_share: float
    """Energy from nowhere over the energy turned over (1); negative where it vanished."""
    step_error_m: NotRequired[float]
    """Estimated error of the pose by the length of the steps, at the edge of the load (m)."""
    findings: list[AccountFinding]


class Final(TypedDict):
    """The load at the end of a run, in world axes."""

    time_s: float
    position_m: list[float]
    """x and y (m)."""
    heading_rad: float
    velocity_m_per_s: list[float]
    """Along x and y (m/s)."""
    turn_rate_rad_per_s: float


class DefectParts(TypedDict):
    """What the defect of an energy ledger consists of (J)."""

    jumps_j: float
    numerical_damping_j: float
    quadrature_j: float


class Energy(TypedDict):
    """Energy ledger of a run (J). Keys of obstacles are there if the scene has some."""

    elastic_j: float
    kinetic_j: float
    dissipated_j: float
    friction_j: float
    side_friction_j: NotRequired[float]
    impact_j: NotRequired[float]
    damping_j: float
    released_j: float
    tip_work_j: float
    obstacle_work_j: NotRequired[float]
    initial_j: float
    defect_j: float
    """Stored and dissipated energy less the work of tips and obstacles and the initial energy."""
    defect_parts: DefectParts


class SimulationEnergy(TypedDict):
    """Energy ledger of a simulation so far (J)."""

    elastic_j: float
    kinetic_j: float
    dissipated_j: float
    tip_work_j: float
    defect_j: float


class TransitionCounts(TypedDict):
    """Number of instants at which the motion was not smooth, by kind."""

    n_slip_onset: int
    n_stop: int
    n_pinning: int
    n_unpinning: int
    n_jumps: int
    n_uncertain_jumps: NotRequired[int]
    largest_jump_m: NotRequired[float]


class ContactCounts(TypedDict):
    """Contacts with obstacles. Rapier counts only some of them."""

    n_touch: int
    n_separation: int
    n_side_stick: NotRequired[int]
    n_side_slip: NotRequired[int]
    n_impacts: int
    n_not_unique: NotRequired[int]
    n_impacts_by_poisson: NotRequired[int]
    n_impacts_without_law: NotRequired[int]
    residual: NotRequired[float]
    forces_unique: NotRequired[bool]


class SkippedInRun(TypedDict):
    """Number of steps, and of ants at ticks, that were skipped."""

    free_load: int
    still_tips: int
    stick_certificate: int
    distant_ants: int


class StepDoubts(TypedDict, total=False):
    """What makes steps doubtful."""

    overlap_m: float
    n_gate_cuts: int
    n_not_unique: int


class RunSteps(TypedDict):
    """Counts and worst status of the steps of a run."""

    residual: float | None
    lost_share: NotRequired[float]
    gained_share: NotRequired[float]
    unresolved_rad: NotRequired[float]
    doubts: NotRequired[StepDoubts]
    n_steps: int
    n_solves: int
    n_iterations: int
    n_skipped: int
    n_not_converged: int
    n_rejected: int
    share_skipped: float
    skipped: SkippedInRun
    status: Status


class StepTotals(TypedDict):
    """Counts and worst status of the steps behind a path or of a simulation."""

    status: Status
    residual: float
    n_steps: int
    n_solves: int
    n_iterations: int
    n_skipped: int
    n_not_converged: int
    n_rejected: int
    contact_residual: NotRequired[float]
    is_indeterminate: NotRequired[bool]
    unresolved_rad: NotRequired[float]
    work_error_j: NotRequired[float]
    swing_rad: NotRequired[float]
    lost_share: NotRequired[float]
    doubts: NotRequired[StepDoubts]
    gained_share: NotRequired[float]
    skipped: SkippedInRun


class PullForce(TypedDict):
    """Pulls of ants at their grasps and decisions (N)."""

    mean: float
    sd: float
    max: float
    n: int


class Accuracy(TypedDict):
    """Error that was asked for, and its bound."""

    asked_m: float
    asked_rad: float
    estimated_m: float
    estimated_rad: float
    is_met: bool


class Trigger(TypedDict):
    """Event or state of the load to which a difference is attributed."""

    kind: TriggerKind
    spring: NotRequired[int]
    support: NotRequired[int]
    obstacle: NotRequired[int]
    time_s: float


class ByTrigger(TypedDict):
    """Largest inertia effects by what they are attributed to (m)."""

    start_m: float
    jumps_m: float
    release_m: float
    grasp_m: float
    driving_m: float
    slip_onset_m: float
    contact_m: float


class LargestEffect(TypedDict):
    """When the estimated inertia effect is largest, and by what."""

    time_s: float
    trigger: Trigger


class InertiaEstimate(TypedDict):
    """Effect of inertia, estimated beside a quasi-static run."""

    edge_displacement_max_m: float
    edge_displacement_final_m: float
    largest: NotRequired[LargestEffect]
    by_trigger: ByTrigger
    path_length_m: float
    jump_share: NotRequired[float]
    share: float
    """Largest edge displacement over the path length (1)."""
    is_negligible: NotRequired[bool]
    """Whether it is within 1 % of the path; left out where that is not known."""
    is_invalid: NotRequired[bool]
    touches_obstacle: NotRequired[bool]


class RunResults(TypedDict):
    """What ``cohaul run --json`` prints."""

    format: Format
    answer: str
    scenario: str
    backend: BackendName
    step_s: float | None
    """Longest step (s); ``None`` under error control."""
    integrator: NotRequired[Integrator]
    rapier: NotRequired[RapierUsed]
    seed: int
    account: Account
    arrived: NotRequired[bool]
    """Whether the load reached the nest, or a controller has finished."""
    time_to_nest_s: NotRequired[float | None]
    final: Final
    mean_speed_m_per_s: float
    pull_force_n: NotRequired[PullForce]
    energy: Energy
    transitions: NotRequired[TransitionCounts]
    contacts: NotRequired[ContactCounts]
    accuracy: NotRequired[Accuracy]
    steps: RunSteps
    wall_s: float
    inertia_estimate: NotRequired[InertiaEstimate]


class Transition(TypedDict):
    """An instant at which the motion of the load is not smooth. Each kind has its own keys."""

    time: float
    """Time since the start of the run (s)."""
    transition: Literal[
        "slip_onset", "stop", "pinning", "unpinning", "touch", "separation", "side_stick", "side_slip", "impact", "not_unique", "squeeze",
        "jump",
    ]  # fmt: skip
    support: NotRequired[int]
    obstacle: NotRequired[int]
    energy: NotRequired[float]
    """Energy lost in an impact, or that would have set a load with inertia in motion (J)."""
    law: NotRequired[Literal["newton", "poisson", "none", "engine"]]
    shift: NotRequired[float]
    """Displacement in a jump (m)."""
    turn: NotRequired[float]
    """Turn in a jump (rad)."""
    is_uncertain: NotRequired[bool]


class Skips(TypedDict):
    """Whether each kind of work is skipped."""

    free_load: bool
    still_tips: bool
    stick_certificate: bool
    distant_ants: bool


class ComparisonSettings(TypedDict):
    """Settings of a comparison."""

    step_s: float | None
    halvings: int
    reference_tolerance_m: float | None
    rapier: RapierUsed
    recorded_from: BackendName
    rate_independent: NotRequired[bool]
    tolerance_share: float
    tolerance_heading_rad: float | None
    tolerance_pull_share: float
    tolerance_speed_share: float
    tolerance_energy_share: float
    skips: Skips
    check_suggestions: bool


class EngineName(TypedDict):
    """Name of an engine, and its version if it states one."""

    name: str
    version: NotRequired[str]


class Difference(TypedDict):
    """Difference of two paths: the largest, and that at the end."""

    position_max_m: float
    position_final_m: float
    heading_max_rad: float
    heading_final_rad: float
    edge_displacement_max_m: float


class DampingEffect(Difference):
    """Quasi-static minus its form without dashpots."""

    peak_net_pull_n: float
    peak_net_pull_without_n: float
    relaxation_s: float


class ReferenceError(Difference):
    """Bounds of the numerical errors of the paths."""

    quasi_static: Difference
    inertial: Difference
    engine: Difference


class Numbers(TypedDict):
    """Dimensionless numbers of a run (1); ``None`` where there is none."""

    epsilon: float | None
    phi: float | None
    zeta: float | None


class Predicted(TypedDict):
    """What theory predicts for the inertia effect; ``None`` where it predicts nothing."""

    while_driven_m: float | None
    where_tips_stop_m: float | None
    coasting_m: float | None
    estimated_m: float | None
    estimated_is_negligible: bool | None
    estimated_among_obstacles: bool
    release_factor: float | None


class Parts(TypedDict):
    """What the differences in one number consist of, in its unit."""

    inertia: float
    impact: float
    time_step: float
    engine_model: float
    limit_error: float
    dashpots: float


class Divergence(TypedDict):
    """First time at which runs differ by more than the tolerance, and what happened then."""

    time_s: float
    trigger: Trigger | None


class FirstDivergence(TypedDict):
    """First divergences; ``None`` where a difference stays below the tolerance."""

    inertia_effect: Divergence | None
    engine_error: Divergence | None


class OpenDifferences(TypedDict):
    """Differences that a doubt leaves open."""

    inertia_effect: bool
    engine_error: bool


class RunMeasure(TypedDict):
    """One number of a run on the two exact backends and the engine, in the unit of its verdict."""

    name: str
    spring: NotRequired[int]
    obstacle: NotRequired[int]
    quasi_static: float
    inertial: float
    engine: float
    inertia_effect: float
    engine_error: float
    reference_error: float
    tolerance: float
    parts: Parts
    undetermined: NotRequired[float]


class QuantityVerdict(TypedDict):
    """Verdict on one quantity: two answers, the word that follows from them, and the numbers."""

    verdict: VerdictWord
    inertia: InertiaAnswer
    engine: EngineAnswer
    causes: list[Cause]
    decided_by: NotRequired[str]
    """Name of the number whose differences these are; left out for path and heading."""
    inertia_effect: float
    """Inertial minus quasi-static, in the unit."""
    engine_error: float
    """Engine minus inertial, in the unit."""
    reference_error: float
    """Bound of the numerical error of quasi-static and inertial, in the unit."""
    tolerance: float
    """Largest difference that counts as agreement, in the unit."""
    unit: str
    parts: Parts
    first_divergence: FirstDivergence
    open: NotRequired[OpenDifferences]
    measures: NotRequired[list[RunMeasure]]


class Verdicts(TypedDict):
    """Verdict on each quantity of a comparison of paths."""

    path: QuantityVerdict
    heading: QuantityVerdict
    pulls: QuantityVerdict
    contacts: QuantityVerdict
    speed: QuantityVerdict
    energy: QuantityVerdict
    measure: NotRequired[QuantityVerdict]
    """That on a measure of your own."""


class Doubt(TypedDict):
    """A reason to doubt the exact runs."""

    kind: Literal["overlap", "gate_cut", "not_unique", "open_ledger", "not_converged", "same_stop"]
    backend: NotRequired[BackendName]
    time_s: float
    obstacle: NotRequired[int]


class SuggestedChange(TypedDict):
    """A change that makes a difference smaller. Each kind has its own number."""

    change: Literal[
        "smaller_step", "more_halvings", "other_model", "slower_tips", "slower_obstacles", "slower_start", "spring_damping",
        "tighter_tolerance",
    ]  # fmt: skip
    step_s: NotRequired[float]
    halvings: NotRequired[int]
    factor: NotRequired[float]
    damping_ratio: NotRequired[float]
    tolerance_m: NotRequired[float]


class Tried(TypedDict):
    """What is left of the inertia effect after all suggested changes."""

    inertia_effect_m: float
    tolerance_m: float
    is_enough: bool


class EdgeDisplacement(TypedDict):
    """Largest edge displacements between the paths; the ranges extend by the reference error."""

    inertia_effect_m: float
    inertia_effect_range_m: list[float]
    by_trigger: ByTrigger
    engine_error_m: float
    engine_error_range_m: list[float]
    reference_error_m: float


class BackendSteps(TypedDict):
    """Steps behind one path; ``step_s`` is left out under error control."""

    step_s: NotRequired[float]
    steps: StepTotals
    account: Account


class ComparedBackends(TypedDict):
    """Steps behind the three paths."""

    quasi_static: BackendSteps
    inertial: BackendSteps
    engine: BackendSteps


class Pathwise(TypedDict):
    """Comparison of the paths of a tier."""

    tier: PathTier
    engine: EngineName
    inertia_effect: Difference
    engine_error: Difference
    damping_effect: NotRequired[DampingEffect]
    time_step_error: Difference
    time_step_order: float | None
    model_error: Difference
    reference_error: ReferenceError
    numbers: Numbers
    predicted: Predicted
    verdict: VerdictWord
    """Verdict on the path."""
    verdicts: Verdicts
    doubts: NotRequired[list[Doubt]]
    largest_pull_over_slip_limit: float | None
    causes: list[Cause]
    suggested_changes: list[SuggestedChange]
    tried: NotRequired[Tried]
    edge_displacement: EdgeDisplacement
    tolerance_m: float
    path_length_m: float
    sampled_every_s: float
    first_divergence: FirstDivergence
    backends: ComparedBackends


class Interval(TypedDict):
    """A confidence interval."""

    low: float
    high: float


class Distribution(TypedDict):
    """Mean and spread over the ``n`` seeds in which a measure exists."""

    n: int
    mean: float
    sd: float
    mean_interval_95: Interval | None


class PairedDifference(TypedDict):
    """Paired differences of one measure between two backends."""

    n: int
    mean: float
    sd: float
    interval: Interval | None
    level: float
    excludes_zero: bool
    is_equal: bool
    tolerance: float
    n_needed: int | None


class EnsembleMeasure(TypedDict):
    """One measure over all seeds; its name ends in the unit."""

    name: str
    quasi_static: Distribution
    inertial: Distribution
    engine: Distribution
    inertia_effect: PairedDifference
    engine_error: PairedDifference


class MeasureVerdict(TypedDict):
    """Verdict on the means of one measure."""

    verdict: VerdictWord
    inertia: InertiaAnswer
    engine: EngineAnswer
    inertia_effect: float
    engine_error: float
    reference_error: float | None
    tolerance: float
    unit: str


class FirstDifferentDecision(TypedDict):
    """First time at which decisions differ from those of the inertial run (s)."""

    quasi_static_s: float | None
    engine_s: float | None


class SeedDoubt(Doubt):
    """First reason to doubt an exact run of one seed."""

    seed: int


class ClosedLoop(TypedDict):
    """Comparison of distributions over seeds."""

    tier: Literal["closed_loop"]
    engine_name: EngineName
    n_seeds: int
    first_seed: int
    measures: list[EnsembleMeasure]
    first_different_decision: FirstDifferentDecision
    verdict: VerdictWord
    inertia: InertiaAnswer
    engine: EngineAnswer
    verdicts: dict[str, MeasureVerdict]
    """By the name of the measure."""
    n_seeds_needed: int | None
    doubts: NotRequired[list[SeedDoubt]]
    status: Status


class Tiers(TypedDict, total=False):
    """Results by tier."""

    prescribed: Pathwise
    replayed: Pathwise
    controlled: Pathwise
    closed_loop: ClosedLoop


class Refusal(TypedDict):
    """An engine that does not take the scene, where others do."""

    engine: EngineName
    why: str


class BesideDifference(TypedDict):
    """Difference of a recorded path from that of a backend."""

    backend: str
    n: int
    position_max_m: float
    position_rms_m: float
    position_final_m: float
    heading_max_rad: float


class Beside(TypedDict):
    """A path recorded elsewhere, beside those of the first tier of paths."""

    file: str
    n: int
    differences: list[BesideDifference]


class ComparisonResults(TypedDict):
    """What ``cohaul compare --json`` prints."""

    format: Format
    answer: str
    scenario: str
    seed: int
    settings: ComparisonSettings
    tiers: Tiers
    other_engines: NotRequired[list[Pathwise]]
    refused_by: NotRequired[list[Refusal]]
    beside: NotRequired[Beside]
    wall_s: float


class Quartiles(TypedDict):
    """Median, quartiles and maximum over runs."""

    median: float
    lower_quartile: float
    upper_quartile: float
    max: float


class OverRuns(TypedDict):
    """Quantities over all measured runs with a result."""

    displacement_m: Quartiles
    model_error_m: Quartiles
    model_error_max_m: Quartiles
    model_error_position_m: Quartiles
    model_error_heading_rad: Quartiles
    model_error_force_n: Quartiles | None
    inertia_effect_m: Quartiles
    engine_error_m: Quartiles | None
    reference_error_m: Quartiles
    smoothing_m: Quartiles
    shift_m: Quartiles
    n_shifted: int


class OwnLimit(TypedDict):
    """Error of the measurement itself, as an edge displacement (m)."""

    edge_displacement_m: float
    source: Literal["uncertainty", "registration"]


class Mean(TypedDict):
    """Mean of a part of the model error over runs."""

    mean: float
    standard_deviation: float
    standard_error: float


class Bias(TypedDict):
    """Systematic part of the model error, along and across the measured displacement."""

    along_m: Mean
    across_m: Mean
    heading_rad: Mean


class MeasuredQuestion(TypedDict):
    """What was asked of every measured run."""

    start: Literal["touching", "recorded"]
    bound_m: float | None
    largest_shift_m: float
    longest_gap_s: float | None
    has_engine: bool


class Fitted(TypedDict):
    """A number that was fitted."""

    name: str
    before: float
    value: float
    interval_95: list[float] | None


class Fit(TypedDict):
    """Numbers that were fitted to runs, and how well."""

    numbers: list[Fitted]
    n_fit: int
    n_check: int
    on_fit_m: list[float]
    on_check_m: list[float] | None
    correlation: list[list[float]]
    joint_factor: float
    n_evaluations: int


class ModelError(TypedDict):
    """Measured minus inertial."""

    edge_displacement_m: float
    edge_displacement_max_m: float
    position_m: float
    along_m: float
    across_m: float
    heading_rad: float
    mean_force_n: float | None


class MeasuredFound(TypedDict):
    """What was found of a measured run."""

    model_error: ModelError
    displacement_m: float
    turn_rad: float
    inertia_effect_m: float
    engine_error_m: float | None
    reference_error_m: float
    smoothing_m: float
    bound_m: float
    deviation_m: float
    n_waypoints: int
    longest_gap_s: float
    shift_m: float
    end_gap_m: float | None
    is_sure: bool


class MeasuredRun(TypedDict):
    """A measured run: what was found, or why it was left out."""

    run: str
    found: MeasuredFound | None
    left_out: str | None


class MeasuredResults(TypedDict):
    """What ``cohaul measured --json`` prints."""

    format: Format
    scenario: str
    recording: list[str]
    answer: str
    question: MeasuredQuestion
    n_runs: int
    n_left_out: int
    n_doubtful: int
    over_runs: OverRuns | None
    own_limit: OwnLimit | None
    bias: Bias | None
    worst: list[str]
    fit: NotRequired[Fit]
    notes: list[str]
    wall_s: float
    runs: list[MeasuredRun]


class ConformanceCounts(TypedDict):
    """Number of tests by what came of them."""

    all: int
    exact: int
    to_1_percent: int
    to_10_percent: int
    beyond: int
    refused: int
    failed: int


class ConformanceMeasure(TypedDict):
    """A number that an engine gave, beside the known one."""

    name: str
    unit: str
    known: float
    found: float
    error: float
    relative_error: float
    grade: Grade
    accuracy: float


class ConformanceTest(TypedDict):
    """A test and its answer."""

    key: str
    name: str
    what: str
    source: str
    meaning: str
    outcome: Literal["answered", "refused", "failed"]
    grade: Grade | None
    why: str | None
    note: str | None
    measures: list[ConformanceMeasure]


class ConformanceResults(TypedDict):
    """What ``cohaul conformance --json`` prints."""

    format: Format
    answer: str
    line: str
    engine: EngineName
    step_s: float
    counts: ConformanceCounts
    tests: list[ConformanceTest]


class ImportPlace(TypedDict):
    """Where something was done: the track or shape, and the time (s)."""

    name: str
    time_s: NotRequired[float]


class ImportNote(TypedDict):
    """One kind of thing that an import did, how often, and how far."""

    kind: Literal[
        "read", "left-out", "not-seen", "low-confidence", "repeated", "units", "moved", "swaps", "jumps", "steps", "bridged", "releases",
        "releases-inferred", "grasps", "smoothed", "noise", "flattened", "holes", "joined",
    ]  # fmt: skip
    count: int
    text: str
    largest: NotRequired[float]
    limit: NotRequired[float]
    unit: NotRequired[str]
    is_warning: bool
    places: NotRequired[list[ImportPlace]]


class ImportAccount(TypedDict):
    """What ``cohaul scenario import --json`` prints."""

    format: Format
    files: list[str]
    source: str
    notes: list[ImportNote]


class Grid(TypedDict):
    """Evenly spaced values of a parameter."""

    first: float
    last: float
    n: int
    is_logarithmic: bool


AxisValues = list[Union[float, int, str]]
"""Values of a parameter one by one."""


class Axis(TypedDict):
    """A parameter and its values: a list or a grid."""

    path: str
    list: NotRequired["AxisValues"]
    grid: NotRequired[Grid]


class MapQuestion(TypedDict):
    """What was asked of every point of a map."""

    settings: ComparisonSettings
    everywhere: bool


class MapEstimate(TypedDict):
    """Inertia effect on the path, from a quasi-static run alone (m)."""

    inertia_effect_m: float
    tolerance_m: float


class MapVerdict(TypedDict):
    """Verdict on one quantity at a point of a map, in the unit of the quantity."""

    verdict: VerdictWord
    inertia: InertiaAnswer
    engine: EngineAnswer
    words: str
    is_valid: bool | None
    """Whether quasi-static is valid; ``None`` where that is open."""
    inertia_effect: float
    engine_error: float
    reference_error: float
    tolerance: float


class MapCell(TypedDict):
    """One point of a map."""

    values: AxisValues
    estimate: MapEstimate | None
    compared: list[MapVerdict] | None
    """Path, heading, pulls, contacts, speed and energy; ``None`` where the estimate decided."""
    failure: str | None


class MapResults(TypedDict):
    """What ``cohaul compare --vary --json`` prints."""

    format: Format
    answer: str
    scenario: str
    seed: int
    question: MapQuestion
    axes: list[Axis]
    n_compared: int
    n_by_estimate: int
    n_failed: int
    cells: list[MapCell]
    wall_s: float


BandClass = Literal["valid", "not_valid", "open", "nothing_moves", "failed"]
"""What is known of the quasi-static model in a range of a parameter."""


class ThresholdParameter(TypedDict):
    """The parameter of a search for thresholds, and the range of the search."""

    path: str
    range: list[float]
    speed_m_per_s: NotRequired[float]
    """Largest speed of what drives the load at the factor 1 (m/s)."""


class Bound(TypedDict):
    """End of a range: its value, and the values between which it lies."""

    value: float
    range: list[float]
    is_end: bool
    """Whether the search ends here, and not the answer."""


# `from` is a word of Python.
Band = TypedDict("Band", {"class": BandClass, "from": Bound, "to": Bound})
"""A range with one answer: ``class``, ``from`` and ``to``."""


class QuantityBands(TypedDict):
    """Ranges of one answer on a quantity."""

    quantity: Quantity
    bands: list[Band]


Effect = TypedDict("Effect", {"class": BandClass, "inertia_effect": float, "reference_error": float, "tolerance": float})
"""Inertia effect on one quantity at a point: ``class``, and numbers in the unit of the quantity."""


class ThresholdPoint(TypedDict):
    """The two exact models at one value of the parameter."""

    value: float
    effects: list[Effect | None]
    """Path, heading, pulls, contacts, speed and energy; ``None`` for what the scene does not have."""
    doubt: str | None
    failure: str | None


class ThresholdResults(TypedDict):
    """What ``cohaul compare --threshold --json`` prints."""

    format: Format
    answer: str
    scenario: str
    seed: int
    settings: ComparisonSettings
    parameter: ThresholdParameter
    quantities: list[QuantityBands]
    n_failed: int
    points: list[ThresholdPoint]
    wall_s: float


class BaselineOptions(TypedDict):
    """Options of the backend of a baseline."""

    kind: BackendName
    step_s: NotRequired[float]
    tolerance: NotRequired[dict[str, float]]
    integrator: Integrator
    rapier: RapierUsed
    skips: NotRequired[Skips]
    second_order: NotRequired[bool]
    adapts_step: NotRequired[bool]
    rate_independent: NotRequired[bool]


class BuildChange(TypedDict):
    """A change of a library, the program or the machine."""

    what: str
    stored: str | None
    now: str | None


class ScenarioChange(TypedDict):
    """A key of the expanded scenario whose value has changed."""

    path: str
    stored: Any
    now: Any


class BaselineEvent(TypedDict):
    """A grasp or a release."""

    time_s: float
    event: Literal["grasp", "release"]
    spring: int
    ant: int | None


class DifferentDecision(TypedDict):
    """First decision in which two runs differ."""

    time_s: float
    n_equal: int
    expected: BaselineEvent | None
    found: BaselineEvent | None


class BaselineDivergence(TypedDict):
    """First instant at which a tolerance is exceeded: numbers, or a decision."""

    time_s: float
    agreed_until_s: float | None
    measure: str
    expected: list[float] | BaselineEvent | None
    found: list[float] | BaselineEvent | None
    last_event: BaselineEvent | None


class Deviation(TypedDict):
    """Largest difference in one measure."""

    measure: str
    quantity: str
    difference: float
    tolerance: float
    time_s: float | None
    expected: list[float]
    found: list[float]


class ArrivalChange(TypedDict):
    """Change of whether the load reached the nest."""

    expected: bool | None
    found: bool | None


class StatusChange(TypedDict):
    """Change of the worst status of all steps."""

    expected: Status
    found: Status


class CheckedBaseline(TypedDict):
    """A baseline that was run again."""

    name: str
    verdict: Literal["agrees", "differs", "not computed"]
    is_exact: bool
    """Whether all numbers are equal to the last digit."""
    scenario: str
    scenario_sha256: str
    seed: int
    options: BaselineOptions
    build_changes: list[BuildChange]
    scenario_changes: list[ScenarioChange]
    first_divergence: BaselineDivergence | None
    first_different_decision: DifferentDecision | None
    deviations: list[Deviation]
    arrival_change: ArrivalChange | None
    status_change: StatusChange | None


class CheckResults(TypedDict):
    """What ``cohaul check --json`` prints."""

    format: Format
    n_agree: int
    n_differ: int
    n_not_computed: int
    exact: bool
    build: dict[str, str]
    accepted: list[str]
    wall_s: float
    baselines: list[CheckedBaseline]
