//! The example of a pushing controller in Rust, whose numbers the one in Python has to the bit.

use cohaul::simulation::{Keep, Simulation};
use pyo3::prelude::*;

use crate::options::{Asked, read};
use crate::scene::Scene;

#[expect(dead_code, reason = "it is a program")]
#[path = "../../examples/push_to_goal.rs"]
mod example;

/// Time (s), and x, y (m) and heading (rad) of the load, in each row of a run of the example.
#[pyfunction]
pub fn rust_push(scene: &Scene, options: &str) -> PyResult<Vec<(f64, f64, f64, f64)>> {
    let options = read::<Asked>(options)?.options(&scene.scenario)?;
    let mut run = Simulation::with_controller(&scene.scenario, &options, Keep::Trace, Box::<example::Push>::default());
    run.run(|_time| true);
    let rows = &run.trace().rows;
    Ok(rows.iter().map(|row| (row.time, row.motion.pose.position.x, row.motion.pose.position.y, row.motion.pose.heading)).collect())
}
