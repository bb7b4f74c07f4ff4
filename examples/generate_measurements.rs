//! Prints `data/spring-calibration.csv`: measurements that were never made, with a known truth.

use cohaul::model::SpringDesign;
use cohaul::studies::calibrate::generated::{EXAMPLE_COMMENT, Plan, measurements, to_csv};

fn main() {
    print!("{}", to_csv(&measurements(&SpringDesign::PAPER, &Plan::EXAMPLE), EXAMPLE_COMMENT));
}
