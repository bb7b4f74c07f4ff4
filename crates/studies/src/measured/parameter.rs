//! Numbers of a scene that a fit may change.

use serde_json::Value;

use super::scene::{Change, SceneTemplate};
use crate::sweep::Place;

/// A number of the scene, at one place or at several that have the same value.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    pub name: String,
    pub places: Vec<Place>,
    /// Value in the scene.
    pub before: f64,
    /// Value at which a fit begins: that of the scene, or a usual one where that is zero.
    pub start: f64,
}

/// Names of numbers that are spread over a scene.
pub const GROUND_FRICTION: &str = "ground-friction";
pub const SIDE_FRICTION: &str = "side-friction";

/// Coefficient of friction with which a fit begins where the scene has none (1).
const USUAL_FRICTION: f64 = 0.2;

impl Parameter {
    /// The number of this name, or at this place of the scene as it is written.
    ///
    /// # Errors
    /// When the scene has no such number, or it is not positive.
    pub fn named(name: &str, template: &SceneTemplate) -> Result<Self, String> {
        let place = |text: &str| Place::parse(text).map_err(|error| error.to_string());
        let number = |place: &Place| place.first(template.written()).and_then(Value::as_f64);
        let (places, before) = match name {
            SIDE_FRICTION => (side_friction(template)?, side_friction_of(template)),
            _ => {
                let place = place(if name == GROUND_FRICTION { "ground.friction_coefficient" } else { name })?;
                let rule = "must be ground-friction, side-friction or a number of the scene as it is written";
                let before = number(&place).ok_or_else(|| format!("{rule}, found {name}"))?;
                (vec![place], before)
            }
        };
        let start = match before {
            before if before > 0.0 => before,
            0.0 if name.contains("friction") => USUAL_FRICTION,
            _ => return Err(format!("{name} must be positive in the scene, found {before}")),
        };
        Ok(Self { name: name.to_owned(), places, before, start })
    }

    pub fn at(&self, value: f64) -> Change {
        Change { places: self.places.clone(), value }
    }
}

/// Places of the coefficients of load and obstacles: with the same value at all, every rule of
/// combination but the product gives that value.
fn side_friction(template: &SceneTemplate) -> Result<Vec<Place>, String> {
    let n = template.base.system.world.obstacles.len();
    if n == 0 {
        return Err("side-friction must have an obstacle in the scene, found none".into());
    }
    if template.written()["side_friction_rule"] == "multiply" {
        return Err("side-friction must have another side_friction_rule, found \"multiply\"".into());
    }
    let obstacles = (0..n).map(|at| format!("obstacles[{at}].friction_coefficient"));
    let all = obstacles.chain(["load.side_friction_coefficient".to_owned()]);
    all.map(|path| Place::parse(&path).map_err(|error| error.to_string())).collect()
}

/// Combined coefficient of the first obstacle.
fn side_friction_of(template: &SceneTemplate) -> f64 {
    template.base.system.world.obstacles.first().map_or(0.0, |obstacle| obstacle.friction_coefficient)
}
