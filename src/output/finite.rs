//! Numbers that leave the program are finite.

/// A result that no file may hold.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{field} is {value}: results must be finite numbers")]
pub struct NotFinite {
    pub field: String,
    pub value: f64,
}

/// `value`, when it is finite.
///
/// # Errors
/// When it is NaN or infinite: JSON would turn it into `null` without a word.
pub fn finite(field: &str, value: f64) -> Result<f64, NotFinite> {
    if value.is_finite() { Ok(value) } else { Err(NotFinite { field: field.to_owned(), value }) }
}
