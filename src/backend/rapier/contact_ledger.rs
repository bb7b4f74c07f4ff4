//! Energy and transitions of contacts with obstacles.

use serde::{Deserialize, Serialize};

use super::step::Step;
use crate::backend::numerics::N_IMPACT_STEPS;
use crate::backend::report::{EnergyLedger, ImpactLaw, TransitionKind};

/// What the last steps found at one obstacle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Touch {
    /// Number of steps since the load touched the obstacle, up to [`N_IMPACT_STEPS`].
    n_steps: u8,
    /// Energy lost since then, as long as it counts as an impact (J).
    energy: f64,
    /// Whether the load has bounced off since then.
    #[serde(default)]
    has_bounced: bool,
}

impl Touch {
    pub fn is_closed(&self) -> bool {
        self.n_steps > 0
    }
}

/// Adds the losses and the work at the contacts of `step` to `ledger`, and writes what happened to
/// `happened`. Returns the energy that the load got there, less what it lost (J).
///
/// The normal force works at the mean of the speeds before and after the step, and so does side
/// friction in an impact, which gives the loss of an impact exactly. Apart from impacts, side
/// friction works at the speed after the step, as friction with the ground does.
pub fn add_contacts(ledger: &mut EnergyLedger, step: &Step, touches: &mut [Touch], happened: &mut Vec<TransitionKind>) -> f64 {
    happened.clear();
    let net = |ledger: &EnergyLedger| ledger.obstacle_work - ledger.side_friction - ledger.impacts;
    let at_first = net(ledger);
    for (obstacle, touch) in touches.iter_mut().enumerate() {
        let contacts = step.contacts.iter().filter(|contact| contact.obstacle == obstacle && contact.push > 0.0);
        let (mut is_closed, mut loss, mut rubbing, mut rubbing_at_end) = (false, 0.0, 0.0, 0.0);
        for contact in contacts {
            is_closed = true;
            touch.has_bounced |= contact.bounces_at(&step.start.twist).is_some();
            let [before, after] = [&step.start, &step.end].map(|motion| contact.velocity_of(&motion.twist));
            ledger.obstacle_work += step.duration * contact.force().dot(&contact.velocity);
            loss -= step.duration * contact.push * 0.5 * (before[0] + after[0]);
            rubbing -= step.duration * contact.rub * 0.5 * (before[1] + after[1]);
            rubbing_at_end -= step.duration * contact.rub * after[1];
        }
        if is_closed && !touch.is_closed() {
            happened.push(TransitionKind::Touch { obstacle });
        }
        if is_closed && touch.n_steps < N_IMPACT_STEPS && loss > 0.0 {
            ledger.impacts += loss + rubbing;
            touch.energy += loss + rubbing;
        } else {
            ledger.side_friction += rubbing_at_end;
        }
        let has_ended = touch.is_closed() && !is_closed;
        touch.n_steps = if is_closed { (touch.n_steps + 1).min(N_IMPACT_STEPS) } else { 0 };
        if (has_ended || touch.n_steps == N_IMPACT_STEPS) && (touch.energy > 0.0 || touch.has_bounced) {
            happened.push(TransitionKind::Impact { obstacle, energy: std::mem::take(&mut touch.energy), law: ImpactLaw::Engine });
            touch.has_bounced = false;
        }
        if has_ended {
            happened.push(TransitionKind::Separation { obstacle });
        }
    }
    net(ledger) - at_first
}
