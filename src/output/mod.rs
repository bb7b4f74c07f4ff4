//! What people and programs read: tables, figures, pages, an output folder and a progress bar.
//! Knows no study.

#[cfg(feature = "figures")]
pub mod chart;
pub mod folder;
pub mod glossary;
pub mod json;
pub mod lines;
pub mod manifest;
#[cfg(feature = "figures")]
pub mod page;
#[cfg(feature = "program")]
pub mod progress;
pub mod quantity;
pub mod sibling;
#[cfg(test)]
pub(crate) mod synthetic;
pub mod table;
pub mod text;
pub mod tips_csv;
pub mod trace_csv;
