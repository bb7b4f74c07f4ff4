//! Hook that records what a backend does at every step.

use cohaul::backend::{Backend, Hook, Motion, Shared, Status, StepReport, Wrapped};
use cohaul::math::{Pose, Vec2, rotation};
use cohaul::model::{PolarSpring, System};

#[derive(Clone, Debug, Default)]
pub struct Seen {
    /// Steps of the scene, each an advance.
    pub n_advances: u64,
    pub report: StepReport,
    /// Name of the first number that was not finite, and its step.
    pub not_finite: Option<String>,
    /// The first tip that was not where it was sent.
    pub misplaced: Option<String>,
    /// Largest sum of elastic and kinetic energy (J).
    pub peak_energy: f64,
    /// Largest force of a spring (N).
    pub peak_force: f64,
    /// Shortest distance of a tip from its root within a step, over the rest length (1); infinite
    /// without springs that have one.
    pub shortest: f64,
    /// Largest swing (rad).
    pub swing: f64,
    /// Whether the energy of some spring was not convex at the position of its tip.
    pub left_convex: bool,
    /// Fastest oscillation of the load on its attached springs, in translation or turning (rad/s).
    pub rate: f64,
    /// Largest displacement of a tip in one step, over the rest length of its spring or the radius
    /// of the load (1).
    pub tip_way: f64,
    /// Largest displacement (over the radius, 1) and turn (rad) of the load in one step, and
    /// largest speed of its edge (m/s).
    pub step_way: f64,
    pub step_turn: f64,
    pub speed: f64,
    /// Largest displacements from the start (m): along x, across it, and of the edge; and largest
    /// distance of the load from the origin of the world (m).
    pub along: f64,
    pub across: f64,
    pub rim: f64,
    pub farthest: f64,
}

pub struct Observer {
    system: System,
    start: Pose,
    swings: Vec<f64>,
    seen: Shared<Seen>,
}

impl Observer {
    /// The backend with an observer around it, and what the observer sees.
    pub fn around(inside: Box<dyn Backend>, system: &System) -> (Box<dyn Backend>, Shared<Seen>) {
        let seen = Shared::new(Seen { shortest: f64::INFINITY, ..Seen::default() });
        let (start, swings) = (inside.motion().pose, vec![0.0; system.springs.len()]);
        let hook = Self { system: system.clone(), start, swings, seen: seen.clone() };
        (Box::new(Wrapped { inside, hook }), seen)
    }

    /// Tip from root in the frame of the spring's bearing (m), for each attached spring.
    fn shapes(&self, inside: &dyn Backend) -> Vec<Option<Vec2>> {
        let pose = inside.motion().pose;
        let shape = |(at, spring): (usize, &PolarSpring)| {
            let tip = inside.tip(at)?;
            let in_load = rotation(pose.heading).tr_mul(&(tip - pose.position));
            Some(rotation(spring.bearing).tr_mul(&(in_load - spring.root)))
        };
        self.system.springs.iter().enumerate().map(shape).collect()
    }

    fn pulls(&self, inside: &dyn Backend) -> Vec<Vec2> {
        (0..self.system.springs.len()).map(|at| inside.pull(at)).collect()
    }

    fn tips(&self, inside: &dyn Backend) -> Vec<Option<Vec2>> {
        (0..self.system.springs.len()).map(|at| inside.tip(at)).collect()
    }

    fn see_springs(&mut self, inside: &dyn Backend, seen: &mut Seen, before: &[Option<Vec2>]) {
        let (mut linear, mut angular) = (0.0, 0.0);
        for (at, (after, before)) in self.shapes(inside).iter().zip(before).enumerate() {
            let (Some(after), Some(before)) = (after, before) else { continue };
            let spring = &self.system.springs[at];
            let shape = spring.shape(&Pose::new(0.0, 0.0, 0.0), &(spring.root + rotation(spring.bearing) * after), self.swings[at]);
            self.swings[at] = shape.swing;
            let (radial, torsional) = spring.stiffness_at(shape.length);
            let stiffness = radial.max(if torsional > 0.0 { torsional / shape.length.powi(2) } else { 0.0 });
            linear += stiffness;
            angular += stiffness * (spring.root + rotation(spring.bearing) * after).norm_squared();
            if spring.rest_length > 0.0 {
                seen.shortest = seen.shortest.min(closest(before, after) / spring.rest_length);
                seen.swing = seen.swing.max(shape.swing.abs());
                seen.left_convex |= !is_convex(spring, shape.length, shape.swing);
            }
        }
        let load = &self.system.load;
        seen.rate = seen.rate.max((linear / load.mass).max(angular / load.inertia).sqrt());
    }

