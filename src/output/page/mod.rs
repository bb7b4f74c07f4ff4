//! Reports as one HTML file each that needs nothing else: no network, no fonts, no libraries.
//!
//! A page is data: a headline, sections of blocks, and where it all comes from. A command adds one in a few lines:
//!
//! ```
//! use cohaul::output::page::{Answer, Block, Headline, Page, Table};
//!
//! let table = Table::new("Times home", ["ants", "time to nest"]).row(["4", "78.24 s"]).row(["10", "26.11 s"]);
//! let page = Page::new("Sweep over ants", Headline::new(Answer::None, "More ants are home sooner, up to five."))
//!     .section("Numbers", vec![Block::Table(table)]);
//! assert!(page.to_html().contains("<td class=\"number\">78.24 s</td>"));
//! ```
//!
//! All text is escaped where it is written, so that a name out of a scenario is only ever a name. A policy in the page forbids it to load or send anything, and every
//! script but the one of the replay, which it knows by its hash.
//!
//! ```text
//! render.rs     a page as text; page.css is its look
//! escape.rs     text and data inside HTML
//! provenance.rs scenario, versions, machine and command
//! chart.rs      bars and intervals as SVG in the colours of the page
//! replay.rs     what a replay shows: traces thinned to what an eye needs; replay.js draws it
//! thinning.rs   which rows of traces are shown
//! packed.rs     series of numbers as fixed point in base64
//! comparison.rs, verdict.rs, ensemble.rs   the page of a comparison, what it says first, and its closed loop
//! run.rs, bench.rs, stress.rs              the pages of the other commands
//! terms.rs      what the words mean
//! ```

pub mod bars;
pub mod escape;
pub mod packed;
mod provenance;
mod render;
pub mod replay;
pub mod terms;
pub mod thinning;

use crate::output::manifest::Manifest;

pub use bars::{Bar, Spread, SpreadLine};
pub use replay::{Replay, Shown};

/// Name of the report in an output folder.
pub const REPORT: &str = "report.html";

/// A report as data.
#[derive(Clone, Debug, PartialEq)]
pub struct Page {
    pub title: String,
    pub headline: Headline,
    pub sections: Vec<Section>,
    /// Where it comes from: the last section.
    pub provenance: Option<Manifest>,
}

/// What is seen first: one sentence that answers the question, and what it rests on.
#[derive(Clone, Debug, PartialEq)]
pub struct Headline {
    pub answer: Answer,
    pub sentence: String,
    pub blocks: Vec<Block>,
}

/// How the answer is marked, by a sign and by colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Answer {
    Yes,
    No,
    /// It cannot be told.
    Open,
    /// Nothing was asked.
    None,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Section {
    pub heading: String,
    pub blocks: Vec<Block>,
}

#[derive(Clone, Debug, PartialEq)]
pub enum Block {
    Text(String),
    List(Vec<String>),
    /// As it is, in letters of one width.
    Code(String),
    Numbers(Vec<Number>),
    Table(Table),
    /// A whole SVG document and what it shows; the caption is its text alternative too.
    Figure {
        svg: String,
        caption: String,
    },
    /// The same in the colours of the page, as [`bars`] and [`spreads`] draw.
    Chart {
        svg: String,
        caption: String,
    },
    Replay(Box<Replay>),
    /// Side by side where there is room.
    Columns(Vec<Vec<Block>>),
    /// Closed until it is asked for.
    Folded {
        heading: String,
        blocks: Vec<Block>,
    },
    /// Words and what they mean.
    Terms(Vec<(&'static str, &'static str)>),
}

/// A named number with its unit.
#[derive(Clone, Debug, PartialEq)]
pub struct Number {
    pub name: String,
    pub value: String,
    /// What it says; empty where the name does.
    pub note: String,
}

/// Cells of text; the first of each row is its name.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    pub caption: String,
    pub head: Vec<String>,
    pub rows: Vec<Vec<String>>,
}

impl Page {
    pub fn new(title: impl Into<String>, headline: Headline) -> Self {
        Self { title: title.into(), headline, sections: Vec::new(), provenance: None }
    }

    /// With one more section; without blocks it is left out.
    pub fn section(mut self, heading: impl Into<String>, blocks: Vec<Block>) -> Self {
        if !blocks.is_empty() {
            self.sections.push(Section { heading: heading.into(), blocks });
        }
        self
    }

    pub fn from(self, manifest: &Manifest) -> Self {
        Self { provenance: Some(manifest.clone()), ..self }
    }

    /// The whole file.
    pub fn to_html(&self) -> String {
        render::page(self)
    }
}

impl Headline {
    pub fn new(answer: Answer, sentence: impl Into<String>) -> Self {
        Self { answer, sentence: sentence.into(), blocks: Vec::new() }
    }

    pub fn with(mut self, block: Block) -> Self {
        self.blocks.push(block);
        self
    }
}

impl Block {
    pub fn text(text: impl Into<String>) -> Self {
        Block::Text(text.into())
    }

    pub fn figure(svg: impl Into<String>, caption: impl Into<String>) -> Self {
        Block::Figure { svg: svg.into(), caption: caption.into() }
    }
}

impl Number {
    pub fn new(name: impl Into<String>, value: impl Into<String>, note: impl Into<String>) -> Self {
        Self { name: name.into(), value: value.into(), note: note.into() }
    }
}

impl Table {
    pub fn new<const N: usize>(caption: impl Into<String>, head: [&str; N]) -> Self {
        Self { caption: caption.into(), head: head.map(str::to_owned).into(), rows: Vec::new() }
    }

    pub fn row<const N: usize>(mut self, cells: [impl Into<String>; N]) -> Self {
        self.rows.push(cells.map(Into::into).into());
        self
    }
}
