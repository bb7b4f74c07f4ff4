//! The numbers of a run. [`FACTS`] is the one table from which the JSON of `run`, the columns of a
//! sweep, baselines and comparisons over seeds are made: a new number is one more entry of it.

use serde::Serialize;

use self::Value::{Absent, Count, Flag, Number, Undefined};
use super::Outcome;
use crate::backend::{BackendOptions, PoseError, Status, Tolerance, TransitionCounts};
use crate::math::Summary;
use crate::scenario::Scenario;

/// A finished run, as [`FACTS`] read it.
#[derive(Clone, Copy, Debug)]
pub struct Run<'a> {
    pub scenario: &'a Scenario,
    pub options: &'a BackendOptions,
    pub outcome: &'a Outcome,
    /// Length of the load's path (m), where it was added up.
    pub path_length: Option<f64>,
    /// Real time that the run took (s), where it was measured.
    pub wall_time: Option<f64>,
}

/// One number of a run.
#[derive(Clone, Copy)]
pub struct Fact {
    /// Path in the JSON of `run`, such as `energy.elastic_j`.
    pub name: &'static str,
    /// Name of the column in tables, which ends in the unit. It is empty for a number that only the
    /// JSON of `run` has.
    pub column: &'static str,
    /// One sentence that says what the number is.
    pub meaning: &'static str,
    pub kind: Kind,
    /// Whether every correct build computes the same number up to rounding.
    pub is_reproducible: bool,
    /// Number of pulls without which tables leave the number out.
    least_pulls: u64,
    get: fn(&Run) -> Value,
}

/// Type of the values of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    Number,
    Count,
    Flag,
}

/// Value of a number in one run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Value {
    /// The run has no such number, as a run by rapier has no transitions. JSON leaves the key out.
    Absent,
    /// The number has no value, as the time to a nest that was not reached. JSON has `null`.
    Undefined,
    Number(f64),
    Count(u64),
    Flag(bool),
}

