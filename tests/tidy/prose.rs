//! Paragraphs, sentences and widths.

use crate::Finding;
use crate::source::Source;

pub struct Sentence {
    pub path: String,
    pub line: usize,
    pub n_words: usize,
    text: String,
}

impl Sentence {
    pub fn start(&self) -> String {
        self.text.split_whitespace().take(12).collect::<Vec<_>>().join(" ") + " ..."
    }
}

/// An entry of the glossary.
pub struct Entry {
    pub term: String,
    pub line: usize,
    /// The term and its other names.
    pub names: Vec<String>,
    pub n_sentences: usize,
}

/// A piece of running text of a page: a paragraph or an item of a list.
struct Paragraph {
    line: usize,
    text: String,
}

/// Comments that are wider than `limit` columns, but for tables, addresses and examples of code.
pub fn wide_comments(file: &Source, limit: usize) -> Vec<Finding> {
    let mut is_code = false;
    let mut findings = Vec::new();
    for (at, line) in file.text.lines().enumerate() {
        let Some(comment) = line.trim_start().strip_prefix("//") else {
            is_code = false;
            continue;
        };
        let comment = comment.trim_start_matches(['/', '!']).trim_start();
        is_code ^= comment.starts_with("```");
        if !is_code && is_wide(line, comment, limit) {
            findings.push(Finding::new(&file.path, at + 1, format!("{} columns", line.chars().count())));
        }
    }
    findings
}

/// Lines of a page that are wider than `limit` columns, but for tables, addresses and code.
pub fn wide_lines(path: &str, text: &str, limit: usize) -> Vec<Finding> {
    let mut is_code = false;
    let mut findings = Vec::new();
    for (at, line) in text.lines().enumerate() {
        is_code ^= line.trim_start().starts_with("```");
        if !is_code && is_wide(line, line.trim_start(), limit) {
            findings.push(Finding::new(path, at + 1, format!("{} columns", line.chars().count())));
        }
    }
    findings
}

fn is_wide(line: &str, text: &str, limit: usize) -> bool {
    let is_exempt = text.starts_with('|') || text.starts_with("![") || line.contains("](") || line.contains("://") || !text.contains(' ');
    line.chars().count() > limit && !is_exempt
}

pub fn sentences_of_markdown(path: &str, text: &str) -> Vec<Sentence> {
    paragraphs(text).iter().flat_map(|paragraph| sentences(path, paragraph.line, &paragraph.text)).collect()
}

/// Sentences among the strings of a file and, of the command line, among its doc comments, which
/// are its help.
pub fn printed_sentences(file: &Source) -> Vec<Sentence> {
    let is_help = file.path.starts_with("crates/app/src/cli/");
    let is_printed = |text: &&crate::source::Text| if text.is_doc { is_help } else { text.text.split_whitespace().count() > 4 };
    file.texts().iter().filter(is_printed).flat_map(|text| sentences_of_page_or_line(file, text.line, &text.text)).collect()
}

fn sentences_of_page_or_line(file: &Source, line: usize, text: &str) -> Vec<Sentence> {
    // Markup, styles and formulas are not prose.
    if text.contains(['<', '{']) && text.contains(['>', ';']) && !text.contains(". ") {
        return Vec::new();
    }
    paragraphs(text).iter().flat_map(|paragraph| sentences(&file.path, line + paragraph.line - 1, &paragraph.text)).collect()
}

/// Running text of a page: without headings, code, tables, comments and pictures.
fn paragraphs(text: &str) -> Vec<Paragraph> {
    let mut found: Vec<Paragraph> = Vec::new();
    let (mut is_code, mut is_comment, mut is_open) = (false, false, false);
    for (at, line) in text.lines().enumerate() {
        let line = line.trim();
        if line.starts_with("```") {
            is_code = !is_code;
            is_open = false;
            continue;
        }
        is_comment |= line.starts_with("<!--");
        let is_skipped = is_code || is_comment || line.is_empty() || line.starts_with(['#', '|', '!']) || line.starts_with("{{");
        is_comment &= !line.contains("-->");
        let item = line
            .strip_prefix("- ")
            .or_else(|| line.strip_prefix("* "))
            .or_else(|| line.split_once(". ").filter(|(n, _)| n.parse::<u32>().is_ok()).map(|(_, rest)| rest));
        if is_skipped {
            is_open = false;
        } else if is_open && item.is_none() {
            let last = found.last_mut().expect("an open paragraph");
            last.text += &format!(" {line}");
        } else {
            found.push(Paragraph { line: at + 1, text: item.unwrap_or(line).to_owned() });
            is_open = true;
        }
    }
    found
}

fn sentences(path: &str, line: usize, text: &str) -> Vec<Sentence> {
    const SHORT: [&str; 6] = ["Eq.", "Fig.", "e.g.", "i.e.", "vs.", "max."];
    let text = plain(text);
    let mut found = Vec::new();
    let mut words: Vec<&str> = Vec::new();
    let mut push = |words: &mut Vec<&str>| {
        let n_words = words.iter().filter(|word| word.contains(char::is_alphanumeric)).count();
        if n_words > 0 {
            found.push(Sentence { path: path.to_owned(), line, n_words, text: words.join(" ") });
        }
        words.clear();
    };
    for word in text.split_whitespace() {
        words.push(word);
        let bare = word.trim_end_matches([')', '"', '*', '\'']);
        if bare.ends_with(['.', '!', '?']) && !SHORT.contains(&bare.trim_start_matches('(')) {
            push(&mut words);
        }
    }
    push(&mut words);
    found
}

/// Text as it is read: code is one word, a link its text, a placeholder one word.
fn plain(text: &str) -> String {
    let (mut out, mut rest) = (String::new(), text);
    while let Some(at) = rest.find(['`', '{', ']']) {
        out += &rest[..at];
        let close = match rest.as_bytes()[at] {
            b'`' => rest[at + 1..].find('`').map(|end| (at + end + 2, "code")),
            b'{' => rest[at + 1..].find('}').map(|end| (at + end + 2, "n")),
            _ if rest[at + 1..].starts_with('(') => rest[at..].find(')').map(|end| (at + end + 1, "")),
            _ => None,
        };
        let (next, word) = close.unwrap_or((at + 1, ""));
        out += word;
        rest = &rest[next..];
    }
    out + rest
}

pub fn glossary(text: &str) -> Vec<Entry> {
    let mut found: Vec<Entry> = Vec::new();
    let starts = text.lines().enumerate().filter_map(|(at, line)| line.strip_prefix("## ").map(|term| (at, term)));
    for (at, term) in starts {
        let body: Vec<&str> = text.lines().skip(at + 1).take_while(|line| !line.starts_with("## ")).collect();
        let also: String = body
            .iter()
            .skip_while(|line| !line.starts_with("Also: "))
            .take_while(|line| !line.is_empty())
            .copied()
            .collect::<Vec<_>>()
            .join(" ");
        let others = also.trim_start_matches("Also: ").trim_end_matches('.').split(", ").filter(|name| !name.is_empty());
        let names = std::iter::once(term).chain(others).map(str::to_owned).collect();
        let is_text = |line: &&&str| !line.starts_with("More: ");
        let text = body.iter().filter(is_text).copied().collect::<Vec<_>>().join("\n").replace(&also.replace(' ', "\n"), "");
        let is_also = |paragraph: &&Paragraph| !paragraph.text.starts_with("Also: ");
        let n_sentences = paragraphs(&text).iter().filter(is_also).flat_map(|paragraph| sentences("", 0, &paragraph.text)).count();
        found.push(Entry { term: term.to_owned(), line: at + 1, names, n_sentences });
    }
    found
}
