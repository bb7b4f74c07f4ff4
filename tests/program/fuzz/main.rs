//! Everything that the program reads, changed at random: an answer or an error, never a panic.
//!
//! ```text
//! survey.rs     many changed inputs on a reader: what it answers, shrunk where it should not
//! watch.rs      a stop for work that takes too long
//! bytes.rs      changes of any text: bits, cuts, repetitions, odd tokens
//! structure.rs  changes of JSON: numbers, keys, types, lengths, parts of other files
//! corpus.rs     the files that are changed
//! scenes.rs     scenarios, and short runs of those that are accepted
//! tables.rs     tables of tips, paths, readings and pulls
//! recordings.rs files of trackers, and drawings
//! files.rs      baselines, saved runs, journals and shards
//! known.rs      inputs that the program once answered wrongly
//! messages.rs   messages of the live page
//! accounts.rs   random scenes whose account must be true
//! ```
//!
//! `COHAUL_SEED` is the first seed in place of 1, `COHAUL_COUNT` the number of inputs of each
//! format, and `COHAUL_SCENES` the number of random scenes. A seed makes the same input each time.

mod accounts;
mod bytes;
mod corpus;
#[path = "../../differential/draws.rs"]
#[allow(dead_code, reason = "other tests use more of it")]
mod draws;
mod files;
mod known;
mod messages;
#[path = "../../contact/random_scene.rs"]
#[allow(dead_code, reason = "other tests use more of it")]
mod obstacle_scene;
#[path = "../../common/random_scenes.rs"]
mod random_scenes;
mod recordings;
#[path = "../../common/root.rs"]
mod root;
mod scenes;
mod structure;
mod survey;
mod tables;
mod watch;
