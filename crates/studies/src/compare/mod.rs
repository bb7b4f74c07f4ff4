//! The report of a comparison: its answer, JSON, text, files and page.

pub mod answer;
pub mod beside;
pub mod closed_loop;
pub mod comparison;
pub mod doubt;
pub mod files;
pub mod page;
pub mod side_by_side;
pub mod text;
mod words;
