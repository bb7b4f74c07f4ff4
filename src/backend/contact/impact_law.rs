//! The laws of an impact: the velocity after impulses at closed contacts.
//!
//! ```text
//! minimise over v    1/2 |v - v_before|^2_M    with    n.(v - v_o) >= -e n.(v_before - v_o)
//! ```
//!
//! with Coulomb's law for the impulses along the surface. v_o is the velocity of the obstacle at
//! the load, e the coefficient of restitution. The ground's friction is bounded and gives no
//! impulse. This is Newton's law in Moreau's form. With side friction it may gain energy, and with
//! two contacts it may have no answer.
//!
//! There Poisson's law is used: the impulses p of the plastic impact, whose answer always exists
//! unless the obstacles squeeze the load, are scaled by 1 + e. It never gains energy. Gaps grow at
//! the rates g and slips at s, before (-) and after (+) the plastic impact, of which D is the
//! change of velocity:
//!
//! ```text
//! loss(1 + e) = (1 + e) a - (1 + e)^2 b / 2    a = -sum p g- + tau s-    b = |D|^2_M = sum p (g+ - g-) + tau (s+ - s-)
//! a - b = -sum p g+ + tau s+ >= 0               by p g+ = 0 and tau s+ <= 0
//! ```
//!
//! so that the loss is at least (1 + e) (1 - e) b / 2.

use nalgebra::Vector3;

use super::solve::{ContactRow, ContactSolution, ContactSystem, Ending, PerContact, SideForce, solve_contacts};
use crate::backend::friction::FrictionSolver;
use crate::backend::numerics::{CLOSED_SPEED, GAINED_ENERGY, POISSON_IMPACTS};
use crate::backend::report::ImpactLaw;
use crate::math::{Mat3, Vec3};
use crate::model::Ground;

/// A closed contact in an impact, for velocities relative to one obstacle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Struck {
    /// Rates of gap and slip, as functions of the load's velocity (m/s).
    pub row: ContactRow,
    /// Coefficient of restitution; zero for a contact that does not rebound (1).
    pub restitution: f64,
}

impl Struck {
    /// Rate of the gap at a velocity of the load (m/s).
    pub fn rate(&self, twist: &Vec3) -> f64 {
        self.row.gap + self.row.normal.dot(twist)
    }

    /// The row whose gap must not be negative: that of the end, or with a rebound.
    fn with_rebound(&self, rebounds: bool, before: &Vec3) -> ContactRow {
        let rebound = if rebounds { self.restitution * self.rate(before).min(0.0) } else { 0.0 };
        ContactRow { gap: self.row.gap + rebound, ..self.row }
    }
}

/// Velocity after an impact, relative to the same obstacle as before it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rebound {
    /// (m/s, m/s, rad/s; load axes)
    pub after: Vec3,
    /// Work of the obstacles that move relative to that one (J).
    pub work: f64,
    pub law: ImpactLaw,
}

/// The impact of a load of this `mass` matrix (kg, kg, kg m^2) and `radius` (m) with the velocity
/// `before` (m/s, m/s, rad/s; load axes).
pub fn rebound(mass: &Mat3, radius: f64, struck: &[Struck], before: &Vec3) -> Rebound {
    let mut impact = Impact { mass, struck, solver: FrictionSolver::new(&WITHOUT_FRICTION, radius), speed: speed(before, radius) };
    impact.newton(before).or_else(|| impact.poisson(before)).unwrap_or(Rebound { after: *before, work: 0.0, law: ImpactLaw::None })
}

/// The ground gives no impulse.
pub const WITHOUT_FRICTION: Ground = Ground { friction_coefficient: 0.0, supports: Vec::new() };

/// Speed of the edge of a load of this `radius` (m), or more (m/s).
pub fn speed(twist: &Vector3<f64>, radius: f64) -> f64 {
    twist.xy().norm() + radius * twist.z.abs()
}

struct Impact<'a> {
    mass: &'a Mat3,
    struck: &'a [Struck],
    solver: FrictionSolver,
    /// Speed of the edge before the impact (m/s).
    speed: f64,
}