/// Every number of a run, in the order of tables.
pub const FACTS: [Fact; 71] = [
    flag("arrived", "arrived", "Whether the load reached the nest.", |r| r.outcome.arrived.map_or(Absent, Flag)),
    number("time_to_nest_s", "time_to_nest_s", "Time at which the load reached the nest.", time_to_nest),
    number("final.time_s", "time_s", "Time at which the run ended.", |r| Number(r.outcome.time)),
    number("final.position_m[0]", "x_m", "Position of the load along x at the end.", |r| Number(r.outcome.motion.pose.position.x)),
    number("final.position_m[1]", "y_m", "Position of the load along y at the end.", |r| Number(r.outcome.motion.pose.position.y)),
    number("final.heading_rad", "heading_rad", "Heading of the load at the end, whole turns included.", |r| {
        Number(r.outcome.motion.pose.heading)
    }),
    number("final.velocity_m_per_s[0]", "vx_m_per_s", "Velocity of the load along x at the end.", |r| {
        Number(r.outcome.motion.twist.linear.x)
    }),
    number("final.velocity_m_per_s[1]", "vy_m_per_s", "Velocity of the load along y at the end.", |r| {
        Number(r.outcome.motion.twist.linear.y)
    }),
    number("final.turn_rate_rad_per_s", "turn_rate_rad_per_s", "Turn rate of the load at the end.", |r| {
        Number(r.outcome.motion.twist.angular)
    }),
    number("path_length_m", "path_length_m", "Length of the load's path, straight between control instants.", |r| {
        r.path_length.map_or(Absent, Number)
    }),
    number("mean_speed_m_per_s", "mean_speed_m_per_s", "Distance from start to end over the time of the run.", mean_speed),
    number("pull_force_n.mean", "pull_mean_n", "Mean pull at the ants' grasps (zero) and decisions.", |r| r.pulls(|p| Number(p.mean())))
        .of_pulls(1),
    number("pull_force_n.sd", "pull_sd_n", "Standard deviation of these pulls.", |r| r.pulls(|p| Number(p.sd()))).of_pulls(2),
    number("pull_force_n.max", "pull_max_n", "Largest of these pulls.", |r| r.pulls(|p| Number(p.max()))).of_pulls(1),
    count("pull_force_n.n", "n_pulls", "Number of these pulls.", |r| r.pulls(|p| Count(p.n()))),
    number("energy.elastic_j", "elastic_j", "Energy stored in the springs at the end.", |r| Number(r.outcome.energy.elastic)),
    number("energy.kinetic_j", "kinetic_j", "Kinetic energy of the load at the end.", |r| Number(r.outcome.energy.kinetic)),
    number("energy.dissipated_j", "", "Sum of the energies lost to friction, impacts, damping and release.", |r| {
        Number(r.outcome.energy.dissipated())
    }),
    number("energy.friction_j", "friction_j", "Energy lost to friction with the ground.", |r| Number(r.outcome.energy.friction)),
    number("energy.side_friction_j", "side_friction_j", "Energy lost to friction with obstacles.", |r| {
        r.at_obstacles(|o| Number(o.energy.side_friction))
    }),
    number("energy.impact_j", "impact_j", "Energy lost in impacts on obstacles.", |r| r.at_obstacles(|o| Number(o.energy.impacts))),
    number("energy.damping_j", "damping_j", "Energy lost to the damping of springs.", |r| Number(r.outcome.energy.damping)),
    number("energy.released_j", "released_j", "Energy lost with springs that were let go.", |r| Number(r.outcome.energy.released)),
    number("energy.tip_work_j", "tip_work_j", "Work that the tips did on the springs.", |r| Number(r.outcome.energy.tip_work)),
    number("energy.obstacle_work_j", "obstacle_work_j", "Work of moving obstacles on the load.", |r| {
        r.at_obstacles(|o| Number(o.energy.obstacle_work))
    }),
    number("energy.initial_j", "initial_j", "Energy at the start.", |r| Number(r.outcome.energy.initial)),
    number(
        "energy.defect_j",
        "defect_j",
        "Stored and dissipated energy less the work of tips and obstacles and the initial energy.",
        |r| Number(r.outcome.energy.defect()),
    ),
    number("energy.defect_parts.jumps_j", "defect_jumps_j", "Part of the defect from quasi-static jumps.", |r| {
        Number(r.outcome.energy.defect_parts().jumps)
    }),
    number(
        "energy.defect_parts.numerical_damping_j",
        "defect_numerical_damping_j",
        "Part of the defect from the integration method.",
        numerical_damping,
    ),
    number("energy.defect_parts.quadrature_j", "", "Part of the defect from the sums of work.", |r| {
        Number(r.outcome.energy.defect_parts().quadrature)
    }),
    count("transitions.n_slip_onset", "n_slip_onset", "Number of times the load began to slip.", |r| {
        r.transitions(|t| Count(t.n_slip_onset))
    }),
    count("transitions.n_stop", "n_stop", "Number of times the load came to rest.", |r| r.transitions(|t| Count(t.n_stop))),
    count("transitions.n_pinning", "n_pinning", "Number of times one support stopped under a turning load.", |r| {
        r.transitions(|t| Count(t.n_pinning))
    }),
    count("transitions.n_unpinning", "n_unpinning", "Number of times such a support began to slip again.", |r| {
        r.transitions(|t| Count(t.n_unpinning))
    }),
    count("transitions.n_jumps", "n_jumps", "Number of jumps of the quasi-static path.", |r| r.transitions(|t| Count(t.n_jumps))),
    count("transitions.n_uncertain_jumps", "", "Number of jumps whose end depends on what dissipates besides friction.", |r| {
        r.transitions(|t| positive_count(t.n_uncertain_jumps))
    }),
    number("transitions.largest_jump_m", "largest_jump_m", "Largest displacement in a jump.", |r| {
        r.transitions(|t| t.largest_jump.map_or(Absent, Number))
    }),
    count("contacts.n_touch", "n_touch", "Number of times the load touched an obstacle.", |r| {
        r.at_obstacles(|o| Count(o.transitions.n_touch))
    }),
    count("contacts.n_separation", "n_separation", "Number of times the load separated from an obstacle.", |r| {
        r.at_obstacles(|o| Count(o.transitions.n_separation))
    }),
    count("contacts.n_side_stick", "n_side_stick", "Number of times a contact began to stick or to roll.", |r| {
        r.at_obstacles_exactly(|o| Count(o.transitions.n_side_stick))
    }),
    count("contacts.n_side_slip", "n_side_slip", "Number of times a contact began to slide.", |r| {
        r.at_obstacles_exactly(|o| Count(o.transitions.n_side_slip))
    }),
    count("contacts.n_impacts", "n_impacts", "Number of impacts on obstacles.", |r| r.at_obstacles(|o| Count(o.transitions.n_impacts))),
    count("contacts.n_not_unique", "", "Number of times another motion was admissible, if it was.", |r| {
        r.at_obstacles_exactly(|o| positive_count(o.transitions.n_not_unique))
    }),
    count("contacts.n_impacts_by_poisson", "", "Number of impacts by Poisson's law, where Newton's gains energy or has no answer.", |r| {
        r.transitions(|t| if t.n_impacts_by_poisson > 0 { Count(t.n_impacts_by_poisson) } else { Absent })
    }),
    count("contacts.n_impacts_without_law", "", "Number of impacts for which no law has an answer.", |r| {
        r.transitions(|t| if t.n_impacts_without_law > 0 { Count(t.n_impacts_without_law) } else { Absent })
    }),
    number("contacts.residual", "contact_residual", "Largest relative residual of a step with a contact force.", |r| {
        r.at_obstacles_exactly(|o| Number(o.steps.contact_residual))
    })
    .not_reproducible(),
    flag("contacts.forces_unique", "contact_forces_unique", "Whether the contact forces were unique in every step.", |r| {
        r.at_obstacles_exactly(|o| Flag(!o.steps.is_indeterminate))
    }),
    number("accuracy.asked_m", "", "Error of the position that was allowed.", |r| r.accuracy(|asked, _| Number(asked.position_m))),
    number("accuracy.asked_rad", "", "Error of the heading that was allowed.", |r| r.accuracy(|asked, _| Number(asked.heading_rad))),
    number("accuracy.estimated_m", "error_m", "Bound of the error of the position.", |r| r.accuracy(|_, error| Number(error.position))),
    number("accuracy.estimated_rad", "error_rad", "Bound of the error of the heading.", |r| r.accuracy(|_, error| Number(error.heading))),
    flag("accuracy.is_met", "", "Whether the errors are small enough and every step converged.", |r| {
        r.accuracy(|_, _| Flag(r.is_accurate()))
    }),
    number("steps.residual", "residual", "Largest relative residual of a step.", residual).not_reproducible(),
    number("steps.lost_share", "", "Share of the path that single precision lost by rounding, if that is too much.", |r| {
        positive(r.outcome.steps.lost_share)
    }),
    number("steps.gained_share", "", "Energy from nowhere over the energy that went in, if that is too much; negative if lost.", |r| {
        some(r.outcome.steps.gained_share)
    }),
    number("steps.unresolved_rad", "", "Largest angle of the fastest oscillation in a default step, if that is too much.", |r| {
        positive(r.outcome.steps.unresolved_rad)
    }),
    number("steps.doubts.overlap_m", "", "Largest depth of the load inside an obstacle after a step, if it lay inside one.", |r| {
        if r.outcome.steps.doubts.overlap_m == 0.0 { Absent } else { Number(r.outcome.steps.doubts.overlap_m) }
    }),
    count("steps.doubts.n_gate_cuts", "", "Number of steps that were cut because they ended inside an obstacle, if any.", |r| {
        positive_count(r.outcome.steps.doubts.n_gate_cuts)
    }),
    count("steps.doubts.n_not_unique", "", "Number of steps in which another motion was admissible, if any.", |r| {
        positive_count(r.outcome.steps.doubts.n_not_unique)
    }),
    count("steps.n_steps", "n_steps", "Number of steps.", |r| Count(r.outcome.steps.n_steps)),
    count("steps.n_solves", "n_solves", "Number of solves.", |r| Count(r.outcome.steps.n_solves)),
    count("steps.n_iterations", "n_iterations", "Number of iterations of all solves.", |r| Count(r.outcome.steps.n_iterations))
        .not_reproducible(),
    count("steps.n_skipped", "n_skipped", "Number of steps that needed no solve.", |r| Count(r.outcome.steps.n_skipped)),
    count("steps.n_not_converged", "n_not_converged", "Number of steps that did not converge.", |r| Count(r.outcome.steps.n_not_converged)),
    count("steps.n_rejected", "n_rejected", "Number of macro-steps that error control rejected.", |r| Count(r.outcome.steps.n_rejected)),
    number("steps.share_skipped", "", "Skipped steps over all steps.", share_skipped),
    count("steps.skipped.free_load", "", "Number of steps skipped without an attached spring.", |r| {
        Count(r.outcome.steps.skipped.free_load)
    }),
    count("steps.skipped.still_tips", "", "Number of steps skipped while no tip moved.", |r| Count(r.outcome.steps.skipped.still_tips)),
    count("steps.skipped.stick_certificate", "", "Number of steps skipped by a stick certificate.", |r| {
        Count(r.outcome.steps.skipped.stick_certificate)
    }),
    count("steps.skipped.distant_ants", "n_skipped_ants", "Number of ants too far away to sense a tip, over all ticks.", |r| {
        distant_ants(r)
    }),
    number("wall_s", "", "Real time that the run took.", |r| r.wall_time.map_or(Absent, Number)),
];

