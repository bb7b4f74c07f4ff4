//! The report of a comparison: its answer, JSON, text, files and page.

pub mod ensemble_page;
pub mod page;
#[cfg(test)]
mod page_tests;
pub mod report;
pub mod sentence;
