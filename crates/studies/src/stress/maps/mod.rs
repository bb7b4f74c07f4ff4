//! The maps: what is varied, over which scene, and what is known of its answer.

mod contact;
mod ground;
mod hours;
mod scales;
mod springs;
mod steps;

use super::map::Map;

pub fn all() -> Vec<Map> {
    [steps::maps(), ground::maps(), springs::maps(), scales::maps(), hours::maps(), contact::maps()].concat()
}
