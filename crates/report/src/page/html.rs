//! A page as HTML.

use std::sync::LazyLock;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use maud::{DOCTYPE, Markup, PreEscaped, html};
use serde::Serialize;
use sha2::{Digest, Sha256};

use crate::glossary;
use crate::json;
use crate::page::content::{Answer, Block, Headline, Number, Page, Section};
use crate::page::curves::Curves;
use crate::page::provenance;
use crate::page::replay::Replay;
use crate::table::Table;

/// The look of a page.
pub const STYLE: &str = include_str!("page.css");
/// The script that the live page shares with a replay: poses, drawing, stage.
pub const SCRIPT_OF_SCENES: &str = concat!(
    "\n",
    include_str!("script/base.js"),
    include_str!("script/parts.js"),
    include_str!("script/view.js"),
    include_str!("script/stage.js")
);
/// The script of plots over time.
pub const SCRIPT_OF_CURVES: &str = include_str!("script/curves.js");
/// One module for all pages, in the order in which its parts build on each other.
static SCRIPT: LazyLock<String> = LazyLock::new(|| {
    [
        SCRIPT_OF_SCENES,
        include_str!("script/player.js"),
        SCRIPT_OF_CURVES,
        include_str!("script/figures.js"),
        include_str!("script/main.js"),
    ]
    .concat()
});

impl Page {
    /// The whole file.
    ///
    /// # Panics
    /// When a number of a replay is not finite.
    pub fn to_html(&self) -> String {
        let mut writer = Writer::default();
        let headline = writer.headline(&self.headline);
        let provenance = self.provenance.as_ref().map(provenance::section);
        let sections: Vec<Markup> = self.sections.iter().chain(&provenance).map(|section| writer.section(section)).collect();
        // Nothing may be loaded or sent; of scripts only the one with this hash may run.
        let hash = STANDARD.encode(Sha256::digest(SCRIPT.as_bytes()));
        let policy = format!(
            "default-src 'none'; script-src 'sha256-{hash}'; style-src 'unsafe-inline'; img-src data:; base-uri 'none'; form-action 'none'"
        );
        let page = html! {
            (DOCTYPE)
            html lang="en" {
                head {
                    meta charset="utf-8";
                    meta http-equiv="Content-Security-Policy" content=(policy);
                    meta name="viewport" content="width=device-width, initial-scale=1";
                    meta name="color-scheme" content="light dark";
                    title { (self.title) }
                    link rel="icon" href="data:,";
                    style { (PreEscaped(STYLE)) }
                }
                body {
                    header { p.kicker { "cohaul" } h1 { (self.title) } }
                    main { (headline) @for section in sections { (section) } }
                    script type="module" { (PreEscaped(SCRIPT.as_str())) }
                }
            }
        };
        page.into_string() + "\n"
    }
}

/// What was written so far.
#[derive(Default)]
struct Writer {
    n_figures: usize,
    /// Text that a reader has seen, in lower case.
    seen: String,
}

impl Writer {
    fn headline(&mut self, headline: &Headline) -> Markup {
        let (class, sign) = match headline.answer {
            Answer::Yes => ("yes", "✓"),
            Answer::No => ("no", "✗"),
            Answer::Partly => ("open", "~"),
            Answer::Open => ("open", "?"),
            Answer::None => ("none", ""),
        };
        let sentence = self.text(&headline.sentence);
        html! {
            section class={ "headline " (class) } id="verdict" {
                p.verdict { @if !sign.is_empty() { span.sign aria-hidden="true" { (sign) } } span { (sentence) } }
                (self.blocks(&headline.blocks))
            }
        }
    }

    fn section(&mut self, section: &Section) -> Markup {
        html! { section { h2 { (self.text(&section.heading)) } (self.blocks(&section.blocks)) } "\n" }
    }

    fn blocks(&mut self, blocks: &[Block]) -> Markup {
        html! { @for block in blocks { (self.block(block)) "\n" } }
    }

