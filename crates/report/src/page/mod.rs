//! Reports as one HTML file each that needs nothing else: no network, no fonts, no libraries.
//!
//! A page is data: a headline, sections of blocks, and the source of its numbers. A command adds
//! one in a few lines:
//!
//! ```
//! use cohaul_report::page::{Answer, Block, Headline, Page};
//! use cohaul_report::table::Table;
//!
//! let table = Table::new("Times to the nest", ["ants", "time"]).row(["4", "78.24 s"]).row(["10", "26.11 s"]);
//! let page = Page::new("Sweep over ants", Headline::new(Answer::None, "More ants arrive sooner, up to five."))
//!     .section("Numbers", vec![Block::Table(table)]);
//! assert!(page.to_html().contains("<td class=\"number\">78.24 s</td>"));
//! ```
//!
//! All text is escaped where it is written, so that a name out of a scenario is only ever a name. A
//! policy in the page forbids loading, sending, and every script but its own, which it knows by its
//! hash.
//!
//! ```text
//! content.rs    a page as data
//! html.rs       a page as text; page.css is its look
//! provenance.rs scenario, versions, machine and command
//! replay.rs     what a replay shows: traces with as many rows as an eye needs
//! curves.rs     plots over time that follow a replay
//! replay_world.rs  outlines, obstacles and contacts of a replay
//! thinning.rs   which rows of traces are shown
//! packed.rs     series of numbers as fixed point in base64
//! script/       one module for all pages: base, parts, view, stage and player, curves, figures
//! ```

mod content;
pub mod curves;
mod html;
pub mod packed;
mod provenance;
pub mod replay;
mod replay_world;
pub mod thinning;

pub use content::{Answer, Block, Headline, Number, Page, Section};
pub use html::{SCRIPT_OF_CURVES, SCRIPT_OF_SCENES, STYLE};
pub use replay::Replay;

/// Name of the report in an output folder.
pub const REPORT: &str = "report.html";
