//! The regime map for programs, for people and as files.

use serde::Serialize;

use crate::studies::regime::theory::SOUND;
use crate::studies::regime::{AGREEMENT, Cell, Grid, Law, Scene, Standing};

/// What `regime --json` prints.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Regime {
    /// The laws that are exact hold in every cell that resolves them.
    pub holds: bool,
    pub quick: bool,
    /// Share of the way up to which paths count as the same (1).
    pub agreement: f64,
    pub n_cells: usize,
    pub wall_s: f64,
    pub maps: Vec<MapLine>,
    pub laws: Vec<Standing>,
    pub rule: Vec<RuleLine>,
    /// Where the paper's ants work.
    pub paper: Vec<CellLine>,
    #[serde(skip)]
    pub grids: Vec<Grid>,
    /// Of the maps, in the order of the grids.
    #[serde(skip)]
    pub cells: Vec<Cell>,
}

/// One panel in numbers.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MapLine {
    pub scene: Scene,
    pub zeta: f64,
    pub n_cells: usize,
    /// The load without inertia goes somewhere.
    pub n_moving: usize,
    /// Paths stay together within the agreement.
    pub n_agree: usize,
    /// The distance is lost in the paths' own errors.
    pub n_unresolved: usize,
    pub n_not_converged: usize,
    /// Largest own error over the way of all cells that move (1).
    pub own_error_max_share: f64,
}

/// The rule of thumb that inertia may be neglected where epsilon <= 0.05, Phi >= 2 pi and zeta >=
/// 0.5, against the measurement.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RuleLine {
    pub scene: Scene,
    pub n_sound_and_agree: usize,
    pub n_sound_but_apart: usize,
    pub n_unsound_but_agree: usize,
    pub n_unsound_and_apart: usize,
}

/// A row of `regime.csv`; empty fields where there is no number.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CellLine {
    pub scene: Scene,
    pub zeta: f64,
    pub phi: f64,
    pub epsilon: f64,
    pub share: Option<f64>,
    pub own_error_share: Option<f64>,
    pub displacement_ratio: Option<f64>,
    pub predicted_share: Option<f64>,
    pub predicted_displacement_ratio: Option<f64>,
    pub way_m: f64,
    pub distance_m: f64,
    pub own_error_m: f64,
    pub turn_share: f64,
    pub jump_m: f64,
    pub shift_quasi_static_m: f64,
    pub shift_inertial_m: f64,
    pub end_speed_m_per_s: f64,
    pub is_resolved: bool,
    pub is_converged: bool,
}

/// Where the rule of thumb takes a load without inertia for sound.
pub fn is_sound_by_rule(cell: &Cell) -> bool {
    cell.epsilon <= SOUND.0 && cell.phi >= SOUND.1 && cell.zeta >= SOUND.2
}

impl Regime {
    /// Of the `cells` of `grids` and those at the paper's points, in their order.
    pub fn new(grids: &[Grid], cells: Vec<Cell>, paper: &[Cell], quick: bool, wall_s: f64) -> Self {
        let laws = Standing::all(&cells);
        let is_exact = |standing: &&Standing| matches!(standing.law, Law::Excursion | Law::ReleaseInFull);
        Self {
            holds: laws.iter().filter(is_exact).all(|standing| standing.n_within == standing.n_cells),
            quick,
            agreement: AGREEMENT,
            n_cells: cells.len(),
            wall_s,
            maps: grids.iter().flat_map(|grid| grid.zetas.iter().map(|zeta| MapLine::of(grid.scene, *zeta, &cells))).collect(),
            laws,
            rule: grids.iter().map(|grid| RuleLine::of(grid.scene, &cells)).collect(),
            paper: paper.iter().map(CellLine::of).collect(),
            grids: grids.to_vec(),
            cells,
        }
    }
}

impl MapLine {
    fn of(scene: Scene, zeta: f64, cells: &[Cell]) -> Self {
        let cells: Vec<&Cell> = cells.iter().filter(|cell| cell.scene == scene && cell.zeta == zeta).collect();
        let count = |what: &dyn Fn(&Cell) -> bool| cells.iter().filter(|cell| what(cell)).count();
        Self {
            scene,
            zeta,
            n_cells: cells.len(),
            n_moving: count(&Cell::moves),
            n_agree: count(&|cell| cell.share().is_some_and(|share| share <= AGREEMENT)),
            n_unresolved: count(&|cell| cell.share().is_some() && !cell.is_resolved()),
            n_not_converged: count(&|cell| !cell.is_converged),
            own_error_max_share: cells.iter().filter_map(|cell| cell.own_share()).fold(0.0, f64::max),
        }
    }
}

impl RuleLine {
    fn of(scene: Scene, cells: &[Cell]) -> Self {
        let judged: Vec<(bool, bool)> = cells
            .iter()
            .filter(|cell| cell.scene == scene)
            .filter_map(|cell| Some((is_sound_by_rule(cell), cell.share()? <= AGREEMENT)))
            .collect();
        let count = |what: (bool, bool)| judged.iter().filter(|cell| **cell == what).count();
        Self {
            scene,
            n_sound_and_agree: count((true, true)),
            n_sound_but_apart: count((true, false)),
            n_unsound_but_agree: count((false, true)),
            n_unsound_and_apart: count((false, false)),
        }
    }
}

impl CellLine {
    pub(super) fn of(cell: &Cell) -> Self {
        let finite = |value: Option<f64>| value.filter(|value| value.is_finite());
        Self {
            scene: cell.scene,
            zeta: cell.zeta,
            phi: cell.phi,
            epsilon: cell.epsilon,
            share: finite(cell.share()),
            own_error_share: finite(cell.own_share()),
            displacement_ratio: finite(cell.displacement_ratio()),
            predicted_share: finite(cell.predicted_share()),
            predicted_displacement_ratio: finite(cell.predicted_ratio()),
            way_m: cell.way_m,
            distance_m: cell.distance_m,
            own_error_m: cell.own_error_m,
            turn_share: cell.turn_share,
            jump_m: cell.jump_m,
            shift_quasi_static_m: cell.shift_quasi_static_m,
            shift_inertial_m: cell.shift_inertial_m,
            end_speed_m_per_s: cell.end_speed_m_per_s,
            is_resolved: cell.is_resolved(),
            is_converged: cell.is_converged,
        }
    }
}
