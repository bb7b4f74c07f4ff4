//! Compares the inertia estimate of quasi-static runs with the measured inertia effect, over all
//! scenes and many random ones.
//!
//! ```sh
//! cargo run --release --example calibrate_estimate -- results/2026-11-21-inertia-estimate
//! ```
//!
//! writes `calibration.csv`, `calibration.svg` and `figures.txt` to an existing folder, and prints
//! the last.

mod figure;
#[path = "../../../../tests/common/random_scenes.rs"]
mod random_scenes;
mod scene;
mod statistics;

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

use cohaul::scenario::{Drive, Scenario};
use cohaul_report::progress::Progress;
use rayon::prelude::*;

use scene::{Class, Found};

/// Seeds of the random scenes. The estimate was developed on the seeds 0 to 239 only.
const SEEDS: std::ops::Range<u64> = 1001..1271;
/// Longest duration of stored scenes with ants (s).
const LONGEST_ANTS: f64 = 60.0;
/// Largest number of springs; larger scenes take longer than all others together.
const MOST_SPRINGS: usize = 100;

type AnyError = Box<dyn std::error::Error>;

fn main() -> Result<(), AnyError> {
    let target = PathBuf::from(std::env::args().nth(1).ok_or("give the folder to write to")?);
    let mut scenes = stored()?;
    scenes.extend(SEEDS.map(|seed| (format!("random-{seed}"), Class::Random, random_scenes::random_scenario(seed))));
    let (n, done) = (scenes.len(), AtomicUsize::new(0));
    let found: Vec<Found> = Progress::of_share("scenes").shown(&|_| {}, |at| {
        let measured = |(name, class, scenario): &(String, Class, Scenario)| {
            let found = scene::measure(name, *class, scenario);
            at((done.fetch_add(1, Relaxed) + 1) as f64 / n as f64);
            found
        };
        scenes.par_iter().map(measured).collect()
    });
    let report = statistics::report(&found);
    std::fs::write(target.join("calibration.csv"), scene::table(&found)?)?;
    std::fs::write(target.join("calibration.svg"), figure::scatter(&found))?;
    std::fs::write(target.join("figures.txt"), &report)?;
    print!("{report}");
    Ok(())
}

/// Stored scenes that are small enough; those with ants are shortened.
fn stored() -> Result<Vec<(String, Class, Scenario)>, AnyError> {
    let mut scenes = Vec::new();
    for folder in ["analytic", "paper", "stress"] {
        let mut paths: Vec<PathBuf> =
            std::fs::read_dir(Path::new("scenarios").join(folder))?.map(|entry| Ok(entry?.path())).collect::<Result<_, AnyError>>()?;
        paths.sort();
        for path in paths.iter().filter(|path| path.extension().is_some_and(|extension| extension == "json")) {
            let mut scenario = Scenario::read(path)?;
            if scenario.system.springs.len() > MOST_SPRINGS {
                continue;
            }
            if matches!(scenario.drive, Drive::Ants(_)) {
                scenario.duration = scenario.duration.min(LONGEST_ANTS);
            }
            let name = path.file_stem().unwrap_or_default().to_string_lossy();
            scenes.push((format!("{folder}/{name}"), Class::Stored, scenario));
        }
    }
    Ok(scenes)
}
