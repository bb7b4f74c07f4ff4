//! What a report contains.

use crate::manifest::Manifest;
use crate::page::curves::Curves;
use crate::page::replay::Replay;
use crate::table::Table;

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
    /// Yes in the main, and no in another respect.
    Partly,
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
    /// A drawing in the colours of the page, as those of [`crate::chart::bars`].
    Chart {
        svg: String,
        caption: String,
    },
    Replay(Box<Replay>),
    /// Plots that show the time of the replay before them.
    Curves(Box<Curves>),
    /// Side by side where there is room.
    Columns(Vec<Vec<Block>>),
    /// Closed until it is asked for.
    Folded {
        heading: String,
        blocks: Vec<Block>,
    },
    /// Glossary entries of the terms that stand above on the page.
    Terms,
}

/// A named number with its unit.
#[derive(Clone, Debug, PartialEq)]
pub struct Number {
    pub name: String,
    pub value: String,
    /// What it says; empty where the name does.
    pub note: String,
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