    fn block(&mut self, block: &Block) -> Markup {
        match block {
            Block::Text(text) => html! { p { (self.text(text)) } },
            Block::Code(text) => html! { pre { (text) } },
            Block::List(items) => html! { ul { @for item in items { li { (self.text(item)) } } } },
            Block::Numbers(numbers) => html! {
                dl.numbers { @for Number { name, value, note } in numbers {
                    div { dt { (self.explained(name)) } dd { b { (value) } @if !note.is_empty() { " " span.note { (self.text(note)) } } } }
                } }
            },
            Block::Table(table) => self.table(table),
            Block::Figure { svg, caption } => self.figure("drawing", svg, caption),
            Block::Chart { svg, caption } => self.figure("chart", svg, caption),
            Block::Replay(replay) => self.replay(replay),
            Block::Curves(curves) => self.curves(curves),
            Block::Columns(columns) => html! { div.columns { @for blocks in columns { div { (self.blocks(blocks)) } } } },
            Block::Folded { heading, blocks } => html! { details { summary { (self.text(heading)) } (self.blocks(blocks)) } },
            Block::Terms => self.terms(),
        }
    }

    /// A table in a region of its own, so that a wide one scrolls by itself, by keyboard too.
    fn table(&mut self, table: &Table) -> Markup {
        let cells = |row: &Vec<_>| -> Vec<String> {
            row.iter().zip(&table.columns).map(|(field, column): (&crate::table::Field, _)| field.text(column.unit)).collect()
        };
        let rows: Vec<Vec<String>> = table.rows.iter().map(cells).collect();
        html! {
            div.wide tabindex="0" role="region" aria-label=(table.caption) {
                table {
                    caption { (self.text(&table.caption)) }
                    thead { tr { @for column in &table.columns { th scope="col" { (self.text(&column.name)) } } } }
                    tbody { @for row in &rows { tr { @for (at, cell) in row.iter().enumerate() {
                        @if at == 0 { th scope="row" { (self.explained(cell)) } }
                        @else if is_number(cell) { td.number { (cell) } }
                        @else { td { (self.text(cell)) } }
                    } } } }
                }
            }
        }
    }

    fn figure(&mut self, class: &str, svg: &str, caption: &str) -> Markup {
        self.n_figures += 1;
        let svg = part_of_page(svg, self.n_figures);
        html! {
            figure class=(class) {
                div.wide tabindex="0" role="img" aria-label=(caption) { (PreEscaped(svg)) }
                figcaption { (self.text(caption)) }
            }
        }
    }

    /// A place for the script to draw in, and its data.
    fn replay(&mut self, replay: &Replay) -> Markup {
        html! {
            figure.replay aria-label=(replay.name) {
                div.stage { noscript { p { "The replay needs JavaScript, which is part of this file." } } }
                (data_element(&replay.data))
                figcaption {
                    p { (self.text(&replay.name)) }
                    details { summary { "How to read it" } ul { @for note in &replay.caption { li { (self.text(note)) } } } }
                }
            }
        }
    }

    /// A place for the script to draw plots in, and their data.
    fn curves(&mut self, curves: &Curves) -> Markup {
        html! {
            figure.curves aria-label=(curves.caption) {
                div.plots { noscript { p { "The curves need JavaScript, which is part of this file." } } }
                (data_element(&curves.plots))
                figcaption {
                    p { (self.text(&curves.caption)) }
                    p { "The upright line is the time of the replay: click on a plot to go there. Values below a plot are those under the pointer, or else those at this time." }
                }
            }
        }
    }

