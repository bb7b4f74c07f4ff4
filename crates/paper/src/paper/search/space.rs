//! The open choices that are searched, and the design of their sets.
//!
//! The design is Saltelli's: two matrices A and B of independent sets, and for each choice the sets
//! of A with that choice taken from B. A is Sobol's sequence and B a Latin hypercube. The sets of A
//! come once more with other seeds, which shows what seeds alone do. Further sets fill the smallest
//! box around the sets that came closest, with some room: where accepted sets are rare, the whole
//! space would hold too few of them.

use serde_json::json;

use crate::paper::{Case, Trial};
use cohaul::backend::BackendKind;
use cohaul::model::open_choices::{Chosen, OPEN_CHOICES, Range};
use cohaul::scenario::presets::Preset;
use cohaul_studies::sweep::{hypercube_coordinate, sobol_coordinate};

/// A choice that is searched.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Searched {
    pub name: &'static str,
    pub key: &'static str,
    pub unit: &'static str,
    pub range: Range,
}

/// Keys that are not searched. The printed largest pull excludes zeta per millinewton. A grasp with
/// a probability at every control period is a hazard with that decision period, whatever the
/// period.
const LEFT_OUT: [&str; 2] = ["drive.release_steepness_per_n", "drive.grasp_pace"];
const PULL_SPEED: &str = "drive.pull_speed_m_per_s";
const RELEASE_PERIOD: &str = "drive.release_decision_period_s";
const RELEASE_PACE: &str = "drive.release_pace";
const CONTROL_PERIOD: &str = "control_period_s";
/// Pace with one decision of all ants per time step. The control period is then that step.
const PER_STEP: Chosen = Chosen::Word("per-tick");
/// Longest such step (s): a searching ant walks 8 mm in it, a third of the length of a spring.
const LONGEST_STEP_S: f64 = 0.1;
/// Way of a tip between two release decisions (m), in whose place the period follows from the
/// speed. The spring gains 2.7 to 20 mN on it: half the printed mean pull to F_m.
const WAY: Range = Range::Between { low: 0.004, high: 0.03, is_logarithmic: true };

/// All searched choices, in the order of [`OPEN_CHOICES`].
pub fn searched() -> Vec<Searched> {
    let of = |choice: &cohaul::model::open_choices::OpenChoice| {
        let key = choice.key.filter(|key| !LEFT_OUT.contains(key))?;
        choice.range.at(0.0)?;
        let (name, unit, range) = match key {
            RELEASE_PERIOD => ("way of a tip between release decisions", "m", WAY),
            _ => (choice.name, choice.unit, choice.range),
        };
        Some(Searched { name, key, unit, range })
    };
    OPEN_CHOICES.iter().filter_map(of).collect()
}

/// The sets of a search.
#[derive(Clone, Debug)]
pub struct Design {
    pub searched: Vec<Searched>,
    /// Rows of A and of B.
    pub n_rows: u64,
}

/// A box in the space of all sets: lower and upper place in the range of each choice (1).
#[derive(Clone, Debug, PartialEq)]
pub struct Within(Vec<[f64; 2]>);

/// Which matrix of the design a set belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Block {
    A,
    B,
    /// A with this choice from B.
    Swapped(usize),
    /// A with other seeds.
    OtherSeeds,
}

impl Design {
    pub fn new(n_rows: u64) -> Self {
        Self { searched: searched(), n_rows }
    }

    /// All blocks, in the order of their sets.
    pub fn blocks(&self) -> Vec<Block> {
        let swapped = (0..self.searched.len()).map(Block::Swapped);
        [Block::A, Block::B].into_iter().chain(swapped).chain([Block::OtherSeeds]).collect()
    }

    /// Number of different sets.
    pub fn n_sets(&self) -> usize {
        (self.searched.len() + 2) * self.n_rows as usize
    }

    /// Number of sets and of their repetitions with other seeds.
    pub fn n_tasks(&self) -> usize {
        self.n_sets() + self.n_rows as usize
    }

    /// Whether a task of the first look is the first one of its set.
    pub fn is_set(&self, task: usize) -> bool {
        !(self.n_sets()..self.n_tasks()).contains(&task)
    }

    /// Place of a set within the range of each searched choice (1).
    fn shares(&self, set: usize) -> Vec<f64> {
        let (block, row) = self.place(set);
        let share = |at: usize| {
            let of_a = || f64::from(sobol_coordinate(row + 1, at)) / 2f64.powi(32);
            let of_b = || hypercube_coordinate(HYPERCUBE_SEED, row, self.n_rows, at as u32);
            if block == Block::B || block == Block::Swapped(at) { of_b() } else { of_a() }
        };
        (0..self.searched.len()).map(share).collect()
    }

    fn chosen(&self, shares: &[f64]) -> Vec<Chosen> {
        self.searched.iter().zip(shares).map(|(choice, share)| choice.range.at(*share).expect("what is searched has a range")).collect()
    }

    /// Values of a set by its number, one for each searched choice.
    pub fn values(&self, set: usize) -> Vec<Chosen> {
        self.chosen(&self.shares(set))
    }

    /// Values of set number `index` of those in the box.
    pub fn values_within(&self, within: &Within, index: usize) -> Vec<Chosen> {
        let share = |(at, [low, high]): (usize, &[f64; 2])| {
            // Behind the rows of A, so that no set comes twice.
            low + (high - low) * f64::from(sobol_coordinate(self.n_rows + 1 + index as u64, at)) / 2f64.powi(32)
        };
        self.chosen(&within.0.iter().enumerate().map(share).collect::<Vec<_>>())
    }

