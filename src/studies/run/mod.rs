//! One run of one scenario: its summary as JSON and text, its files and its page.

pub mod files;
pub mod page;
pub mod summary;
pub mod text;
