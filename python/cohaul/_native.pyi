from os import PathLike
from typing import Any, Callable, Literal, Mapping, Sequence

from typing_extensions import Self

from ._hand import Hand
from .results import FloatArray, Status

__version__: str

class Scene:
    name: str
    seed: int
    duration_s: float
    control_period_s: float
    n_springs: int
    drive: Literal["tips", "ants"]
    radius_m: float
    slip_limit_n: float
    @staticmethod
    def parse(text: str, file: str) -> Scene: ...
    def with_seed(self, seed: int | None) -> Scene: ...
    def expanded(self) -> str: ...
    def warnings(self) -> list[str]: ...
    def hash(self) -> str: ...

def shipped() -> list[tuple[str, str]]: ...

class Column:
    @property
    def __array_interface__(self) -> dict[str, Any]: ...

class TraceData:
    def __len__(self) -> int: ...
    @staticmethod
    def names() -> list[str]: ...
    def column(self, name: str) -> Column: ...
    def events(self) -> list[tuple[float, str, int, int | None, tuple[float, float]]]: ...
    def transitions(self) -> str: ...

class RunData:
    def json(self) -> str: ...
    def trace(self) -> TraceData: ...
    def page(self, command: str) -> str: ...
    def overview(self) -> str: ...

class Comparison:
    def json(self) -> str: ...
    def page(self, command: str) -> str: ...
    def write(self, folder: str | PathLike[str], command: str) -> None: ...
    def trace(self, tier: str, backend: str) -> TraceData: ...
    def overview(self, tier: str) -> str: ...

class Conformance:
    def json(self) -> str: ...
    def text(self, is_full: bool) -> str: ...
    def markdown(self) -> str: ...
    def page(self, command: str) -> str: ...
    def write(self, folder: str | PathLike[str], command: str) -> None: ...

class Import:
    scenario: str
    tracks: str | None
    tips: str | None
    def json(self) -> str: ...
    def text(self) -> str: ...

class MapData:
    def json(self) -> str: ...
    def text(self) -> str: ...
    def csv(self) -> str: ...
    def figure(self) -> str: ...
    def page(self, command: str) -> str: ...
    def write(self, folder: str | PathLike[str], command: str) -> None: ...

class ThresholdData:
    def json(self) -> str: ...
    def text(self) -> str: ...
    def csv(self) -> str: ...
    def figure(self) -> str: ...
    def page(self, command: str) -> str: ...
    def write(self, folder: str | PathLike[str], command: str) -> None: ...

class Check:
    def json(self) -> str: ...
    def text(self) -> str: ...
    def write(self, folder: str | PathLike[str], command: str) -> None: ...

class Measured:
    def json(self) -> str: ...
    def text(self, is_full: bool) -> str: ...
    def page(self, command: str) -> str: ...
    def write(self, folder: str | PathLike[str], command: str) -> None: ...

class SweepData:
    columns: list[tuple[str, str]]
    csv: str
    n_rows: int

class RolloutData:
    def column(self, name: str) -> Column: ...

class View:
    """What a controller sees of a run at the start of a control period, and its commands."""

    @property
    def time_s(self) -> float:
        """Time of the instant (s)."""
    @property
    def control_period_s(self) -> float:
        """Time until the tips are where the controller sends them (s)."""
    @property
    def n_springs(self) -> int:
        """Number of springs (1)."""
    @property
    def pose(self) -> tuple[float, float, float]:
        """Position (m, world) and heading (rad) of the load: (x, y, heading)."""
    @property
    def twist(self) -> tuple[float, float, float]:
        """Velocity (m/s, world) and turn rate (rad/s) of the load."""
    @property
    def attached(self) -> list[bool]:
        """Whether each spring is attached."""
    @property
    def tips(self) -> FloatArray:
        """Tip of each spring (m, world); NaN for a free one."""
    @property
    def pulls(self) -> FloatArray:
        """Pull on the tip of each spring (N, world); zero for a free one."""
    @property
    def obstacles(self) -> FloatArray:
        """x, y (m, world) and heading (rad) of each obstacle."""
    @property
    def contacts(self) -> list[tuple[int, tuple[float, float], tuple[float, float]]]:
        """Contacts in the last step: obstacle, point (m, world), force on the load (N, world)."""
    @property
    def contact_forces(self) -> FloatArray:
        """Force of each obstacle on the load in the last step (N, world)."""
    @property
    def friction_forces(self) -> FloatArray:
        """Friction force of the ground on each support in the last step (N, world)."""
    def steer(self, obstacle: int, pose: Sequence[float] | FloatArray | Hand) -> None:
        """Sends an obstacle straight to ``pose`` (x, y in m, heading in rad, world) by the end of the
        control period, or pushes it by the spring of a hand. It leaves the path of the scenario for
        good."""
    def attach(self, spring: int, tip: Sequence[float] | FloatArray) -> None:
        """Attaches a free spring with its tip at ``tip`` (m, world)."""
    def release(self, spring: int) -> None:
        """Releases an attached spring."""
    def finish(self) -> None:
        """Ends the run at the next tick: the load has arrived."""

