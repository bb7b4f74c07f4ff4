//! A live testbed in the browser: one scene on several backends at once, which a reader plays,
//! changes and drags.
//!
//! What is shown is a function of the scenario, the settings and the time. A change of a parameter
//! begins the run anew and goes fast to the same time; a drag changes only the future of a tip or a
//! pusher. What was dragged is thus part of the scenario, and the saved scenario gives the same
//! path again.
//!
//! ```text
//! message.rs    what a page asks and what it receives
//! settings.rs   which backends are shown, and their options
//! scene.rs      scenario and settings as a reader changes them
//! parameters.rs numbers of a scene that sliders change
//! hand.rs       drags as paths of tips and pushers
//! lanes.rs      the scene on each backend, side by side
//! verdict.rs    the comparison of the scene, beside the runs
//! session.rs    one page from its opening to its end: time, frames, changes
//! server.rs     HTTP and WebSocket on the loopback interface
//! page.rs       the page: its scripts and live.css beside the replay's own
//!
//! course.js     frames by time, and the curves that they make
//! keep.js       undo, links and the last change, kept by the browser
//! handles.js    points of a scenario that a pointer can take
//! editor.js     changes of the scene itself
//! timeline.js   the drawing in time
//! hand.js       what a pointer does in the drawing
//! panel.js      sliders, backends and scenes
//! connect.js    messages of the server, and the verdict
//! ```

mod hand;
mod lanes;
mod message;
mod page;
mod parameters;
mod scene;
mod server;
mod session;
mod settings;
mod verdict;

pub use hand::{Handle, Pull, Reach, Span};
pub use lanes::Lanes;
pub use message::{Ask, Tell};
pub use scene::{Edit, LiveScene};
pub use server::{Server, ServerError};
pub use session::{Gone, Session};
pub use settings::Settings;
pub use verdict::Judge;
