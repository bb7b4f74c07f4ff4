//! Links, anchors and pictures of a page.

use std::path::Path;

use crate::{read, root};

/// Links of a page that lead nowhere.
pub fn broken(path: &str) -> Vec<String> {
    let text = read(path);
    let links = targets(&text).into_iter().filter(|(_, target)| !target.contains("://") && !target.starts_with("mailto:"));
    links.filter_map(|(line, target)| wrong(path, &text, &target).map(|why| format!("{path}:{line}: {target}: {why}"))).collect()
}

fn wrong(from: &str, text: &str, target: &str) -> Option<String> {
    let (file, anchor) = target.split_once('#').map_or((target, None), |(file, anchor)| (file, Some(anchor)));
    let folder = Path::new(from).parent().expect("a page is in a folder");
    let file = if file.is_empty() { None } else { Some(root().join(folder).join(file)) };
    if let Some(file) = file.as_ref().filter(|file| !file.exists()) {
        return Some(format!("{} is not there", file.display()));
    }
    let page = match file {
        None => text.to_owned(),
        Some(file) if file.extension().is_some_and(|end| end == "md") => std::fs::read_to_string(&file).expect("a page can be read"),
        Some(_) => return None,
    };
    let anchor = anchor?;
    (!anchors(&page).iter().any(|found| found == anchor)).then(|| format!("no heading gives #{anchor}"))
}

/// Line and target of every link and picture outside of code.
fn targets(text: &str) -> Vec<(usize, String)> {
    let mut is_code = false;
    let mut found = Vec::new();
    for (at, line) in text.lines().enumerate() {
        is_code ^= line.starts_with("```");
        let mut rest = if is_code { "" } else { line };
        while let Some((_, after)) = rest.split_once("](") {
            let Some((target, after)) = after.split_once(')') else { break };
            found.push((at + 1, target.to_owned()));
            rest = after;
        }
    }
    found
}

/// Anchors of headings, as mdBook and GitHub make them.
fn anchors(text: &str) -> Vec<String> {
    let included = text.lines().find_map(|line| line.strip_prefix("{{#include ")?.strip_suffix("}}"));
    let included = included.map(|path| read(path.trim_start_matches("../../")));
    let headings = text.lines().chain(included.iter().flat_map(|text| text.lines())).filter(|line| line.starts_with('#'));
    let words = headings.map(|line| line.trim_start_matches('#').trim().to_lowercase());
    words
        .map(|text| {
            text.chars().filter(|char| char.is_alphanumeric() || [' ', '-', '_'].contains(char)).collect::<String>().replace(' ', "-")
        })
        .collect()
}
