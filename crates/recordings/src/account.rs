//! What an import did to a recording or a drawing, counted and bounded.

use cohaul::formats::{self, Format, Versioned};
use cohaul_report::quantity::short_quantity;
use cohaul_report::text::Lines;
use serde::Serialize;

/// Places that are listed of each note. The others are counted.
const MOST_PLACES: usize = 20;

/// A kind of thing that an import found or did.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// Rows or shapes that were read.
    Read,
    /// Columns, tracks or shapes that have no part in the scenario.
    LeftOut,
    /// Places that the tracker did not give: empty cells, NaN, infinities.
    NotSeen,
    /// Places whose confidence is too small, taken as not seen.
    LowConfidence,
    /// Rows that say the same a second time.
    Repeated,
    /// Numbers that were read in another unit than that of the scenario.
    Units,
    /// Times or places whose origin was moved.
    Moved,
    /// Swapped names of two tracks that were put right.
    Swaps,
    /// Places far off their track for a short time, taken as not seen.
    Jumps,
    /// Steps beyond the largest jump that were kept, since the track goes on from there.
    Steps,
    /// Gaps that were bridged by a straight line.
    Bridged,
    /// Releases that the recording states.
    Releases,
    /// Releases that follow from long gaps.
    ReleasesInferred,
    /// Grasps after the start of the recording.
    Grasps,
    /// Places that were smoothed.
    Smoothed,
    /// Noise of the places from frame to frame.
    Noise,
    /// Curves that were replaced by straight lines.
    Flattened,
    /// Holes in an outline.
    Holes,
    /// Parts of an outline that were joined to their union.
    Joined,
}

/// Where something was done.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Place {
    /// Name of the track or of the shape.
    pub name: String,
    /// Time since the start of the scenario (s); not there for drawings.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time_s: Option<f64>,
}

/// One kind of thing that was done, how often, and how far.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Note {
    pub kind: Kind,
    /// How often (1).
    pub count: usize,
    /// The same in words.
    pub text: String,
    /// Largest size of it, in `unit`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub largest: Option<f64>,
    /// Bound that an option or its default sets, in `unit`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub limit: Option<f64>,
    /// Unit of `largest` and `limit`.
    #[serde(skip_serializing_if = "str::is_empty")]
    pub unit: &'static str,
    /// Whether the reader should look at it before trusting a verdict.
    pub is_warning: bool,
    /// The first places.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub places: Vec<Place>,
}

impl Note {
    pub fn new(kind: Kind, count: usize, text: impl Into<String>) -> Self {
        Self { kind, count, text: text.into(), largest: None, limit: None, unit: "", is_warning: false, places: Vec::new() }
    }

    /// The note with its largest size and its bound, in `unit`.
    #[must_use]
    pub fn sized(self, largest: Option<f64>, limit: Option<f64>, unit: &'static str) -> Self {
        Self { largest, limit, unit, ..self }
    }

    /// The note with its places, of which the first ones are kept.
    #[must_use]
    pub fn at(self, places: impl IntoIterator<Item = (String, f64)>) -> Self {
        let places = places.into_iter().take(MOST_PLACES).map(|(name, time)| Place { name, time_s: Some(time) }).collect();
        Self { places, ..self }
    }

    #[must_use]
    pub fn warning(self) -> Self {
        Self { is_warning: true, ..self }
    }
}

/// What an import did, in the order in which it was done.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Account {
    /// Files that were read.
    pub files: Vec<String>,
    /// Name of their format.
    pub source: String,
    /// All that was found and done.
    pub notes: Vec<Note>,
}

impl Versioned for Account {
    const FORMAT: Format = formats::IMPORT;
}

impl Account {
    /// Adds a note unless it counts nothing.
    pub fn add(&mut self, note: Note) {
        if note.count > 0 {
            self.notes.push(note);
        }
    }

    /// Sum of the counts of a kind.
    pub fn count(&self, kind: Kind) -> usize {
        self.notes.iter().filter(|note| note.kind == kind).map(|note| note.count).sum()
    }

    /// The account as a table for people, 80 columns wide.
    pub fn text(&self) -> String {
        let mut lines = Lines::default();
        lines.section(&format!("{}: {}", self.source, self.files.join(", ")));
        for note in &self.notes {
            let mut text = note.text.clone();
            for (name, value) in [("at most", note.largest), ("bound", note.limit)] {
                text += &value.map_or_else(String::new, |value| format!("; {name} {}", short_quantity(value, note.unit)));
            }
            let places = note.places.iter().take(3).map(|place| match place.time_s {
                Some(time) => format!("{} at {time:.4} s", place.name),
                None => place.name.clone(),
            });
            let places: Vec<String> = places.collect();
            if !places.is_empty() {
                text += &format!(" ({}{})", places.join(", "), if note.count > places.len() { ", ..." } else { "" });
            }
            lines.row(if note.is_warning { "warning" } else { "" }, &format!("{} {text}", note.count));
        }
        lines.text
    }
}
