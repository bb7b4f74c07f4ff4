//! The word that a misspelt one may stand for.

use strsim::levenshtein;

/// The known word that is most like `word`; `None` if none is near.
pub fn nearest<'a>(word: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    known.into_iter().filter(|other| is_near(word, other)).min_by_key(|other| levenshtein(word, other))
}

/// Whether `word` looks like a misspelt `other`: its end is missing, as the unit of a key, or up to
/// a third of it is wrong.
fn is_near(word: &str, other: &str) -> bool {
    /// Longest word that is compared (characters): a longer one is none that is misspelt.
    const LONGEST: usize = 100;
    if word.is_empty() || word.chars().nth(LONGEST).is_some() {
        return false;
    }
    other.starts_with(word) || levenshtein(word, other) <= (word.chars().count() / 3).max(2).min(other.chars().count() - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn near_words_are_found_and_far_ones_are_not() {
        let known = ["hazard", "aged", "per-tick"];
        assert_eq!(nearest("hazrd", known), Some("hazard"));
        assert_eq!(nearest("per", known), Some("per-tick"));
        for far in ["", "rapier", "x", &"hazard".repeat(20)] {
            assert_eq!(nearest(far, known), None, "{far}");
        }
    }
}