/// The number with this column.
///
/// # Panics
/// When there is none.
pub fn fact(column: &str) -> &'static Fact {
    FACTS.iter().find(|fact| fact.column == column).unwrap_or_else(|| panic!("no number of a run has the column {column}"))
}

const fn number(name: &'static str, column: &'static str, meaning: &'static str, get: fn(&Run) -> Value) -> Fact {
    Fact { name, column, meaning, kind: Kind::Number, is_reproducible: true, least_pulls: 0, get }
}

const fn count(name: &'static str, column: &'static str, meaning: &'static str, get: fn(&Run) -> Value) -> Fact {
    Fact { kind: Kind::Count, ..number(name, column, meaning, get) }
}

const fn flag(name: &'static str, column: &'static str, meaning: &'static str, get: fn(&Run) -> Value) -> Fact {
    Fact { kind: Kind::Flag, ..number(name, column, meaning, get) }
}

impl Fact {
    const fn of_pulls(self, least_pulls: u64) -> Self {
        Self { least_pulls, ..self }
    }

    const fn not_reproducible(self) -> Self {
        Self { is_reproducible: false, ..self }
    }

    /// The value in a run.
    pub fn value(&self, run: &Run) -> Value {
        (self.get)(run)
    }

    /// The value in a run, as a table has it: a statistic of too few pulls is [`Value::Absent`].
    pub fn in_table(&self, run: &Run) -> Value {
        if run.outcome.pulls.n() < self.least_pulls { Absent } else { self.value(run) }
    }

