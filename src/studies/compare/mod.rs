//! The report of a comparison: its answer, JSON, text, files and page.

pub mod answer;
pub mod page;
pub mod report;
pub mod text;
