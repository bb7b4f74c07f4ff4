//! What people and programs read: tables, figures, pages, an output folder and a progress bar.
//! Knows no study.
#![forbid(unsafe_code)]

pub mod account_words;
pub mod chart;
mod earlier;
pub mod folder;
pub mod glossary;
pub mod json;
pub mod junit;
pub mod lines;
pub mod manifest;
pub mod page;
#[cfg(feature = "picture")]
pub mod picture;
pub mod progress;
pub mod quantity;
pub mod sibling;
pub mod synthetic;
pub mod table;
pub mod text;
pub mod tips_csv;
pub mod trace_csv;
#[cfg(feature = "parquet")]
mod trace_parquet;
pub mod traces;
pub mod transition_words;
