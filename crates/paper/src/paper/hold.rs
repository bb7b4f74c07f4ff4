//! How likely an attachment to a load at rest lasts until its pull moves the load.
//!
//! One ant moves the load only with a pull of mu m g. At the pulling speed v its spring gains
//! kappa_rho v a second, so that the attachment has to outlast mu m g / (kappa_rho v).

use cohaul::model::behaviour::ReleasePace;
use cohaul::scenario::{AntDrive, Drive, Scenario};

/// Chance that a pull along a spring of a load at rest reaches the friction limit of the load (1),
/// from decisions as the ants of the scenario make them; `None` without ants or springs.
pub fn chance_to_move(scenario: &Scenario) -> Option<f64> {
    let Drive::Ants(ants) = &scenario.drive else { return None };
    let spring = scenario.system.springs.first()?;
    let rate = spring.radial_stiffness * ants.pull_speed;
    Some(chance(ants, rate, scenario.system.total_slip_limit(), scenario.control_period))
}

/// The same for a pull that grows at a `rate` (N/s) to a `limit` (N), in control periods of this
/// length (s).
fn chance(ants: &AntDrive, rate: f64, limit: f64, control_period: f64) -> f64 {
    let law = &ants.release;
    let every = if ants.release_pace == ReleasePace::Aged { law.period } else { control_period };
    let mut lasts = 1.0;
    for at in 1u32.. {
        let pull = rate * every * f64::from(at);
        // Not a number does not go on for ever.
        if pull >= limit || pull.is_nan() || lasts < 1e-12 {
            break;
        }
        lasts *= match ants.release_pace {
            ReleasePace::Hazard => (-law.hazard(pull) * control_period).exp(),
            ReleasePace::Aged | ReleasePace::PerTick => 1.0 - law.probability(pull),
        };
    }
    lasts
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::paper::{Case, Trial};
    use cohaul::backend::{BackendKind, BackendOptions};
    use cohaul::scenario::presets::Preset;
    use cohaul::simulation::{EventKind, Keep, Simulation};

    /// Attachments of one ant in whole runs with a load too heavy to move, against the chance. A
    /// pull that began across its spring grows differently, so that the two agree to a few percent.
    #[test]
    fn attachments_of_runs_last_as_often() {
        for preset in [Preset::Paper, Preset::Aged] {
            let case = Case::new(preset, BackendKind::QuasiStatic);
            let chance = chance_to_move(&Trial::OneOne.scenario(&case, 1)).unwrap();
            let (mut n, mut n_lasting) = (0.0, 0.0);
            for seed in 1..9 {
                let mut scenario = Trial::OneOne.scenario(&case, seed);
                scenario.duration = 250.0;
                let limit = scenario.system.total_slip_limit();
                scenario.system.ground.supports.iter_mut().for_each(|support| support.normal_load *= 100.0);
                let options = BackendOptions::new(BackendKind::QuasiStatic, scenario.control_period);
                let mut run = Simulation::new(&scenario, &options, Keep::Trace);
                run.run(|_| true);
                let (trace, _) = run.into_results();
                let times = |kind| trace.events.iter().filter(move |event| event.kind == kind).map(|event| event.time);
                for (from, to) in times(EventKind::Grasp).zip(times(EventKind::Release)) {
                    let [first, end] = [from, to].map(|time| trace.rows.partition_point(|row| row.time < time));
                    let tips = trace.rows[first..end].iter().flat_map(|row| row.tips.iter());
                    let largest = tips.map(|tip| tip.pull.norm()).fold(0.0, f64::max);
                    n += 1.0;
                    n_lasting += if largest >= limit { 1.0 } else { 0.0 };
                }
            }
            let share: f64 = n_lasting / n;
            // Three standard errors, and a fifth for the shape of the pulls.
            let error = 3.0 * (chance * (1.0 - chance) / n).sqrt() + 0.2 * chance;
            assert!(n > 1000.0 && (share - chance).abs() < error, "{preset:?}: {share} of {n}, {chance}");
        }
    }
}
