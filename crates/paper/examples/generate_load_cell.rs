//! Prints `data/load-cell.csv`: readings of a load cell that were never made, with a known truth.

use generated_grid::{GRID_COMMENT, load_cell};

#[allow(dead_code, reason = "the tests use the truth, too")]
#[path = "../../../tests/program/calibrate/generated_grid.rs"]
mod generated_grid;

fn main() {
    print!("{}", load_cell(7, 0.03, 5e-5, GRID_COMMENT));
}