class Stepper:
    def __new__(cls, scene: Scene, options: str) -> Self: ...
    def attach(self, spring: int, tip: Sequence[float] | FloatArray) -> None:
        """Attaches a free spring with its tip at ``tip`` (m, world)."""
    def release(self, spring: int) -> None:
        """Releases an attached spring, which relaxes at once."""
    def advance(
        self,
        tips: Sequence[Sequence[float]] | FloatArray,
        duration_s: float,
        pushers: Mapping[int, Sequence[float] | FloatArray | Hand] | None = None,
    ) -> Status:
        """Moves all tips straight to ``tips`` (m, world, one entry a spring), and the obstacles of
        ``pushers`` to their poses (x, y in m, heading in rad, world) or by the spring of a
        :class:`Hand`, within a time (s). Returns how the steps ended: ``converged``,
        ``not_converged`` or ``failed``. Ctrl-C ends a long one, and leaves all as it was before."""
    def save(self) -> str:
        """Complete state, from which :meth:`load` continues bit for bit."""
    def load(self, text: str) -> None:
        """Continues from a state that :meth:`save` returned."""
    @property
    def obstacles(self) -> FloatArray:
        """x, y (m, world) and heading (rad) of each obstacle."""
    @property
    def contacts(self) -> list[tuple[int, tuple[float, float], tuple[float, float]]]:
        """Contacts in the last step: obstacle, point (m, world), force on the load (N, world)."""
    @property
    def contact_forces(self) -> FloatArray:
        """Force of each obstacle on the load in the last step (N, world)."""
    @property
    def friction_forces(self) -> FloatArray:
        """Friction force of the ground on each support in the last step (N, world)."""
    def facts(self) -> str: ...
    def numbers(self) -> FloatArray: ...
    def set_numbers(self, path: str, bytes: bytes) -> None: ...
    @property
    def time_s(self) -> float:
        """Time so far (s)."""
    @property
    def pose(self) -> tuple[float, float, float]:
        """Position (m, world) and heading (rad) of the load: (x, y, heading)."""
    @property
    def twist(self) -> tuple[float, float, float]:
        """Velocity (m/s, world) and turn rate (rad/s) of the load."""
    @property
    def attached(self) -> list[bool]:
        """Whether each spring is attached."""
    @property
    def tips(self) -> FloatArray:
        """Tip of each spring (m, world); NaN for a free one."""
    @property
    def pulls(self) -> FloatArray:
        """Pull on the tip of each spring (N, world); zero for a free one."""

def run(
    scene: Scene,
    options: str,
    keep_trace: bool,
    controller: Callable[[View], Any] | None,
    progress: Callable[[float], Any] | None,
) -> RunData: ...
def compare(
    scene: Scene,
    settings: str,
    tiers: list[str],
    n_seeds: int | None,
    controller: Callable[[int], Callable[[View], Any]] | None,
    measure: dict[str, Any] | None,
    engines: list[Any],
    beside: tuple[str, str] | None,
    threads: int | None,
    progress: Callable[[float], Any] | None,
) -> Comparison: ...
def compare_map(
    scene: Scene,
    vary: str,
    settings: str,
    is_everywhere: bool,
    threads: int | None,
    progress: Callable[[float], Any] | None,
) -> MapData: ...
def threshold(
    scene: Scene, asked: str, settings: str, threads: int | None, progress: Callable[[float], Any] | None
) -> ThresholdData: ...
def check(
    folder: str,
    names: list[str] | None,
    scene: Scene | None,
    is_exact: bool,
    accepts: bool,
    threads: int | None,
    progress: Callable[[float], Any] | None,
) -> Check: ...
def store_baseline(
    scene: Scene,
    folder: str,
    name: str | None,
    stem: str,
    options: str,
    n_rows: int | None,
    replaces: bool,
    progress: Callable[[float], Any] | None,
) -> str: ...
def conformance(
    name: str,
    make: Callable[[], Any] | None,
    step_s: float,
    threads: int | None,
    progress: Callable[[float], Any] | None,
) -> Conformance: ...
def import_scenario(files: list[tuple[str, bytes]], like: tuple[str, bytes] | None, asked: str) -> Import: ...
def measured(
    scene: Scene,
    tables: list[tuple[str, str, str]],
    asked: str,
    threads: int | None,
    progress: Callable[[float], Any] | None,
) -> Measured: ...
def sweep(
    scene: Scene, asked: str, threads: int | None, progress: Callable[[float], Any] | None
) -> SweepData: ...
def rust_loop_s(
    scene: Scene,
    options: str,
    starts: Sequence[Sequence[float]],
    shift: tuple[float, float],
    duration_s: float,
    n: int,
) -> float: ...
def rollouts(
    scene: Scene,
    options: str,
    states: bytes,
    tips: bytes,
    steered: list[int],
    pushers: bytes,
    sizes: tuple[int, int],
    period_s: float,
    threads: int | None,
    progress: Callable[[float], Any] | None,
) -> RolloutData: ...
def seeded_rollouts(
    scene: Scene,
    options: str,
    seeds: list[int | None],
    n_periods: int,
    threads: int | None,
    progress: Callable[[float], Any] | None,
) -> RolloutData: ...
def rust_rollouts_s(
    scene: Scene,
    options: str,
    starts: Sequence[tuple[float, float]],
    shift: tuple[float, float],
    period_s: float,
    sizes: tuple[int, int],
    threads: int,
) -> float: ...
def rust_push(scene: Scene, options: str) -> list[tuple[float, float, float, float]]: ...