impl Impact<'_> {
    fn newton(&mut self, before: &Vec3) -> Option<Rebound> {
        let answer = self.solved(before, true)?;
        let work = self.work(&answer.forces, 1.0);
        let is_gain = self.loss(before, &answer.increment, work) < -GAINED_ENERGY * (self.energy(before) + work.abs());
        (!is_gain).then_some(Rebound { after: answer.increment, work, law: ImpactLaw::Newton })
    }

    fn poisson(&mut self, before: &Vec3) -> Option<Rebound> {
        let plastic = self.solved(before, false)?;
        let pushes = self.struck.iter().zip(&plastic.forces).filter(|(_, impulse)| impulse.normal > 0.0);
        let scale = 1.0 + pushes.map(|(struck, _)| struck.restitution).fold(0.0, f64::max);
        let mut after = before + scale * (plastic.increment - before);
        let mut work = self.work(&plastic.forces, scale);
        for _ in 0..POISSON_IMPACTS {
            if !self.approaches(&after) {
                return Some(Rebound { after, work, law: ImpactLaw::Poisson });
            }
            let next = self.solved(&after, false)?;
            (after, work) = (next.increment, work + self.work(&next.forces, 1.0));
        }
        None
    }

    /// Velocity and impulses, with restitution or of the plastic impact; `None` where there are
    /// none.
    fn solved(&mut self, before: &Vec3, rebounds: bool) -> Option<ContactSolution> {
        let rows: PerContact<ContactRow> = self.struck.iter().map(|struck| struck.with_rebound(rebounds, before)).collect();
        let drive = self.mass * before;
        let answer = solve_contacts(&ContactSystem { hessian: self.mass, drive: &drive, rows: &rows }, &mut self.solver, None);
        (answer.ending == Ending::Converged).then_some(answer)
    }

    fn approaches(&self, twist: &Vec3) -> bool {
        self.struck.iter().any(|struck| struck.rate(twist) < -CLOSED_SPEED * self.speed)
    }

    fn energy(&self, twist: &Vec3) -> f64 {
        0.5 * twist.dot(&(self.mass * twist))
    }

    /// Energy that an impact loses (J).
    fn loss(&self, before: &Vec3, after: &Vec3, work: f64) -> f64 {
        self.energy(before) - self.energy(after) + work
    }

    /// Work of the scaled impulses (J), as the obstacle sees it that velocities are relative to:
    /// each other obstacle moves with the rates that gap and slip have for a load that does not.
    fn work(&self, impulses: &[SideForce], scale: f64) -> f64 {
        let of = |(Struck { row, .. }, impulse): (&Struck, &SideForce)| -(impulse.normal * row.gap + impulse.tangential * row.slip);
        scale * self.struck.iter().zip(impulses).map(of).sum::<f64>()
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;
    use std::f64::consts::{PI, TAU};

    use super::*;
    use crate::math::{RandomStreams, Stream, Vec2, direction, perpendicular};
    use crate::model::support::wrench_of;

    /// A load that hits one or two obstacles.
    struct Scene {
        mass: Mat3,
        radius: f64,
        struck: PerContact<Struck>,
        before: Vec3,
    }

    impl Scene {
        fn rebound(&self) -> Rebound {
            rebound(&self.mass, self.radius, &self.struck, &self.before)
        }

        fn energy(&self, twist: &Vec3) -> f64 {
            0.5 * twist.dot(&(self.mass * twist))
        }

        /// Energy that is lost, over that before the impact (1).
        fn loss(&self, rebound: &Rebound) -> f64 {
            1.0 - (self.energy(&rebound.after) - rebound.work) / self.energy(&self.before)
        }
    }

    fn struck(point: Vec2, normal: Vec2, friction_coefficient: f64, restitution: f64) -> Struck {
        let [normal, tangent] = [normal, perpendicular(&normal)].map(|along| wrench_of(&point, &along));
        Struck { row: ContactRow { normal, tangent, gap: 0.0, slip: 0.0, friction_coefficient }, restitution }
    }

    /// Contacts beside each other, with normals that differ by up to a right angle and a half. The
    /// load hits both of them, or the second one while it slides or rests on the first.
    fn two_contacts(seed: u64) -> Scene {
        let streams = RandomStreams::new(seed);
        let draw = |n: u64| streams.uniform(Stream::Scene, 0, n);
        let (mass, radius) = (1.6e-3 * 10f64.powf(3.0 * draw(0)), 0.0122 * 10f64.powf(2.0 * draw(1)));
        let inertia = mass * radius * radius * (0.1 + 0.9 * draw(2));
        let (first, between) = (TAU * draw(3), 0.75 * PI * draw(4));
        let (friction, restitution) = (1.5 * draw(5), draw(6));
        let contact = |angle: f64, n: u64| {
            let outward = direction(angle);
            let point = radius * (0.3 + 0.7 * draw(n)) * direction(angle + 0.8 * (draw(n + 1) - 0.5));
            struck(point, -outward, friction, restitution)
        };
        let rows: PerContact<Struck> = [contact(first, 7), contact(first + between, 9)].into_iter().collect();
        let towards = direction(first + between * draw(11));
        let mut before = towards.push((draw(12) - 0.5) * 2.0 / radius);
        if draw(13) < 0.5 {
            let Struck { row, .. } = &rows[0];
            before -= row.normal.dot(&before) / row.normal.norm_squared() * row.normal;
        }
        Scene { mass: Mat3::from_diagonal(&Vec3::new(mass, mass, inertia)), radius, struck: rows, before }
    }

    /// Share of the laws in impacts with an approach. None of them gains energy, and after all of
    /// them no contact approaches.
    fn shares(n_scenes: u64) -> BTreeMap<ImpactLaw, f64> {
        let mut counts = BTreeMap::new();
        for seed in 0..n_scenes {
            let scene = two_contacts(seed);
            let found = scene.rebound();
            if scene.struck.iter().all(|struck| struck.rate(&scene.before) >= 0.0) {
                assert!(speed(&(found.after - scene.before), scene.radius) <= 1e-12 * speed(&scene.before, scene.radius), "{seed}");
                continue;
            }
            *counts.entry(found.law).or_insert(0.0) += 1.0;
            // The solver finds velocities to 1e-12 of the largest one.
            assert!(scene.loss(&found) >= -1e-10, "{seed}: {found:?} gains {:e}", -scene.loss(&found));
            let approaches = scene.struck.iter().any(|struck| struck.rate(&found.after) < -1e-8 * speed(&scene.before, scene.radius));
            assert!(found.law == ImpactLaw::None || !approaches, "{seed}: {found:?}");
        }
        let sum: f64 = counts.values().sum();
        counts.values_mut().for_each(|count| *count /= sum);
        counts
    }

    /// Newton's law has no answer, or one that gains energy, in some impacts on two rough
    /// obstacles. Poisson's law then has one.
    #[test]
    fn an_impact_on_two_rough_obstacles_has_an_answer_and_gains_no_energy() {
        let shares = shares(10_000);
        assert!(!shares.contains_key(&ImpactLaw::None), "{shares:?}");
        assert!(shares[&ImpactLaw::Newton] > 0.7 && shares[&ImpactLaw::Poisson] > 0.001, "{shares:?}");
    }

    /// A smooth impact at one point loses m (1 - e^2) u^2 / 2, with the speed u of approach and the
    /// mass m that the point feels.
    #[test]
    fn an_impact_at_a_smooth_point_loses_what_restitution_leaves() {
        for restitution in [0.0, 0.4, 1.0] {
            let (mass, inertia, arm) = (2.0, 0.03, 0.1);
            let scene = Scene {
                mass: Mat3::from_diagonal(&Vec3::new(mass, mass, inertia)),
                radius: 0.2,
                struck: [struck(Vec2::new(0.1, arm), Vec2::new(-1.0, 0.0), 0.0, restitution)].into_iter().collect(),
                before: Vec3::new(0.5, 0.3, 1.0),
            };
            let found = scene.rebound();
            let (approach, felt) = (0.5 - arm, 1.0 / (1.0 / mass + arm * arm / inertia));
            let loss = 0.5 * felt * (1.0 - restitution * restitution) * approach * approach / scene.energy(&scene.before);
            assert!((scene.loss(&found) - loss).abs() < 1e-12, "{restitution}: {found:?}");
            assert_eq!(found.law, ImpactLaw::Newton);
        }
    }

    /// A disc that slides at a rough wall without turning: friction takes mu (1 + e) times the
    /// normal speed, until the disc rolls with 1 / (1 + m r^2 / I) of the tangential one.
    #[test]
    fn friction_of_an_impact_slides_or_rolls() {
        let (mass, radius) = (1.0, 0.1);
        for (friction, along) in [(0.1, 1.0 - 0.1 * 1.5 * 2.0), (5.0, 2.0 / 3.0)] {
            let scene = Scene {
                mass: Mat3::from_diagonal(&Vec3::new(mass, mass, 0.5 * mass * radius * radius)),
                radius,
                struck: [struck(Vec2::new(0.0, -radius), Vec2::new(0.0, 1.0), friction, 0.5)].into_iter().collect(),
                before: Vec3::new(1.0, -2.0, 0.0),
            };
            let found = scene.rebound();
            assert!((found.after.xy() - Vec2::new(along, 1.0)).norm() < 1e-12, "{friction}: {found:?}");
        }
    }

    /// Obstacles that come together squeeze the load: nothing ends both approaches.
    #[test]
    fn an_impact_between_obstacles_that_come_together_has_no_law() {
        let [mut one, other] = [1.0, -1.0].map(|side| struck(Vec2::new(0.1 * side, 0.0), Vec2::new(-side, 0.0), 0.3, 0.5));
        one.row.gap = -0.5;
        let scene =
            Scene { mass: Mat3::identity(), radius: 0.1, struck: [one, other].into_iter().collect(), before: Vec3::new(0.2, 0.0, 0.0) };
        assert_eq!(scene.rebound(), Rebound { after: scene.before, work: 0.0, law: ImpactLaw::None });
    }
}
