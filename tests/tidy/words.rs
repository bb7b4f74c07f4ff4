//! Phrases that nobody should have to read: the words of this house alone.

use crate::Finding;

/// A phrase and what to say in its place. Letter case is ignored, and a phrase matches whole words.
const PRIVATE: &[(&str, &str)] = &[
    ("own error", "reference error"),
    ("own errors", "reference errors"),
    ("own_error", "reference_error"),
    ("by its step", "time-step error"),
    ("of its step", "time-step error"),
    ("of beyond", "model error"),
    ("by inertia,", "inertia effect"),
    ("never by", "stays below the tolerance"),
    ("rim", "edge displacement"),
    ("rims", "edge displacement"),
    ("parts first", "first divergence"),
    ("paths part", "paths diverge"),
    ("decisions part", "first different decision"),
    ("parting", "divergence"),
    ("partings", "divergences"),
    ("occasion", "event"),
    ("occasions", "events"),
    ("is sound", "quasi-static valid"),
    ("is not sound", "quasi-static not valid"),
    ("taken for sound", "quasi-static valid"),
    ("unsound", "quasi-static not valid"),
    ("justified", "valid"),
    ("remedy", "suggested change"),
    ("remedies", "suggested changes"),
    ("lest", "so that ... not"),
    ("seen every", "sampled every"),
    ("snap", "jump, snap-through"),
    ("snaps", "jumps, snaps through"),
    ("legs", "iterations"),
    ("regime of friction", "contact mode"),
    ("regime of the friction", "contact mode"),
    ("friction regime", "contact mode"),
    ("captured", "pinned"),
    ("capture", "pinning"),
    ("captures", "pinnings"),
    ("freed", "unpinned"),
    ("surely", "with a certificate"),
    ("stick-bound", "stick-certificate"),
    ("stride", "macro-step"),
    ("strides", "macro-steps"),
    ("glide", "Newton corrector"),
    ("glides", "Newton corrector"),
    ("books", "ledger, records"),
    ("shadow", "reduced inertial model"),
    ("shadows", "reduced inertial models"),
    ("is_lost", "is_invalid"),
    ("held spring", "attached spring"),
    ("held springs", "attached springs"),
    ("held tip", "attached tip"),
    ("held tips", "attached tips"),
    ("spring held", "spring attached"),
    ("holder", "ant, robot, attachment"),
    ("holders", "ants, robots, attachments"),
    ("grips", "attachments"),
    ("as shipped", "engine defaults"),
    ("as-shipped", "engine-defaults"),
    ("luck", "random stream"),
    ("all chance", "random stream"),
    ("kept inertia", "scaled inertia"),
    ("arrived share", "fraction arrived"),
    ("n transporting", "number transporting"),
    ("of its way", "of the path length"),
    ("of the way", "of the path length"),
    ("its way", "path length, displacement"),
    ("way of the load", "displacement"),
    ("way without", "path length without"),
    ("yardstick", "length scale"),
    ("nobody", "say what is"),
    ("somebody", "say who"),
    ("is told", "verbs of people stay with people"),
    ("are told", "verbs of people stay with people"),
    ("not told", "unknown"),
    ("in vain", "false alarm"),
    ("lie apart", "differ"),
    ("bends the physics", "engine error"),
];

/// Private words in a text that begins at `line`.
pub fn private_words(path: &str, line: usize, text: &str) -> Vec<Finding> {
    let mut findings = Vec::new();
    let lower = text.to_lowercase();
    let one_line = lower.replace('\n', " ");
    for (phrase, instead) in PRIVATE {
        for at in matches(&one_line, phrase) {
            let line = line + lower[..at].matches('\n').count();
            findings.push(Finding::new(path, line, format!("`{phrase}`: say {instead}")));
        }
    }
    findings
}

/// Where a phrase stands as whole words.
fn matches(text: &str, phrase: &str) -> Vec<usize> {
    let is_part = |char: char| char.is_alphanumeric() || char == '_' || char == '-';
    let is_whole = |at: &usize| {
        let ends_in_word = phrase.ends_with(is_part);
        !(text[..*at].ends_with(is_part) || ends_in_word && text[at + phrase.len()..].starts_with(is_part))
    };
    text.match_indices(phrase).map(|(at, _)| at).filter(is_whole).collect()
}
