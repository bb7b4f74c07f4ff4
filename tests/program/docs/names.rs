//! Names of the program's code, which only pages about the library may show, and explanations of
//! the values of options, which are those of the glossary.

use cohaul_report::glossary::{Entry, entries};

/// Pages for people who read or write code.
const ABOUT_CODE: [&str; 4] =
    ["docs/src/library.md", "docs/src/architecture.md", "docs/src/contributing.md", "docs/src/notebooks/2_own_controller.md"];
/// Values whose options explain all of them together.
const EXPLAINED_TOGETHER: [(&str, &str); 2] = [("--fail-on", "inertia"), ("--fail-on", "engine")];

/// Paths such as `module::NAME`, and links of the code's documentation, on a page for users.
pub fn code_paths(path: &str, text: &str) -> Vec<String> {
    if ABOUT_CODE.contains(&path) {
        return Vec::new();
    }
    let is_link = |line: &str| line.split("[`").skip(1).any(|rest| rest.starts_with(is_name) && !line.contains("`]("));
    let lines = text.lines().enumerate().filter(|(_, line)| is_link(line) || has_path(line));
    lines.map(|(at, line)| format!("{path}:{}: {}", at + 1, line.trim())).collect()
}

fn is_name(letter: char) -> bool {
    letter.is_ascii_alphanumeric() || letter == '_'
}

/// Whether two names are joined by two colons.
fn has_path(line: &str) -> bool {
    line.match_indices("::").any(|(at, _)| line[..at].ends_with(is_name) && line[at + 2..].starts_with(is_name))
}

/// A value of an option and its explanation, as the page of commands has them.
struct Explained {
    option: String,
    value: String,
    text: String,
}

/// Values in lists such as `- NAME: text`, where the text may go on below.
fn explained(page: &str) -> Vec<Explained> {
    let (mut option, mut found): (String, Vec<Explained>) = (String::new(), Vec::new());
    let mut is_open = false;
    for line in page.lines() {
        let words = line.trim_start();
        let named = words.split([' ', ',']).find(|word| word.starts_with("--"));
        if words.starts_with('-')
            && line.len() - words.len() == 6
            && let Some(name) = named
        {
            option = name.to_owned();
        }
        let item = line.strip_prefix("          - ").map(|item| item.split_once(':').unwrap_or((item, "")));
        if let Some((value, text)) = item {
            found.push(Explained { option: option.clone(), value: value.trim().to_owned(), text: text.trim().to_owned() });
        } else if is_open && line.starts_with("            ") {
            let last = found.last_mut().expect("a list is open");
            last.text = format!("{} {words}", last.text);
        }
        is_open = item.is_some() || is_open && line.starts_with("            ");
    }
    found
}

/// Values that the page of commands does not explain, or with words that are not those of the
/// glossary on this value of this option.
pub fn badly_explained(page: &str) -> Vec<String> {
    let wrong = |of: &Explained| {
        let kind = of.option.trim_start_matches('-').to_owned();
        let value = of.value.replace('-', " ");
        let is_of = |term: &str, name: &str| term.replace('-', " ") == name;
        let summaries = |is_wanted: &dyn Fn(&Entry) -> bool| -> Vec<&str> {
            entries().iter().filter(|entry| is_wanted(entry)).map(Entry::summary).collect()
        };
        // An entry for values of this option goes before one of the same name elsewhere.
        let of_kind = summaries(&|entry| is_of(entry.term, &format!("{value} {kind}")));
        let of_term = summaries(&|entry| is_of(entry.term, &value));
        let of_name = summaries(&|entry| entry.names().any(|name| is_of(name, &value)));
        let is_own = || !of.text.is_empty() && entries().iter().all(|entry| entry.summary() != of.text);
        let is_right = match (&of_kind[..], &of_term[..]) {
            ([], []) => of_name.contains(&&*of.text) || is_own(),
            ([], wanted) | (wanted, _) => wanted.contains(&&*of.text),
        };
        let is_left = EXPLAINED_TOGETHER.contains(&(of.option.as_str(), of.value.as_str())) && of.text.is_empty();
        (!is_right && !is_left).then(|| format!("{} {}: {}", of.option, of.value, of.text))
    };
    explained(page).iter().filter_map(wrong).collect()
}

#[test]
fn another_words_explanation_and_a_path_of_code_are_found() {
    let help = |value: &str, entry: &str| {
        let entry = entries().iter().find(|found| found.term == entry).expect("an entry of the glossary");
        format!("      --preset <NAME>\n          Parameters\n\n          - {value}: {}\n", entry.summary())
    };
    assert!(badly_explained(&help("aged", "aged preset")).is_empty());
    assert_eq!(badly_explained(&help("aged", "aged pace")).len(), 1);
    assert_eq!(badly_explained("      --backend <NAME>\n          - rapier\n").len(), 1);
    assert_eq!(code_paths("README.md", "Eight of them ([`paper::ANTS`]).\nA [`Preset`].\nSee [`x`](y.md): z").len(), 2);
    assert!(code_paths("docs/src/library.md", "`cohaul::run`").is_empty());
}
