//! Prints `data/spring-calibration.csv`: measurements that were never made, with a known truth.

use cohaul::model::paper;
use generated::{EXAMPLE_COMMENT, Plan, measurements, to_csv};

#[path = "../../../tests/program/calibrate/generated.rs"]
mod generated;

fn main() {
    print!("{}", to_csv(&measurements(&paper::SPRING, &Plan::EXAMPLE), EXAMPLE_COMMENT));
}
