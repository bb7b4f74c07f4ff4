//! What carries requests to an engine, and what was wrong with one.

use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::{Arc, Mutex};

use crate::springs::Springs;

/// A way to an engine, one line each way.
pub trait Channel: Send {
    /// Sends a line, answers what the engine then asks of the `springs`, and returns its answer.
    ///
    /// # Errors
    /// What is wrong with the engine, in words.
    fn exchange(&mut self, line: &str, springs: &Arc<Springs>) -> Result<String, String>;
}

/// The first thing that was wrong with an engine in any of its runs.
#[derive(Debug, Default)]
pub struct Complaint {
    text: Mutex<Option<String>>,
    is_made: AtomicBool,
}

impl Complaint {
    /// Keeps what was wrong, unless something was before.
    pub fn make(&self, what: String) {
        self.locked().get_or_insert(what);
        self.is_made.store(true, Relaxed);
    }

    /// Whether something was wrong. Asked often.
    pub fn is_made(&self) -> bool {
        self.is_made.load(Relaxed)
    }

    pub fn text(&self) -> Option<String> {
        self.locked().clone()
    }

    fn locked(&self) -> std::sync::MutexGuard<'_, Option<String>> {
        self.text.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
    }
}

/// The beginning of a long text.
pub(crate) fn shortened(text: &str) -> String {
    const MOST: usize = 120;
    let beginning: String = text.chars().take(MOST).collect();
    if beginning.len() < text.len() { format!("{beginning}...") } else { beginning }
}
