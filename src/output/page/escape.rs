//! Text and data inside HTML.

use serde::Serialize;

use crate::output::json;

/// `text` as HTML shows it, in elements and in attributes between double quotes. Characters that HTML forbids are left out.
pub fn text(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len() + 16);
    for letter in text.chars() {
        match letter {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            '\t' | '\n' => escaped.push(letter),
            control if control.is_control() => escaped.push('\u{fffd}'),
            _ => escaped.push(letter),
        }
    }
    escaped
}

/// `text` whose numbers stay on the line of their units.
pub fn unbroken(text: &str) -> String {
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

/// `data` as JSON that may stand in a script element: no `<` can end it or open a comment.
///
/// # Panics
/// When a number of `data` is not finite.
pub fn script_data(data: &impl Serialize) -> String {
    json::line(data).expect("what a page shows is plain data").replace('<', "\\u003c")
}

/// A drawing made to stand alone, as a part of a page: without its XML declaration, and with names that no other drawing of the page has.
pub fn svg(document: &str, number: usize) -> String {
    let start = document.find("<svg").unwrap_or(0);
    let named = |text: String, before: &str| text.replace(before, &format!("{before}f{number}-"));
    ["id=\"", "url(#", "href=\"#"].into_iter().fold(document[start..].trim_end().to_owned(), named)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_in_a_text_or_in_data_can_become_markup() {
        let hostile = "</script><b onclick='x()'>&\"\u{0}\u{1b}<!--";
        assert_eq!(text(hostile), "&lt;/script&gt;&lt;b onclick=&#39;x()&#39;&gt;&amp;&quot;\u{fffd}\u{fffd}&lt;!--");
        let data = script_data(&hostile);
        assert!(!data.contains('<'), "{data}");
        assert_eq!(serde_json::from_str::<String>(&data).unwrap(), hostile);
    }

    #[test]
    fn numbers_keep_their_units() {
        assert_eq!(unbroken("up to 9.208 mm, 1.35 % of its way"), "up to 9.208\u{a0}mm, 1.35\u{a0}% of its way");
        assert_eq!(unbroken(" a  b 12"), " a  b 12");
    }

    #[test]
    fn drawings_of_one_page_share_no_names() {
        let drawing = "<?xml version=\"1.0\"?>\n<svg><clipPath id=\"a\"/><g clip-path=\"url(#a)\"/><use href=\"#a\"/></svg>\n";
        assert_eq!(svg(drawing, 3), "<svg><clipPath id=\"f3-a\"/><g clip-path=\"url(#f3-a)\"/><use href=\"#f3-a\"/></svg>");
    }
}