    /// Entries of the glossary for the terms that a reader has seen.
    fn terms(&self) -> Markup {
        let is_letter = |letter: Option<char>| letter.is_some_and(char::is_alphanumeric);
        let is_seen = |term: &str| {
            let term = term.to_lowercase();
            self.seen
                .match_indices(&term)
                .any(|(at, _)| !is_letter(self.seen[..at].chars().next_back()) && !is_letter(self.seen[at + term.len()..].chars().next()))
        };
        let entries = glossary::entries();
        let seen = entries.iter().filter(|entry| is_seen(entry.term) || entry.aliases.iter().any(|alias| is_seen(alias)));
        html! { dl.terms { @for entry in seen { dt { (entry.term) } dd { (entry.meaning) } } } }
    }

    /// Text whose numbers stay on the line of their units.
    fn text(&mut self, text: &str) -> String {
        self.seen.push_str(&text.to_lowercase());
        self.seen.push('\n');
        let mut whole = String::with_capacity(text.len());
        let mut words = text.split(' ').peekable();
        while let Some(word) = words.next() {
            whole.push_str(word);
            let Some(next) = words.peek() else { break };
            let is_unit = next.trim_end_matches(['.', ',', ';', ':', ')']).chars().count() <= 2;
            whole.push(if word.ends_with(|letter: char| letter.is_ascii_digit()) && is_unit { '\u{a0}' } else { ' ' });
        }
        whole
    }

    /// A term with its meaning at hand, if the glossary has it.
    fn explained(&mut self, term: &str) -> Markup {
        let text = self.text(term);
        html! { @if let Some(entry) = glossary::entry(term) { abbr title=(entry.meaning) { (text) } } @else { (text) } }
    }
}

/// Data for the script.
///
/// # Panics
/// When a number is not finite.
fn data_element(data: &impl Serialize) -> Markup {
    // No `<` can end the script element or open a comment.
    let data = json::line(data).unwrap_or_else(|error| panic!("{error}")).replace('<', "\\u003c");
    html! { script type="application/json" { (PreEscaped(data)) } }
}

/// A drawing made to stand alone, as a part of a page: without its XML declaration, and with names
/// that no other drawing of the page has.
fn part_of_page(document: &str, number: usize) -> String {
    let start = document.find("<svg").unwrap_or(0);
    let named = |text: String, before: &str| text.replace(before, &format!("{before}f{number}-"));
    ["id=\"", "url(#", "href=\"#"].into_iter().fold(document[start..].trim_end().to_owned(), named)
}

/// More letters are a text that begins with a number (1).
const LONGEST_NUMBER: usize = 28;

/// Whether a cell begins with a number and is short, so that it may not be broken.
fn is_number(cell: &str) -> bool {
    let begins = cell.trim_start_matches(['-', '−', '+']).starts_with(|letter: char| letter.is_ascii_digit());
    begins && cell.chars().count() <= LONGEST_NUMBER
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_keep_their_units() {
        let mut writer = Writer::default();
        assert_eq!(writer.text("up to 9.208 mm, 1.35 % of the path length"), "up to 9.208\u{a0}mm, 1.35\u{a0}% of the path length");
        assert_eq!(writer.text(" a  b 12"), " a  b 12");
    }

    #[test]
    fn drawings_of_one_page_share_no_names() {
        let drawing = "<?xml version=\"1.0\"?>\n<svg><clipPath id=\"a\"/><g clip-path=\"url(#a)\"/><use href=\"#a\"/></svg>\n";
        assert_eq!(part_of_page(drawing, 3), "<svg><clipPath id=\"f3-a\"/><g clip-path=\"url(#f3-a)\"/><use href=\"#f3-a\"/></svg>");
    }

    #[test]
    fn a_page_explains_the_terms_that_it_uses() {
        let blocks = vec![Block::text("The inertia effect exceeds the tolerance."), Block::Terms];
        let page = Page::new("a page", Headline::new(Answer::None, "An answer.")).section("Terms", blocks).to_html();
        assert!(page.contains("<dt>inertia effect</dt>") && !page.contains("<dt>zeta</dt>"), "{page}");
    }
}
