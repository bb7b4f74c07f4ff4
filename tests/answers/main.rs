//! Answers of comparisons on scenes whose truth is known or that are hard to compute.

mod attribution;
mod causes;
mod finite;
mod oracle;
mod presets;
mod quantities;
#[path = "../common/random_scenes.rs"]
mod random_scenes;
mod runs;
mod surveys;
mod tips;
mod uniform_supports;
mod vary;
