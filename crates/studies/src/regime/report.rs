//! Results of the regime map as numbers, for `--json`, the tables and the files.

use serde::{Serialize, Serializer};

use crate::regime::theory::{EPSILON_MAX, PHI_MIN, ZETA_MIN};
use crate::regime::{Cell, Grid, Law, LawOutcome, RELATIVE_TOLERANCE, Scene};
use cohaul::formats::{self, Format, Versioned};
use cohaul_report::table::Table;

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
    /// Short pulls at the speeds of the paper's ants.
    #[serde(serialize_with = "as_table")]
    pub paper: Vec<Cell>,
    #[serde(skip)]
    pub grids: Vec<Grid>,
    /// Cells of the maps, in the order of the grids.
    #[serde(skip)]
    pub cells: Vec<Cell>,
}

impl Versioned for Regime {
    const FORMAT: Format = formats::REGIME;
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

/// Whether quasi-static is valid in this cell by the rule of thumb.
pub fn is_valid_by_rule(cell: &Cell) -> bool {
    cell.epsilon <= EPSILON_MAX && cell.phi >= PHI_MIN && cell.zeta >= ZETA_MIN
}

impl Regime {
    /// Results for the `cells` of `grids` and the cells at the paper's points, in their order.
    pub fn new(grids: &[Grid], cells: Vec<Cell>, paper: Vec<Cell>, quick: bool, wall_s: f64) -> Self {
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
            paper,
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

fn as_table<S: Serializer>(cells: &[Cell], serializer: S) -> Result<S::Ok, S::Error> {
    table(cells).serialize(serializer)
}

/// Columns of `regime.csv`; empty fields, in JSON `null`, where there is no number.
pub(super) fn table(cells: &[Cell]) -> Table {
    let finite = |value: Option<f64>| value.filter(|value| value.is_finite()).into();
    Table::of(
        cells,
        &[
            ("scene", "", &|cell| cell.scene.name().into()),
            ("zeta", "", &|cell| cell.zeta.into()),
            ("phi", "", &|cell| cell.phi.into()),
            ("epsilon", "", &|cell| cell.epsilon.into()),
            ("distance ratio", "", &|cell| finite(cell.distance_ratio())),
            ("reference error ratio", "", &|cell| finite(cell.reference_error_ratio())),
            ("displacement ratio", "", &|cell| finite(cell.displacement_ratio())),
            ("predicted distance ratio", "", &|cell| finite(cell.predicted_distance_ratio())),
            ("predicted displacement ratio", "", &|cell| finite(cell.predicted_displacement_ratio())),
            ("path length", "m", &|cell| cell.path_length_m.into()),
            ("distance", "m", &|cell| cell.distance_m.into()),
            ("reference error", "m", &|cell| cell.reference_error_m.into()),
            ("turn share", "", &|cell| cell.turn_share.into()),
            ("jump", "m", &|cell| cell.jump_m.into()),
            ("displacement quasi static", "m", &|cell| cell.displacement_quasi_static_m.into()),
            ("displacement inertial", "m", &|cell| cell.displacement_inertial_m.into()),
            ("end speed", "m/s", &|cell| cell.end_speed_m_per_s.into()),
            ("is conclusive", "", &|cell| cell.is_conclusive().into()),
            ("is converged", "", &|cell| cell.is_converged.into()),
        ],
    )
}
