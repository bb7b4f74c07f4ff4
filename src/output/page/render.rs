//! A page as HTML.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use sha2::{Digest, Sha256};

use crate::output::page::replay::Replay;
use crate::output::page::{Answer, Block, Headline, Number, Page, Section, Table, escape, provenance, terms};

const STYLE: &str = include_str!("page.css");
const SCRIPT: &str = include_str!("replay.js");

/// The whole file.
pub fn page(page: &Page) -> String {
    let mut out = Writer::default();
    let title = escape::text(&page.title);
    // Nothing may be loaded or sent; of scripts only the one whose hash stands here.
    let hash = STANDARD.encode(Sha256::digest(SCRIPT));
    let policy = format!(
        "default-src 'none'; script-src 'sha256-{hash}'; style-src 'unsafe-inline'; img-src data:; base-uri 'none'; form-action 'none'"
    );
    out.line(&format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta http-equiv=\"Content-Security-Policy\" content=\"{policy}\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<meta name=\"color-scheme\" content=\"light dark\">\n\
         <title>{title}</title>\n<link rel=\"icon\" href=\"data:,\">\n<style>\n{STYLE}</style>\n</head>\n<body>\n<header>\n<p class=\"kicker\">cohaul</p>\n<h1>{title}</h1>\n</header>\n<main>"
    ));
    out.headline(&page.headline);
    let provenance = page.provenance.as_ref().map(provenance::section);
    page.sections.iter().chain(&provenance).for_each(|section| out.section(section));
    out.line("</main>");
    if out.n_replays > 0 {
        out.line(&format!("<script>{SCRIPT}</script>"));
    }
    out.line("</body>\n</html>");
    out.html
}

/// HTML so far.
#[derive(Default)]
struct Writer {
    html: String,
    n_figures: usize,
    n_replays: usize,
}

impl Writer {
    fn line(&mut self, html: &str) {
        self.html.push_str(html);
        self.html.push('\n');
    }

    fn headline(&mut self, headline: &Headline) {
        let (class, sign) = match headline.answer {
            Answer::Yes => ("yes", "✓"),
            Answer::No => ("no", "✗"),
            Answer::Open => ("open", "?"),
            Answer::None => ("none", ""),
        };
        let sentence = escape::text(&escape::unbroken(&headline.sentence));
        let sign = if sign.is_empty() { String::new() } else { format!("<span class=\"sign\" aria-hidden=\"true\">{sign}</span>") };
        self.line(&format!("<section class=\"headline {class}\" id=\"verdict\">\n<p class=\"verdict\">{sign}<span>{sentence}</span></p>"));
        headline.blocks.iter().for_each(|block| self.block(block));
        self.line("</section>");
    }

    fn section(&mut self, section: &Section) {
        self.line(&format!("<section>\n<h2>{}</h2>", escape::text(&section.heading)));
        section.blocks.iter().for_each(|block| self.block(block));
        self.line("</section>");
    }

    fn block(&mut self, block: &Block) {
        match block {
            Block::Text(text) => self.line(&format!("<p>{}</p>", escape::text(&escape::unbroken(text)))),
            Block::Code(text) => self.line(&format!("<pre>{}</pre>", escape::text(text))),
            Block::List(items) => {
                let items: String = items.iter().map(|item| format!("<li>{}</li>", escape::text(&escape::unbroken(item)))).collect();
                self.line(&format!("<ul>{items}</ul>"));
            }
            Block::Numbers(numbers) => self.numbers(numbers),
            Block::Table(table) => self.table(table),
            Block::Figure { svg, caption } => self.figure("drawing", svg, caption),
            Block::Chart { svg, caption } => self.figure("chart", svg, caption),
            Block::Replay(replay) => self.replay(replay),
            Block::Columns(columns) => {
                self.line("<div class=\"columns\">");
                for blocks in columns {
                    self.line("<div>");
                    blocks.iter().for_each(|block| self.block(block));
                    self.line("</div>");
                }
                self.line("</div>");
            }
            Block::Folded { heading, blocks } => {
                self.line(&format!("<details><summary>{}</summary>", escape::text(heading)));
                blocks.iter().for_each(|block| self.block(block));
                self.line("</details>");
            }
            Block::Terms(terms) => {
                let term = |(word, meaning): &(&str, &str)| format!("<dt>{}</dt><dd>{}</dd>", escape::text(word), escape::text(meaning));
                self.line(&format!("<dl class=\"terms\">{}</dl>", terms.iter().map(term).collect::<String>()));
            }
        }
    }

