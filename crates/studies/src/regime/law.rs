//! Laws of theory compared with the measurement, and the causes of their differences.

use std::collections::BTreeMap;
use std::f64::consts::FRAC_PI_2;

use serde::{Deserialize, Serialize};

use super::cell::Cell;
use super::scene::Scene;
use super::theory;
use crate::variants::names;

/// A law of theory for one number of one scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Law {
    /// Largest distance of an excursion: epsilon f / k, which is 1 / Phi of the path length.
    Ramp,
    /// Displacement of an excursion without dashpots.
    UndampedExcursion,
    /// Displacement of an excursion.
    Excursion,
    /// Displacement of the tug of war: the mean of release factor and excursion.
    Release,
    /// Displacement of the tug of war, with the speed of the jump, the first stop and the second
    /// slip onset.
    ReleaseInFull,
    /// Largest distance in the haul under continuous driving: 2 epsilon f / k.
    Driving,
}

/// Why the measurement in a cell differs from a law.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Cause {
    Dashpot,
    FirstSwing,
    Coasting,
    Waiting,
    TurnedBack,
    Jump,
    Rotation,
    SeveralEvents,
    /// None of the other causes applies: a law that should hold fails.
    Unknown,
}

/// How well a law agrees with the cells of one damping ratio.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LawOutcome {
    pub law: Law,
    pub zeta: f64,
    /// Cells that have both numbers, with a reference error below a tenth of the measured number.
    pub n_cells: usize,
    /// Cells among these in which measured over theory lies between 0.8 and 1.25.
    pub n_within: usize,
    /// Measured over theory: the least, the median and the largest; `null` without cells.
    pub ratio: Option<[f64; 3]>,
    /// Number of the other cells for each cause.
    pub causes: BTreeMap<Cause, usize>,
}

/// Measured over theory (1) that counts as agreement.
const WITHIN: [f64; 2] = [0.8, 1.25];
/// Reference error over the measured number (1), above which a cell is not compared with a law.
const REFERENCE_ERROR_MAX: f64 = 0.1;

/// Epsilon of tips so slow that the coast is negligible (1).
const NO_COAST: f64 = 1e-12;

impl Law {
    pub const ALL: [Law; 6] = [Law::Ramp, Law::UndampedExcursion, Law::Excursion, Law::Release, Law::ReleaseInFull, Law::Driving];

    /// Its scene, its name, and its name in the title of a panel.
    fn facts(self) -> (Scene, &'static str, &'static str) {
        match self {
            Law::Ramp => (Scene::Excursion, "distance: epsilon f / k", "epsilon f / k"),
            Law::UndampedExcursion => (Scene::Excursion, "displacement, undamped", "undamped law"),
            Law::Excursion => (Scene::Excursion, "displacement, damped", "damped law"),
            Law::Release => (Scene::TugOfWar, "displacement: release factor and excursion", "release law"),
            Law::ReleaseInFull => (Scene::TugOfWar, "displacement, with coast, stop and wait", "release in full"),
            Law::Driving => (Scene::Haul, "distance: 2 epsilon f / k", "2 epsilon f / k"),
        }
    }

    pub fn scene(self) -> Scene {
        self.facts().0
    }

    pub fn name(self) -> &'static str {
        self.facts().1
    }

    pub fn short_name(self) -> &'static str {
        self.facts().2
    }

    /// Whether the law predicts the displacement at the end. The other laws predict the largest
    /// distance.
    pub fn is_displacement(self) -> bool {
        !matches!(self, Law::Ramp | Law::Driving)
    }

    /// Predicted number of the law in a cell; `None` where it has none.
    pub fn predicted(self, cell: &Cell) -> Option<f64> {
        let Cell { phi, epsilon, zeta, .. } = *cell;
        match self {
            Law::Ramp => Some(1.0 / phi),
            Law::UndampedExcursion => Some(theory::excursion_undamped(phi, epsilon)),
            Law::Excursion => Some(theory::excursion(phi, epsilon, zeta)),
            Law::Release => Some(theory::release(phi, epsilon, zeta)),
            Law::ReleaseInFull => theory::release_exact(phi, epsilon, zeta),
            Law::Driving => cell.predicted_distance_ratio(),
        }
    }

    /// Measured over theory (1). `None` where one of the two is missing, or where the reference
    /// error exceeds a tenth of the measured number.
    pub fn ratio(self, cell: &Cell) -> Option<f64> {
        let (measured, length) = match self.is_displacement() {
            true => (cell.displacement_ratio()?, cell.displacement_inertial_m.abs()),
            false => (cell.distance_ratio()?, cell.distance_m),
        };
        let is_accurate = cell.reference_error_m <= REFERENCE_ERROR_MAX * length;
        self.predicted(cell).filter(|predicted| is_accurate && *predicted > 0.0).map(|predicted| measured / predicted)
    }

    pub fn holds(ratio: f64) -> bool {
        (WITHIN[0]..=WITHIN[1]).contains(&ratio)
    }

    /// Why a cell in which the law fails differs from it.
    pub fn cause(self, cell: &Cell) -> Cause {
        let Cell { phi, epsilon, zeta, .. } = *cell;
        match self {
            // The coast is all that epsilon changes here.
            Law::Ramp if Law::holds(phi * theory::excursion_distance_ratio(phi, NO_COAST, zeta)) => Cause::Coasting,
            Law::Ramp if zeta > 0.0 => Cause::Dashpot,
            Law::Ramp if phi < FRAC_PI_2 => Cause::FirstSwing,
            Law::UndampedExcursion if zeta > 0.0 => Cause::Dashpot,
            Law::Release => cause_after_release(cell),
            Law::ReleaseInFull if theory::release_exact(phi, epsilon, zeta).is_none() => Cause::TurnedBack,
            Law::Driving if cell.turn_share > 0.5 => Cause::Rotation,
            Law::Driving if cell.jump_m > 0.5 * cell.distance_m => Cause::Jump,
            Law::Driving if epsilon > 0.2 => Cause::Coasting,
            Law::Driving => Cause::SeveralEvents,
            _ => Cause::Unknown,
        }
    }
}