    /// The smallest box around these sets, with a tenth of its width as room on both sides; all of
    /// the space without any.
    pub fn around(&self, sets: &[usize]) -> Within {
        let all: Vec<Vec<f64>> = sets.iter().map(|set| self.shares(*set)).collect();
        let of = |at: usize| {
            if all.is_empty() {
                return [0.0, 1.0];
            }
            let (low, high) = all.iter().fold((1.0f64, 0.0f64), |(low, high), shares| (low.min(shares[at]), high.max(shares[at])));
            let room = 0.1 * (high - low);
            [(low - room).max(0.0), (high + room).min(1.0)]
        };
        Within((0..self.searched.len()).map(of).collect())
    }

    /// Block and row of a set by its number.
    pub fn place(&self, set: usize) -> (Block, u64) {
        (self.blocks()[set / self.n_rows as usize], set as u64 % self.n_rows)
    }
}

const HYPERCUBE_SEED: u64 = 20_100;

/// A set as a case: every printed value of the paper, and these choices.
pub fn case(searched: &[Searched], values: &[Chosen], backend: BackendKind) -> Case {
    let value = |key: &str| searched.iter().zip(values).find(|(choice, _)| choice.key == key).map(|(_, value)| *value);
    let number = |key: &str| if let Some(Chosen::Number(value)) = value(key) { value } else { f64::NAN };
    let period = number(RELEASE_PERIOD) / number(PULL_SPEED);
    let is_per_step = value(RELEASE_PACE) == Some(PER_STEP);
    let of = |(choice, value): (&Searched, &Chosen)| {
        let value = match choice.key {
            RELEASE_PERIOD => json!(period),
            CONTROL_PERIOD if is_per_step => json!(period.min(LONGEST_STEP_S)),
            _ => json!(value),
        };
        (choice.key.to_owned(), value)
    };
    Case { set: searched.iter().zip(values).map(of).collect(), ..Case::new(Preset::Paper, backend) }
}

/// Trials of the search: those of the paper, and two ants on ten springs.
pub const TRIALS: [Trial; 5] = [Trial::OneOne, Trial::FourFour, Trial::OnTen(2), Trial::FIVE_TEN, Trial::TEN_TEN];

#[cfg(test)]
mod tests {
    use super::*;
    use cohaul::scenario::Drive;
    use cohaul::scenario::presets::ants;

    fn design() -> Design {
        Design::new(16)
    }

    #[test]
    fn sets_of_a_block_differ_from_those_of_a_in_one_choice() {
        let design = design();
        for set in 0..design.n_tasks() {
            let (block, row) = design.place(set);
            let of_a = design.values(row as usize);
            let n_other = design.values(set).iter().zip(&of_a).filter(|(one, of_a)| one != of_a).count();
            match block {
                Block::A | Block::OtherSeeds => assert_eq!(n_other, 0),
                // Words and numbers of a list may be the same in both.
                Block::Swapped(at) => {
                    assert!(n_other <= 1 && (n_other == 1 || !matches!(design.searched[at].range, Range::Between { .. })))
                }
                Block::B => assert!(n_other >= 7, "{n_other}"),
            }
        }
    }

    #[test]
    fn a_box_holds_the_sets_around_which_it_is() {
        let design = design();
        let within = design.around(&[3, 5]);
        let inside = |values: &[Chosen]| {
            let numbers = values.iter().zip(design.values(3)).zip(design.values(5));
            numbers
                .filter(|((value, one), other)| match (value, one, other) {
                    (Chosen::Number(value), Chosen::Number(one), Chosen::Number(other)) => {
                        let room = 0.35 * (one - other).abs();
                        (one.min(*other) - room..=one.max(*other) + room).contains(value)
                    }
                    _ => true,
                })
                .count()
                == values.len()
        };
        assert!((0..100).all(|index| inside(&design.values_within(&within, index))));
        assert!((0..16).any(|set| !inside(&design.values(set))));
    }

    /// A set keeps every printed value, and has the choices that it says.
    #[test]
    fn a_set_has_all_printed_values_and_its_own_choices() {
        let design = design();
        for set in 0..design.n_tasks() {
            let values = design.values(set);
            for trial in TRIALS {
                let scenario = trial.scenario(&case(&design.searched, &values, BackendKind::QuasiStatic), 7);
                let Drive::Ants(found) = scenario.drive else { panic!("ants") };
                let printed = ants(Preset::Paper, trial.n_ants());
                assert_eq!((found.n_ants, scenario.seed), (trial.n_ants(), 7));
                assert_eq!((found.steering_half_angle, found.control_offset), (printed.steering_half_angle, printed.control_offset));
                assert_eq!((found.release.strong_pull, found.release.steepness), (printed.release.strong_pull, printed.release.steepness));
                let value = |key: &str| design.searched.iter().zip(&values).find(|(choice, _)| choice.key == key).map(|(_, value)| *value);
                assert_eq!(value(PULL_SPEED), Some(Chosen::Number(found.pull_speed)));
                let Some(Chosen::Number(way)) = value(RELEASE_PERIOD) else { panic!("a way") };
                if value(RELEASE_PACE) == Some(PER_STEP) {
                    assert_eq!(scenario.control_period, found.release.period.min(LONGEST_STEP_S));
                } else {
                    assert_eq!(value(CONTROL_PERIOD), Some(Chosen::Number(scenario.control_period)));
                }
                // Rounding of a quotient and a product.
                assert!(
                    (found.pull_speed * found.release.period - way).abs() < 1e-15
                        && scenario.system.load
                            == Trial::FourFour.scenario(&Case::new(Preset::Paper, BackendKind::QuasiStatic), 1).system.load
                );
            }
        }
    }
}
