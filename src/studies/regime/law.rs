//! Laws of theory against the measurement, and why they part.

use std::collections::BTreeMap;
use std::f64::consts::FRAC_PI_2;

use serde::Serialize;

use super::cell::Cell;
use super::scene::Scene;
use super::theory;

/// What theory says of one number of one scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Law {
    /// Largest distance of an excursion: epsilon f / k, which is 1 / Phi of the way.
    Ramp,
    /// Displacement of an excursion without dashpots.
    UndampedExcursion,
    /// Displacement of an excursion.
    Excursion,
    /// Displacement of the tug of war: the mean of release factor and excursion.
    Release,
    /// The same with the speed of the jump, the first stop and the second onset.
    ReleaseInFull,
    /// Largest distance in the haul: 2 epsilon f / k.
    Hold,
}

/// Why a cell is not where a law has it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
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
    /// None of these: a law that should hold does not.
    Unknown,
}

/// How a law stands in the cells of one damping.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Standing {
    pub law: Law,
    pub zeta: f64,
    /// Cells that have both numbers, with an own error below a tenth.
    pub n_cells: usize,
    /// Of these, measured over theory from 0.8 to 1.25.
    pub n_within: usize,
    /// Measured over theory: the least, the median and the largest; `null` without cells.
    pub ratio: Option<[f64; 3]>,
    /// Of the others, how many for which reason.
    pub causes: BTreeMap<Cause, usize>,
}

/// Measured over theory (1) that counts as agreement.
const WITHIN: [f64; 2] = [0.8, 1.25];
/// Own error over what is measured (1), above which a cell says nothing of a law.
const LARGEST_OWN_ERROR: f64 = 0.1;

/// Tips so slow that nothing coasts.
const NO_COAST: f64 = 1e-12;

impl Law {
    pub const ALL: [Law; 6] = [Law::Ramp, Law::UndampedExcursion, Law::Excursion, Law::Release, Law::ReleaseInFull, Law::Hold];

    pub fn scene(self) -> Scene {
        match self {
            Law::Ramp | Law::UndampedExcursion | Law::Excursion => Scene::Excursion,
            Law::Release | Law::ReleaseInFull => Scene::TugOfWar,
            Law::Hold => Scene::Haul,
        }
    }

    pub fn name(self) -> &'static str {
        match self {
            Law::Ramp => "distance: epsilon f / k",
            Law::UndampedExcursion => "displacement, undamped",
            Law::Excursion => "displacement, damped",
            Law::Release => "displacement: release factor and excursion",
            Law::ReleaseInFull => "displacement, with coast, stop and wait",
            Law::Hold => "distance: 2 epsilon f / k",
        }
    }

    /// For the title of a panel.
    pub fn short_name(self) -> &'static str {
        match self {
            Law::Ramp => "epsilon f / k",
            Law::UndampedExcursion => "undamped law",
            Law::Excursion => "damped law",
            Law::Release => "release law",
            Law::ReleaseInFull => "release in full",
            Law::Hold => "2 epsilon f / k",
        }
    }

    /// Whether the law is about the displacement at the end, and not the largest distance on the
    /// way.
    pub fn is_displacement(self) -> bool {
        !matches!(self, Law::Ramp | Law::Hold)
    }

    pub fn predicted(self, cell: &Cell) -> Option<f64> {
        let Cell { phi, epsilon, zeta, .. } = *cell;
        match self {
            Law::Ramp => Some(1.0 / phi),
            Law::UndampedExcursion => Some(theory::excursion_undamped(phi, epsilon)),
            Law::Excursion => Some(theory::excursion(phi, epsilon, zeta)),
            Law::Release => Some(theory::release(phi, epsilon, zeta)),
            Law::ReleaseInFull => theory::release_exact(phi, epsilon, zeta),
            Law::Hold => cell.predicted_share(),
        }
    }

    /// Measured over theory; `None` where one of the two is missing, or not resolved.
    pub fn ratio(self, cell: &Cell) -> Option<f64> {
        let (measured, length) = match self.is_displacement() {
            true => (cell.displacement_ratio()?, cell.shift_inertial_m.abs()),
            false => (cell.share()?, cell.distance_m),
        };
        let is_resolved = cell.own_error_m <= LARGEST_OWN_ERROR * length;
        self.predicted(cell).filter(|predicted| is_resolved && *predicted > 0.0).map(|predicted| measured / predicted)
    }

    pub fn holds(ratio: f64) -> bool {
        (WITHIN[0]..=WITHIN[1]).contains(&ratio)
    }

    /// Why a cell that is off is off.
    pub fn cause(self, cell: &Cell) -> Cause {
        let Cell { phi, epsilon, zeta, .. } = *cell;
        match self {
            // Without the coast, which is all that epsilon does here.
            Law::Ramp if Law::holds(phi * theory::excursion_share(phi, NO_COAST, zeta)) => Cause::Coasting,
            Law::Ramp if zeta > 0.0 => Cause::Dashpot,
            Law::Ramp if phi < FRAC_PI_2 => Cause::FirstSwing,
            Law::UndampedExcursion if zeta > 0.0 => Cause::Dashpot,
            Law::Release => cause_after_release(cell),
            Law::ReleaseInFull if theory::release_exact(phi, epsilon, zeta).is_none() => Cause::TurnedBack,
            Law::Hold if cell.turn_share > 0.5 => Cause::Rotation,
            Law::Hold if cell.jump_m > 0.5 * cell.distance_m => Cause::Jump,
            Law::Hold if epsilon > 0.2 => Cause::Coasting,
            Law::Hold => Cause::SeveralEvents,
            _ => Cause::Unknown,
        }
    }
}

