//! Results of the regime map as numbers, for `--json`, the tables and the files.

use serde::Serialize;

use crate::studies::regime::theory::{EPSILON_MAX, PHI_MIN, ZETA_MIN};
use crate::studies::regime::{Cell, Grid, Law, LawOutcome, RELATIVE_TOLERANCE, Scene};

/// What `regime --json` prints.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Regime {
    /// Whether the exact laws hold in every cell that is compared with them.
    pub holds: bool,
    pub quick: bool,
    /// Tolerance divided by the quasi-static path length (1): paths that differ by less agree.
    pub relative_tolerance: f64,
    pub n_cells: usize,
    pub wall_s: f64,
    pub maps: Vec<MapLine>,
    pub laws: Vec<LawOutcome>,
    pub rule: Vec<RuleLine>,
    /// Where the paper's ants work.
    pub paper: Vec<CellLine>,
    #[serde(skip)]
    pub grids: Vec<Grid>,
    /// Cells of the maps, in the order of the grids.
    #[serde(skip)]
    pub cells: Vec<Cell>,
}

/// One panel in numbers.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MapLine {
    pub scene: Scene,
    pub zeta: f64,
    pub n_cells: usize,
    /// Cells in which the load moves without inertia.
    pub n_moving: usize,
    /// Cells in which the distance stays within the tolerance.
    pub n_agree: usize,
    /// Cells in which the distance is smaller than the reference error.
    pub n_inconclusive: usize,
    /// Cells in which a step did not converge.
    pub n_not_converged: usize,
    /// Largest reference error over the path length, of all cells that move (1).
    pub reference_error_max_ratio: f64,
}

/// Counts of moving cells by the rule of thumb and by the measurement. The rule says that
/// quasi-static is valid where epsilon <= 0.05, Phi >= 2 pi and zeta >= 0.5.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RuleLine {
    pub scene: Scene,
    pub n_valid_and_agree: usize,
    pub n_valid_but_differ: usize,
    pub n_not_valid_but_agree: usize,
    pub n_not_valid_and_differ: usize,
}

/// A row of `regime.csv`; empty fields where there is no number.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CellLine {
    pub scene: Scene,
    pub zeta: f64,
    pub phi: f64,
    pub epsilon: f64,
    pub distance_ratio: Option<f64>,
    pub reference_error_ratio: Option<f64>,
    pub displacement_ratio: Option<f64>,
    pub predicted_distance_ratio: Option<f64>,
    pub predicted_displacement_ratio: Option<f64>,
    pub path_length_m: f64,
    pub distance_m: f64,
    pub reference_error_m: f64,
    pub turn_share: f64,
    pub jump_m: f64,
    pub displacement_quasi_static_m: f64,
    pub displacement_inertial_m: f64,
    pub end_speed_m_per_s: f64,
    pub is_conclusive: bool,
    pub is_converged: bool,
}

/// Whether quasi-static is valid in this cell by the rule of thumb.
pub fn is_valid_by_rule(cell: &Cell) -> bool {
    cell.epsilon <= EPSILON_MAX && cell.phi >= PHI_MIN && cell.zeta >= ZETA_MIN
}

impl Regime {
    /// Results for the `cells` of `grids` and the cells at the paper's points, in their order.
    pub fn new(grids: &[Grid], cells: Vec<Cell>, paper: &[Cell], quick: bool, wall_s: f64) -> Self {
        let laws = LawOutcome::all(&cells);
        let is_exact = |outcome: &&LawOutcome| matches!(outcome.law, Law::Excursion | Law::ReleaseInFull);
        Self {
            holds: laws.iter().filter(is_exact).all(|outcome| outcome.n_within == outcome.n_cells),
            quick,
            relative_tolerance: RELATIVE_TOLERANCE,
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
            n_agree: count(&|cell| cell.distance_ratio().is_some_and(|ratio| ratio <= RELATIVE_TOLERANCE)),
            n_inconclusive: count(&|cell| cell.distance_ratio().is_some() && !cell.is_conclusive()),
            n_not_converged: count(&|cell| !cell.is_converged),
            reference_error_max_ratio: cells.iter().filter_map(|cell| cell.reference_error_ratio()).fold(0.0, f64::max),
        }
    }
}

impl RuleLine {
    fn of(scene: Scene, cells: &[Cell]) -> Self {
        let judged: Vec<(bool, bool)> = cells
            .iter()
            .filter(|cell| cell.scene == scene)
            .filter_map(|cell| Some((is_valid_by_rule(cell), cell.distance_ratio()? <= RELATIVE_TOLERANCE)))
            .collect();
        let count = |what: (bool, bool)| judged.iter().filter(|cell| **cell == what).count();
        Self {
            scene,
            n_valid_and_agree: count((true, true)),
            n_valid_but_differ: count((true, false)),
            n_not_valid_but_agree: count((false, true)),
            n_not_valid_and_differ: count((false, false)),
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
            distance_ratio: finite(cell.distance_ratio()),
            reference_error_ratio: finite(cell.reference_error_ratio()),
            displacement_ratio: finite(cell.displacement_ratio()),
            predicted_distance_ratio: finite(cell.predicted_distance_ratio()),
            predicted_displacement_ratio: finite(cell.predicted_displacement_ratio()),
            path_length_m: cell.path_length_m,
            distance_m: cell.distance_m,
            reference_error_m: cell.reference_error_m,
            turn_share: cell.turn_share,
            jump_m: cell.jump_m,
            displacement_quasi_static_m: cell.displacement_quasi_static_m,
            displacement_inertial_m: cell.displacement_inertial_m,
            end_speed_m_per_s: cell.end_speed_m_per_s,
            is_conclusive: cell.is_conclusive(),
            is_converged: cell.is_converged,
        }
    }
}
