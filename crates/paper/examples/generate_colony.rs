//! Prints `data/colony-tips.csv`: a recording of a colony that never lived, with a known truth.

use observed::{COLONY_COMMENT, colony};

#[allow(dead_code)]
#[path = "../../../tests/program/calibrate/observed.rs"]
mod observed;

fn main() {
    print!("{COLONY_COMMENT}{}", colony());
}