    /// Unit in print, from the ending of the name; empty for a count or a share.
    pub fn unit(&self) -> &'static str {
        unit_of(if self.column.is_empty() { self.name } else { self.column })
    }
}

/// Unit in print of a name that ends in it; empty for a count or a share.
pub fn unit_of(name: &str) -> &'static str {
    split_unit(name).1
}

/// Endings of names and keys, and their units in print; an ending precedes those that it ends in.
const UNITS: [(&str, &str); 18] = [
    ("_nm_per_rad", "N m/rad"),
    ("_rad_per_s", "rad/s"),
    ("_m_per_s2", "m/s^2"),
    ("_kg_per_m2", "kg/m^2"),
    ("_m_per_s", "m/s"),
    ("_n_per_m", "N/m"),
    ("_kg_m2", "kg m^2"),
    ("_per_s", "1/s"),
    ("_per_n", "1/N"),
    ("_rad", "rad"),
    ("_kg", "kg"),
    ("_m2", "m^2"),
    ("_nm", "N m"),
    ("_hz", "Hz"),
    ("_m", "m"),
    ("_j", "J"),
    ("_n", "N"),
    ("_s", "s"),
];

/// Name without the unit that it ends in, and that unit in print: `pull_mean` and `N` of
/// `pull_mean_n`.
pub fn split_unit(name: &str) -> (&str, &'static str) {
    UNITS.iter().find_map(|(ending, unit)| Some((name.strip_suffix(ending)?, *unit))).unwrap_or((name, ""))
}

