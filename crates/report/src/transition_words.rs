//! Transitions and triggers in plain words.

use crate::quantity::of_run::{is_rounding, short_quantity};
use cohaul::analysis::ByTrigger;
use cohaul::backend::{ImpactLaw, TransitionKind};
use cohaul::model::World;

/// What an inertia effect is attributed to.
pub const ATTRIBUTION: &str = "the last disturbance that was at least as large as the oscillation that it met";

/// Parts of an inertia effect by trigger; `None` if there are none.
pub fn by_trigger(triggers: &ByTrigger) -> Option<String> {
    let parts =
        triggers.named().filter(|(_, part)| !is_rounding(*part)).map(|(name, part)| format!("{name} {}", short_quantity(part, "m")));
    let parts = parts.collect::<Vec<_>>();
    (!parts.is_empty()).then(|| parts.join(", "))
}

/// What the load did, as the end of a sentence that begins with the load. Obstacles have the names
/// of the `world`.
pub fn in_words(kind: &TransitionKind, world: &World) -> String {
    let name = kind.obstacle().and_then(|obstacle| world.obstacles.get(obstacle)).map_or("an obstacle", |obstacle| &obstacle.name);
    match kind {
        TransitionKind::SlipOnset => "slip onset".to_owned(),
        TransitionKind::Stop => "stop".to_owned(),
        TransitionKind::Pinning { support } => format!("pinning to support {support}"),
        TransitionKind::Unpinning { support } => format!("unpinning from support {support}"),
        TransitionKind::Touch { .. } => format!("touches {name}"),
        TransitionKind::Separation { .. } => format!("separates from {name}"),
        TransitionKind::SideStick { .. } => format!("begins to stick to {name}, or to roll on it"),
        TransitionKind::SideSlip { .. } => format!("begins to slide along {name}"),
        TransitionKind::Impact { energy, law, .. } => hit(name, *energy, *law),
        TransitionKind::NotUnique { .. } => format!("may move otherwise from here on at {name}: the motion is not unique"),
        TransitionKind::Squeeze { .. } => format!("is pressed into {name}: no step keeps it out"),
        TransitionKind::Jump { shift, .. } => format!("jump of {}", short_quantity(*shift, "m")),
    }
}

/// An impact with its loss (J), and the law that it follows where that is not Newton's.
fn hit(name: &str, loss: f64, law: ImpactLaw) -> String {
    let told = format!("hits {name} and loses {}", short_quantity(loss, "J"));
    match law {
        ImpactLaw::Newton | ImpactLaw::Engine => told,
        ImpactLaw::Poisson => format!("{told} by Poisson's law"),
        ImpactLaw::None => format!("hits {name}, and no law of impacts has an answer"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use cohaul::math::Pose;
    use cohaul::model::{Obstacle, ObstaclePath, Outline};

    #[test]
    fn a_trigger_of_rounding_alone_is_left_out() {
        let triggers = ByTrigger { jumps_m: 9e-13, driving_m: 2e-3, ..ByTrigger::default() };
        assert_eq!(by_trigger(&triggers).as_deref(), Some("driving 2 mm"));
        assert_eq!(by_trigger(&ByTrigger { jumps_m: 9e-13, ..ByTrigger::default() }), None);
    }

    #[test]
    fn contacts_are_told_with_the_name_of_the_obstacle() {
        let path = ObstaclePath::fixed(Pose::new(0.0, 0.0, 0.0));
        let post = Obstacle { name: "left post".into(), outline: Outline::disc(0.005), friction_coefficient: 0.0, restitution: 0.0, path };
        let world = World { outline: Outline::disc(0.0122), obstacles: vec![post] };
        assert_eq!(in_words(&TransitionKind::Touch { obstacle: 0 }, &world), "touches left post");
        assert_eq!(in_words(&TransitionKind::Squeeze { obstacle: 0 }, &world), "is pressed into left post: no step keeps it out");
        let hit = |law| in_words(&TransitionKind::Impact { obstacle: 0, energy: 7.17e-5, law }, &world);
        assert_eq!(hit(ImpactLaw::Newton), "hits left post and loses 71.7 µJ");
        assert_eq!(hit(ImpactLaw::Poisson), "hits left post and loses 71.7 µJ by Poisson's law");
        assert_eq!(hit(ImpactLaw::None), "hits left post, and no law of impacts has an answer");
    }
}