/// What the sum of jump and drive leaves out.
fn cause_after_release(cell: &Cell) -> Cause {
    let Cell { phi, epsilon, zeta, .. } = *cell;
    let Some(whole) = theory::release_exact(phi, epsilon, zeta) else { return Cause::TurnedBack };
    if Law::ReleaseInFull.ratio(cell).is_none_or(|ratio| !Law::holds(ratio)) {
        return Cause::Unknown;
    }
    if theory::first_stop(zeta, [phi, 1.0], phi).is_some() {
        return Cause::Waiting;
    }
    // Without a stop epsilon is in the coast alone.
    let still = theory::release_exact(phi, NO_COAST, zeta).unwrap_or(whole);
    if Law::holds(still / theory::release(phi, epsilon, zeta)) { Cause::Coasting } else { Cause::Dashpot }
}

impl Cause {
    pub const ALL: [Cause; 9] = [
        Cause::Dashpot,
        Cause::FirstSwing,
        Cause::Coasting,
        Cause::Waiting,
        Cause::TurnedBack,
        Cause::Jump,
        Cause::Rotation,
        Cause::SeveralEvents,
        Cause::Unknown,
    ];

    pub fn name(self) -> &'static str {
        match self {
            Cause::Dashpot => "dashpot",
            Cause::FirstSwing => "first swing",
            Cause::Coasting => "coasting",
            Cause::Waiting => "waiting",
            Cause::TurnedBack => "turned back",
            Cause::Jump => "jump",
            Cause::Rotation => "rotation",
            Cause::SeveralEvents => "several events",
            Cause::Unknown => "unknown",
        }
    }

    /// In a sentence.
    pub fn what(self) -> &'static str {
        match self {
            Cause::Dashpot => {
                "A dashpot helps the spring over the slip limit 2 zeta / omega_n before the load without inertia moves, and lets the ripple die out; the undamped law has neither."
            }
            Cause::FirstSwing => {
                "Let go within a quarter of a period the load has not yet fallen behind by all of v / omega_n: only by sin Phi of it."
            }
            Cause::Coasting => {
                "Let go at up to twice the speed of the tip, or faster after a jump, the load coasts by epsilon / 2 of its speed squared."
            }
            Cause::Waiting => {
                "A load that has overshot stands until the tip has made up for it: the overshoot is lent, not gained, and what is left at the end is the ripple of the second onset."
            }
            Cause::TurnedBack => {
                "After a jump of more than twice f / k (epsilon Phi > 2) the spring, compressed by the overshoot, pushes the load back."
            }
            Cause::Jump => {
                "At a release the load without inertia jumps and the other stays where it is: as long as it swings the two are a jump apart, whatever the speed of the tips."
            }
            Cause::Rotation => "More than half of the distance is turn, of which a law for one spring through the centre knows nothing.",
            Cause::SeveralEvents => {
                "Some grasps change the pull before the load has slipped by v / omega_n, so that it stays nearer than the law has it, and what is left of earlier ones adds to it or takes off."
            }
            Cause::Unknown => "The law should hold here and does not.",
        }
    }
}

impl Standing {
    /// Of every law at every damping, in that order.
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
