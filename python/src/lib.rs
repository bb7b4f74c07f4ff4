//! The native part of the Python package `cohaul`. What users call is in `cohaul/*.py`.
//!
//! ```text
//! scene.rs       a checked scenario
//! options.rs     options of a backend and settings of a comparison
//! work.rs        computing without the interpreter's lock: interrupts, progress, panics
//! trace.rs       columns of a trace, which numpy reads in place
//! import.rs      scenarios from recordings and drawings
//! run.rs         one run
//! controller.rs  a controller that is written in Python
//! engine.rs      an engine that is written in Python
//! pushed.rs      the example of a pushing controller in Rust
//! seen.rs        obstacles, contacts and friction as a controller sees them
//! state.rs       a load with its time, and its state as numbers
//! stepper.rs     a load that is moved step by step
//! rollouts.rs    many short runs in one call
//! compare.rs     a comparison of three backends
//! measure.rs     a measure of a run that is written in Python
//! conformance.rs questions with closed answers
//! measured.rs    measured runs beside simulated ones
//! sweep.rs       many runs on all threads
//! maps.rs        maps of comparisons, and thresholds
//! check.rs       stored baselines
//! ```
#![deny(unsafe_code)]

mod check;
mod compare;
mod conformance;
mod controller;
mod engine;
mod import;
mod maps;
mod measure;
mod measured;
mod options;
mod points;
mod pushed;
mod rollouts;
mod run;
mod scene;
mod seen;
mod state;
mod stepper;
mod sweep;
mod trace;
mod work;

use pyo3::prelude::*;

#[pymodule]
mod _native {
    #[pymodule_export]
    use super::check::{Check, check, store_baseline};
    #[pymodule_export]
    use super::compare::{Comparison, compare};
    #[pymodule_export]
    use super::conformance::{Conformance, conformance};
    #[pymodule_export]
    use super::controller::View;
    #[pymodule_export]
    use super::import::{Import, import_scenario};
    #[pymodule_export]
    use super::maps::{MapData, ThresholdData, compare_map, threshold};
    #[pymodule_export]
    use super::measured::{Measured, measured};
    #[pymodule_export]
    use super::pushed::rust_push;
    #[pymodule_export]
    use super::rollouts::{RolloutData, rollouts, rust_rollouts_s, seeded_rollouts};
    #[pymodule_export]
    use super::run::{RunData, run};
    #[pymodule_export]
    use super::scene::{Scene, shipped};
    #[pymodule_export]
    use super::stepper::{Stepper, rust_loop_s};
    #[pymodule_export]
    use super::sweep::{SweepData, sweep};
    #[pymodule_export]
    use super::trace::{Column, TraceData};

    #[pymodule_init]
    fn named(module: &super::Bound<'_, super::PyModule>) -> super::PyResult<()> {
        use pyo3::types::PyModuleMethods;

        cohaul_report::manifest::built_from(option_env!("COHAUL_COMMIT"));
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
