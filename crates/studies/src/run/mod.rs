//! One run of one scenario: its summary as JSON and text, its files and its page.

pub mod answer;
mod contacts;
pub mod files;
pub mod page;
#[cfg(test)]
mod page_tests;
pub mod summary;
pub mod text;