    fn see_load(&self, inside: &dyn Backend, seen: &mut Seen, before: &Pose) {
        let Motion { pose: Pose { position, heading }, twist } = inside.motion();
        let radius = self.system.load.radius;
        seen.step_way = seen.step_way.max((position - before.position).norm() / radius);
        seen.step_turn = seen.step_turn.max((heading - before.heading).abs());
        seen.speed = seen.speed.max(twist.edge_speed(radius));
        let (shift, turn) = (position - self.start.position, self.system.load.radius * (heading - self.start.heading).abs());
        seen.along = seen.along.max(shift.x.abs());
        seen.across = seen.across.max(shift.y.abs() + turn);
        seen.rim = seen.rim.max(shift.norm() + turn);
        seen.farthest = seen.farthest.max(position.norm());
        let energy = inside.energy();
        seen.peak_energy = seen.peak_energy.max(energy.elastic + energy.kinetic);
    }

    /// Name of the first number of the backend that is not finite.
    fn not_finite(&self, inside: &dyn Backend, report: &StepReport) -> Option<String> {
        let Motion { pose, twist } = inside.motion();
        let energy = inside.energy();
        let numbers = [
            ("x", pose.position.x),
            ("y", pose.position.y),
            ("heading", pose.heading),
            ("velocity along x", twist.linear.x),
            ("velocity along y", twist.linear.y),
            ("turn rate", twist.angular),
            ("elastic energy", energy.elastic),
            ("kinetic energy", energy.kinetic),
            ("friction loss", energy.friction),
            ("damping loss", energy.damping),
            ("released energy", energy.released),
            ("work of the tips", energy.tip_work),
            ("energy at the start", energy.initial),
            ("energy of jumps", energy.jumps),
            ("numerical damping", energy.numerical_damping),
            ("defect", energy.defect()),
            ("residual", report.residual),
        ];
        let of_tips = |forces: Vec<Vec2>, name: &str| {
            forces.iter().position(|force| !(force.x.is_finite() && force.y.is_finite())).map(|at| format!("{name} {at}"))
        };
        let single = numbers.iter().find(|(_, value)| !value.is_finite()).map(|(name, _)| (*name).to_owned());
        let error = inside.pose_error().filter(|error| !(error.position.is_finite() && error.heading.is_finite()));
        single
            .or_else(|| of_tips(self.pulls(inside), "force on tip"))
            .or_else(|| of_tips(self.tips(inside).into_iter().flatten().collect(), "position of attached tip"))
            .or_else(|| of_tips(inside.friction_forces(), "friction force on support"))
            .or_else(|| error.map(|_| "error of the pose".to_owned()))
    }
}

/// Distance of the segment from `a` to `b` from the origin.
fn closest(a: &Vec2, b: &Vec2) -> f64 {
    let way = b - a;
    let share = if way.norm_squared() > 0.0 { (-a.dot(&way) / way.norm_squared()).clamp(0.0, 1.0) } else { 0.0 };
    (a + share * way).norm()
}

/// Whether both principal minors of H_d (see `model::spring`) are positive.
fn is_convex(spring: &PolarSpring, length: f64, swing: f64) -> bool {
    let [along, across, between] = spring.polar_stiffness(length, swing);
    along * across > between.powi(2)
}

impl Hook for Observer {
    fn attach(&mut self, inside: &mut dyn Backend, spring: usize, tip: Vec2) {
        self.swings[spring] = 0.0;
        inside.attach(spring, tip);
        let (shapes, seen) = (self.shapes(inside), self.seen.clone());
        self.see_springs(inside, &mut seen.borrow(), &shapes);
    }

    fn advance(&mut self, inside: &mut dyn Backend, tip_targets: &[Vec2], duration: f64) -> StepReport {
        let (shapes, tips, before) = (self.shapes(inside), self.tips(inside), inside.motion().pose);
        let report = inside.advance(tip_targets, duration);
        let seen = self.seen.clone();
        let seen = &mut *seen.borrow();
        seen.report.add(&report);
        seen.n_advances += 1;
        let step = seen.n_advances;
        for (at, tip) in tips.iter().enumerate() {
            let Some(tip) = tip else { continue };
            let (way, spring) = (tip_targets[at] - tip, &self.system.springs[at]);
            let size = if spring.rest_length > 0.0 { spring.rest_length } else { self.system.load.radius };
            seen.peak_force = seen.peak_force.max(inside.pull(at).norm());
            seen.tip_way = seen.tip_way.max(way.norm() / size);
            if inside.tip(at) != Some(tip_targets[at]) && report.status != Status::Failed && seen.misplaced.is_none() {
                seen.misplaced = Some(format!("tip {at} is not where it was sent at step {step}"));
            }
        }
        self.see_springs(inside, seen, &shapes);
        self.see_load(inside, seen, &before);
        if seen.not_finite.is_none() {
            seen.not_finite = self.not_finite(inside, &report).map(|what| format!("{what} at step {step}"));
        }
        report
    }
}
