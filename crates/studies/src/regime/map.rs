//! Grids of the maps, and their cells as tasks.

use super::cell::Cell;
use super::scene::{Scene, Setting};
use crate::runner::{Effort, Tasks};
use crate::verify::scenes::{SLIP_STRETCH, natural_rate};

/// Points of one scene, in an order in which Phi changes fastest and zeta slowest.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    pub scene: Scene,
    pub phis: Vec<f64>,
    pub epsilons: Vec<f64>,
    pub zetas: Vec<f64>,
}

impl Grid {
    pub fn of(scene: Scene, effort: Effort) -> Self {
        // A haul takes seconds where the others take milliseconds, and minutes at a hundred
        // radians.
        let (n, longest, zetas) = match (scene, effort) {
            (Scene::Haul, Effort::Full) => (12, 10.0, vec![0.0, 0.5]),
            (Scene::Haul, Effort::Quick) => (3, 3.0, vec![0.0, 0.5]),
            (_, Effort::Full) => (20, 300.0, vec![0.0, 0.1, 0.5, 1.0]),
            (_, Effort::Quick) => (6, 300.0, vec![0.0, 0.1, 0.5, 1.0]),
        };
        // Below a fiftieth nothing moves in the haul.
        let slowest = if scene == Scene::Haul { 0.02 } else { 1e-3 };
        Self { scene, phis: by_factors(0.3, longest, n), epsilons: by_factors(slowest, 1.0, n), zetas }
    }

    /// The paper's load on tips with the speeds of its ants that are attached for 0.1 to 0.3 s.
    pub fn of_short_pulls(scene: Scene) -> Self {
        Self { scene, phis: SHORT_PHIS.to_vec(), epsilons: PAPER_SPEEDS.map(epsilon_of).to_vec(), zetas: vec![0.0] }
    }

    pub fn n_cells(&self) -> usize {
        self.phis.len() * self.epsilons.len() * self.zetas.len()
    }

    pub fn setting(&self, index: usize) -> Setting {
        let (n, m) = (self.phis.len(), self.epsilons.len());
        Setting { phi: self.phis[index % n], epsilon: self.epsilons[index / n % m], zeta: self.zetas[index / (n * m)], mass_factor: 1.0 }
    }
}

/// Speeds of the paper's tips (m/s).
pub const PAPER_SPEEDS: [f64; 3] = [0.03, 0.04, 0.08];
/// omega_n T_e of ants that pull for a short time. Those of the default preset pull longer.
pub const SHORT_PHIS: [f64; 3] = [2.0, 4.0, 6.0];

/// Epsilon of the paper's load with tips at this speed (m/s).
pub fn epsilon_of(speed: f64) -> f64 {
    speed / natural_rate() / SLIP_STRETCH
}

/// `n` values from `low` to `high` by equal factors.
fn by_factors(low: f64, high: f64, n: usize) -> Vec<f64> {
    (0..n).map(|i| low * (high / low).powf(i as f64 / (n - 1) as f64)).collect()
}

/// All settings in the order of their cells.
pub fn cells(grids: &[Grid]) -> Vec<(Scene, Setting)> {
    grids.iter().flat_map(|grid| (0..grid.n_cells()).map(|index| (grid.scene, grid.setting(index)))).collect()
}

/// One task a cell of `grids`, in their order.
pub fn tasks(grids: &[Grid]) -> Tasks<'static, Cell> {
    let all = cells(grids);
    let cost = |(scene, at): &(Scene, Setting)| if *scene == Scene::Haul { 100.0 + 30.0 * at.phi * at.phi } else { 4.0 + at.phi };
    Tasks { costs: all.iter().map(cost).collect(), run: Box::new(move |task, go_on| Cell::measure(all[task].0, &all[task].1, go_on)) }
}