/// Which effect the sum of jump and drive neglects in a cell of the tug of war.
fn cause_after_release(cell: &Cell) -> Cause {
    let Cell { phi, epsilon, zeta, .. } = *cell;
    let Some(whole) = theory::release_exact(phi, epsilon, zeta) else { return Cause::TurnedBack };
    if Law::ReleaseInFull.ratio(cell).is_none_or(|ratio| !Law::holds(ratio)) {
        return Cause::Unknown;
    }
    if theory::first_stop(zeta, [phi, 1.0], phi).is_some() {
        return Cause::Waiting;
    }
    // Without a stop epsilon changes the coast alone.
    let still = theory::release_exact(phi, NO_COAST, zeta).unwrap_or(whole);
    if Law::holds(still / theory::release(phi, epsilon, zeta)) { Cause::Coasting } else { Cause::Dashpot }
}

impl Cause {
    pub fn name(self) -> String {
        names::<Self>()[self as usize].replace('-', " ")
    }

    pub fn what(self) -> &'static str {
        match self {
            Cause::Dashpot => {
                "A dashpot adds to the spring force, so that slip begins 2 zeta / omega_n earlier than without inertia, and it damps the ripple. The undamped law has neither."
            }
            Cause::FirstSwing => "A load released within a quarter of a period lags behind by only sin Phi times v / omega_n.",
            Cause::Coasting => {
                "A load released at up to twice the speed of the tip, or faster after a jump, coasts by epsilon / 2 times its speed squared."
            }
            Cause::Waiting => {
                "A load that has overshot rests until the tip has caught up, so that the overshoot is lost again. What remains at the end is the ripple of the second slip onset."
            }
            Cause::TurnedBack => {
                "After a jump of more than twice f / k (epsilon Phi > 2), the overshoot compresses the spring, which pushes the load back."
            }
            Cause::Jump => {
                "At a release the quasi-static load jumps, while the inertial load starts from rest. Their distance is then the whole jump, whatever the speed of the tips."
            }
            Cause::Rotation => {
                "More than half of the distance comes from the heading, which a law for one spring through the centre does not contain."
            }
            Cause::SeveralEvents => {
                "Some grasps change the pull before the load lags behind by v / omega_n, so that the distance stays below the law. Remainders of earlier events add to it or subtract from it."
            }
            Cause::Unknown => "The law should hold here, but it fails.",
        }
    }
}

impl LawOutcome {
    /// Outcome of every law at every damping ratio, in that order.
    pub fn all(cells: &[Cell]) -> Vec<Self> {
        let mut zetas: Vec<f64> = cells.iter().map(|cell| cell.zeta).collect();
        zetas.sort_by(f64::total_cmp);
        zetas.dedup();
        Law::ALL.iter().flat_map(|law| zetas.iter().map(|zeta| Self::of(*law, *zeta, cells))).filter(|it| it.n_cells > 0).collect()
    }

    fn of(law: Law, zeta: f64, cells: &[Cell]) -> Self {
        let of_law = cells.iter().filter(|cell| cell.scene == law.scene() && cell.zeta == zeta);
        let judged: Vec<(f64, &Cell)> = of_law.filter_map(|cell| Some((law.ratio(cell)?, cell))).collect();
        let mut causes = BTreeMap::new();
        for (_, cell) in judged.iter().filter(|(ratio, _)| !Law::holds(*ratio)) {
            *causes.entry(law.cause(cell)).or_default() += 1;
        }
        let mut ratios: Vec<f64> = judged.iter().map(|(ratio, _)| *ratio).collect();
        ratios.sort_by(f64::total_cmp);
        let n_within = ratios.iter().filter(|ratio| Law::holds(**ratio)).count();
        let ratio = (!ratios.is_empty()).then(|| [ratios[0], ratios[ratios.len() / 2], ratios[ratios.len() - 1]]);
        Self { law, zeta, n_cells: ratios.len(), n_within, ratio, causes }
    }
}