    fn numbers(&mut self, numbers: &[Number]) {
        self.line("<dl class=\"numbers\">");
        for Number { name, value, note } in numbers {
            let note = if note.is_empty() {
                String::new()
            } else {
                format!(" <span class=\"note\">{}</span>", escape::text(&escape::unbroken(note)))
            };
            self.line(&format!("<div><dt>{}</dt><dd><b>{}</b>{note}</dd></div>", explained(name), escape::text(value)));
        }
        self.line("</dl>");
    }

    fn table(&mut self, table: &Table) {
        let head: String = table.head.iter().map(|cell| format!("<th scope=\"col\">{}</th>", escape::text(cell))).collect();
        let caption = escape::text(&table.caption);
        // Its own region, so that a wide table scrolls by itself, by keyboard too.
        self.line(&format!(
            "<div class=\"wide\" tabindex=\"0\" role=\"region\" aria-label=\"{caption}\"><table><caption>{caption}</caption><thead><tr>{head}</tr></thead><tbody>"
        ));
        for row in &table.rows {
            let mut cells = row.iter();
            let name = cells.next().map_or(String::new(), |cell| format!("<th scope=\"row\">{}</th>", explained(cell)));
            let cells: String = cells.map(|cell| format!("<td{}>{}</td>", class_of(cell), escape::text(cell))).collect();
            self.line(&format!("<tr>{name}{cells}</tr>"));
        }
        self.line("</tbody></table></div>");
    }

    fn figure(&mut self, class: &str, svg: &str, caption: &str) {
        self.n_figures += 1;
        let (svg, caption) = (escape::svg(svg, self.n_figures), escape::text(caption));
        self.line(&format!(
            "<figure class=\"{class}\"><div class=\"wide\" tabindex=\"0\" role=\"img\" aria-label=\"{caption}\">{svg}</div><figcaption>{caption}</figcaption></figure>"
        ));
    }

    /// A place for the script to draw in, and its data.
    fn replay(&mut self, replay: &Replay) {
        self.n_replays += 1;
        let (name, data) = (escape::text(&replay.name), escape::script_data(&replay.data));
        let notes: String = replay.caption.iter().map(|note| format!("<li>{}</li>", escape::text(&escape::unbroken(note)))).collect();
        self.line(&format!(
            "<figure class=\"replay\" aria-label=\"{name}\"><div class=\"stage\"><noscript><p>The replay needs JavaScript, which is part of this file.</p></noscript></div>\
             <script type=\"application/json\">{data}</script><figcaption><p>{name}</p><details><summary>How to read it</summary><ul>{notes}</ul></details></figcaption></figure>"
        ));
    }
}

/// A word with its meaning at hand, where it has one of its own here.
fn explained(word: &str) -> String {
    let text = escape::text(word);
    terms::meaning(word).map_or(text.clone(), |meaning| format!("<abbr title=\"{}\">{text}</abbr>", escape::text(meaning)))
}

/// More letters are a text that begins with a number (1).
const LONGEST_NUMBER: usize = 28;

/// Numbers stand under each other.
fn class_of(cell: &str) -> &'static str {
    if cell.chars().count() > LONGEST_NUMBER {
        return "";
    }
    let mut letters = cell.trim_start_matches(['-', '−', '+']).chars();
    if letters.next().is_some_and(|letter| letter.is_ascii_digit()) { " class=\"number\"" } else { "" }
}
