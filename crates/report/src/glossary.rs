//! The glossary: what every printed term means, read from the page of the book.

use std::collections::HashMap;
use std::sync::LazyLock;

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Entry {
    pub term: &'static str,
    /// Other names of the term.
    pub aliases: Vec<String>,
    /// One to three sentences on one line.
    pub meaning: String,
    /// Page of the book that says more, relative to its folder.
    pub page: Option<&'static str>,
}

static ENTRIES: LazyLock<Vec<Entry>> =
    LazyLock::new(|| include_str!("../../../docs/src/glossary.md").split("\n## ").skip(1).map(Entry::parse).collect());

/// Entries by the plain forms of all their names.
static BY_NAME: LazyLock<HashMap<String, &Entry>> =
    LazyLock::new(|| ENTRIES.iter().flat_map(|entry| entry.names().map(move |name| (plain(name), entry))).collect());

/// All entries in alphabetical order.
pub fn entries() -> &'static [Entry] {
    &ENTRIES
}

/// The entry of a term or of another name of it. Letter case does not matter, and hyphens and
/// underscores count as spaces.
pub fn entry(term: &str) -> Option<&'static Entry> {
    BY_NAME.get(&plain(term.trim())).copied()
}

fn plain(name: &str) -> String {
    name.to_lowercase().replace(['-', '_'], " ")
}

impl Entry {
    fn parse(section: &'static str) -> Self {
        let (term, body) = section.split_once('\n').unwrap_or((section, ""));
        let mut found = Self { term: term.trim(), aliases: Vec::new(), meaning: String::new(), page: None };
        for paragraph in body.split("\n\n").map(str::trim).filter(|paragraph| !paragraph.is_empty()) {
            let line = paragraph.split_whitespace().collect::<Vec<_>>().join(" ");
            if let Some(aliases) = line.strip_prefix("Also: ") {
                found.aliases = aliases.trim_end_matches('.').split(", ").map(str::to_owned).collect();
            } else if paragraph.starts_with("More: ") {
                found.page = paragraph.split_once('(').and_then(|(_, rest)| rest.split_once(')')).map(|(page, _)| page);
            } else {
                found.meaning = line;
            }
        }
        found
    }

    pub fn names(&self) -> impl Iterator<Item = &str> {
        std::iter::once(self.term).chain(self.aliases.iter().map(String::as_str))
    }

    /// The first sentence of the meaning, without its full stop.
    pub fn summary(&self) -> &str {
        self.meaning.split(". ").next().unwrap_or_default().trim_end_matches('.')
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Labels and words of runs, comparisons and checks of scenarios.
    #[test]
    fn printed_terms_have_an_entry() {
        let of_checks = ["weight", "frequencies", "first pulls", "expected time", "translation", "rotation", "hash"];
        let of_runs = ["largest effect", "heading", "turn rate", "wall time", "change of speed"];
        let at_obstacles = ["contacts", "contact forces", "at obstacles", "roll", "hits", "work on the load", "avoidance", "sidestep"];
        let of_comparisons = ["together", "numbers", "predicted", "its error", "not checked"];
        for term in [&of_checks[..], &of_runs, &at_obstacles, &of_comparisons].concat() {
            assert!(entry(term).is_some(), "{term}");
        }
    }

    #[test]
    fn every_entry_has_a_meaning_and_names_of_its_own() {
        let entries = entries();
        assert!(entries.len() > 100);
        let mut names: Vec<String> = entries.iter().flat_map(Entry::names).map(str::to_lowercase).collect();
        names.sort();
        assert_eq!(names.windows(2).find(|pair| pair[0] == pair[1]), None);
        for found in entries {
            assert!(found.meaning.ends_with('.') && !found.meaning.contains("  "), "{found:?}");
            // However it is written, a name leads to its own entry alone.
            assert!(found.names().all(|name| entry(&name.to_uppercase()) == Some(found)), "{found:?}");
        }
        let mode = entry("Sticking").unwrap();
        assert_eq!((mode.term, mode.page), ("contact mode", Some("method.md#quasi-static-step")));
    }
}
