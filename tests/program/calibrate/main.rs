//! Springs as force sensors: known parameters are found again, intervals hold what they promise,
//! forces of recorded tips are those of the run.

mod behaviour;
mod colonies;
mod colony;
mod coverage;
mod design;
mod fit;
mod forces;
mod generated;
mod generated_grid;
mod grid;
mod observed;
mod program;
mod pulls;
#[path = "../../common/root.rs"]
mod root;

use cohaul::model::{SpringDesign, paper};
use cohaul_paper::calibrate::{Calibration, Dimensions, Measurements, Ranges, fit};
use generated::{Plan, measurements};

const TRUTH: SpringDesign = paper::SPRING;

/// No noise and no difference between trials.
const EXACT: Plan = Plan { between_trials: 0.0, noise: 0.0, states_noise: false, ..Plan::EXAMPLE };

fn fitted(data: &Measurements, ranges: &Ranges) -> Calibration {
    fit(data, &Dimensions::default(), ranges, 0.95).unwrap()
}

fn of(plan: &Plan) -> Calibration {
    fitted(&measurements(&TRUTH, plan), &Ranges::default())
}