impl Value {
    /// The value as a real number: a count as it is, a flag as 0 or 1.
    pub fn as_number(self) -> Option<f64> {
        match self {
            Absent | Undefined => None,
            Number(value) => Some(value),
            Count(value) => Some(value as f64),
            Flag(value) => Some(f64::from(u8::from(value))),
        }
    }
}

impl Run<'_> {
    /// Whether error control kept the error as small as asked for, with steps that all converged;
    /// `true` without error control.
    pub fn is_accurate(&self) -> bool {
        let is_known = self.outcome.steps.status == Status::Converged;
        self.options.tolerance.zip(self.outcome.error).is_none_or(|(asked, error)| is_known && asked.allows(&error))
    }

    fn pulls(&self, get: fn(&Summary) -> Value) -> Value {
        if self.outcome.arrived.is_some() { get(&self.outcome.pulls) } else { Absent }
    }

    /// A number of a scene with obstacles.
    fn at_obstacles(&self, get: fn(&Outcome) -> Value) -> Value {
        if self.scenario.system.world.is_empty() { Absent } else { get(self.outcome) }
    }

    /// A number of a scene with obstacles that an engine does not compute.
    fn at_obstacles_exactly(&self, get: fn(&Outcome) -> Value) -> Value {
        if self.options.kind.is_exact() { self.at_obstacles(get) } else { Absent }
    }

    /// An engine does not report transitions of the load on the ground.
    fn transitions(&self, get: fn(&TransitionCounts) -> Value) -> Value {
        if self.options.kind.is_exact() { get(&self.outcome.transitions) } else { Absent }
    }

    fn accuracy(&self, get: impl Fn(&Tolerance, &PoseError) -> Value) -> Value {
        self.options.tolerance.zip(self.outcome.error).map_or(Absent, |(asked, error)| get(&asked, &error))
    }
}

fn some(value: f64) -> Value {
    if value == 0.0 { Absent } else { Number(value) }
}

fn positive(value: f64) -> Value {
    if value > 0.0 { Number(value) } else { Absent }
}

fn positive_count(count: u64) -> Value {
    if count > 0 { Count(count) } else { Absent }
}

fn time_to_nest(run: &Run) -> Value {
    run.outcome.arrived.map_or(Absent, |arrived| if arrived { Number(run.outcome.time) } else { Undefined })
}

fn mean_speed(run: &Run) -> Value {
    let travelled = (run.outcome.motion.pose.position - run.scenario.start.pose.position).norm();
    if run.outcome.time > 0.0 { Number(travelled / run.outcome.time) } else { Absent }
}

fn numerical_damping(run: &Run) -> Value {
    Number(run.outcome.energy.defect_parts().numerical_damping)
}

/// A failed step may have no finite residual.
fn residual(run: &Run) -> Value {
    let steps = &run.outcome.steps;
    if steps.status == Status::Failed && !steps.residual.is_finite() { Undefined } else { Number(steps.residual) }
}

fn share_skipped(run: &Run) -> Value {
    Number(run.outcome.steps.n_skipped as f64 / run.outcome.steps.n_steps.max(1) as f64)
}

fn distant_ants(run: &Run) -> Value {
    Count(run.outcome.steps.skipped.distant_ants)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Names and columns are keys, and a meaning is one sentence.
    #[test]
    fn every_number_has_its_own_name_and_a_sentence() {
        for (at, fact) in FACTS.iter().enumerate() {
            let before = &FACTS[..at];
            assert!(before.iter().all(|other| other.name != fact.name), "{}", fact.name);
            assert!(fact.column.is_empty() || before.iter().all(|other| other.column != fact.column), "{}", fact.column);
            assert!(fact.meaning.ends_with('.') && fact.meaning.matches(". ").count() == 0, "{}", fact.name);
        }
    }
}
