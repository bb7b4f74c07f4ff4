//! Files of the repository, as text and as tokens.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use proc_macro2::{Delimiter, TokenStream, TokenTree};

/// A token with its first and last line.
#[derive(Clone, Debug)]
pub struct Token {
    pub kind: Kind,
    pub text: String,
    pub line: usize,
    pub end: usize,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    Ident,
    Punct,
    Literal,
    Open,
    Close,
}

/// A Rust file.
pub struct Source {
    /// From the root of the repository, with slashes.
    pub path: String,
    pub text: String,
    /// Without modules for tests; a doc comment is an attribute `doc`.
    pub tokens: Vec<Token>,
}

/// A path such as `crate::math::Vec2`, or one leaf of a tree of imports.
pub struct PathName {
    pub names: Vec<String>,
    pub line: usize,
    /// Whether it is handed on by `pub use`.
    pub is_reexport: bool,
}

pub struct Function {
    pub name: String,
    pub line: usize,
    pub n_lines: usize,
}

/// Text for people: a doc comment or a string.
pub struct Text {
    pub line: usize,
    pub text: String,
    pub is_doc: bool,
}

pub fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

/// All files below a folder, from the root of the repository.
pub fn files_below(folder: &str) -> Vec<String> {
    let Ok(entries) = fs::read_dir(root().join(folder)) else { return Vec::new() };
    let mut names: Vec<(String, bool)> = entries
        .map(|entry| entry.expect("a folder can be read"))
        .map(|entry| (entry.file_name().to_string_lossy().into_owned(), entry.file_type().is_ok_and(|kind| kind.is_dir())))
        .collect();
    names.sort();
    names
        .into_iter()
        .flat_map(|(name, is_folder)| {
            let path = format!("{folder}/{name}");
            if is_folder { files_below(&path) } else { vec![path] }
        })
        .collect()
}

pub fn rust_files(folder: &str) -> Vec<Source> {
    let paths = files_below(folder).into_iter().filter(|path| path.ends_with(".rs"));
    paths.map(|path| Source::new(&path, &fs::read_to_string(root().join(&path)).expect("a file can be read"))).collect()
}

/// README, book and the texts beside results and clusters.
pub fn markdown_files() -> Vec<(String, String)> {
    let folders = ["docs/src", "results", "clusters"].iter().flat_map(|folder| files_below(folder));
    let paths = std::iter::once("README.md".to_owned()).chain(folders.filter(|path| path.ends_with(".md")));
    paths.map(|path| (fs::read_to_string(root().join(&path)).expect("a page can be read"), path)).map(|(text, path)| (path, text)).collect()
}

impl Source {
    pub fn new(path: &str, text: &str) -> Self {
        let stream: TokenStream = text.parse().unwrap_or_else(|error| panic!("{path}: {error}"));
        let mut tokens = Vec::new();
        flatten(stream, &mut tokens);
        Self { path: path.to_owned(), text: text.to_owned(), tokens: without_tests(tokens) }
    }

    /// The folder right below `src`.
    pub fn folder(&self) -> Option<&str> {
        let inside = self.path.strip_prefix("src/")?;
        inside.split_once('/').map(|(folder, _)| folder)
    }

    pub fn is_test(&self) -> bool {
        Path::new(&self.path).file_name().is_some_and(|name| name == "tests.rs")
    }

    /// Lines with code: neither blank nor comment, outside of modules for tests.
    pub fn n_code_lines(&self) -> usize {
        n_lines(&self.without_docs())
    }

    /// Tokens without attributes `doc`.
    fn without_docs(&self) -> Vec<Token> {
        let mut kept: Vec<Token> = Vec::new();
        let mut at = 0;
        while at < self.tokens.len() {
            match self.doc_at(at) {
                Some(length) => at += length,
                None => {
                    kept.push(self.tokens[at].clone());
                    at += 1;
                }
            }
        }
        kept
    }

    /// Number of tokens of a doc comment that begins here.
    fn doc_at(&self, at: usize) -> Option<usize> {
        let is = |at: usize, text: &str| self.tokens.get(at).is_some_and(|token| token.text == text);
        let inner = usize::from(is(at + 1, "!"));
        (is(at, "#") && is(at + 1 + inner, "[") && is(at + 2 + inner, "doc") && is(at + 3 + inner, "=")).then_some(6 + inner)
    }

    pub fn functions(&self) -> Vec<Function> {
        let tokens = self.without_docs();
        let mut found = Vec::new();
        for at in 0..tokens.len() {
            let is_named = tokens[at].text == "fn" && tokens.get(at + 1).is_some_and(|token| token.kind == Kind::Ident);
            let Some(open) = is_named.then(|| body_after(&tokens, at)).flatten() else { continue };
            let close = closing(&tokens, open);
            found.push(Function { name: tokens[at + 1].text.clone(), line: tokens[at].line, n_lines: n_lines(&tokens[at..=close]) });
        }
        found
    }

    /// Every path that starts with `crate`, `super`, `self` or a name, as far as it is one of
    /// modules.
    pub fn paths(&self) -> Vec<PathName> {
        let tokens = &self.tokens;
        let mut found = Vec::new();
        let mut at = 0;
        while at < tokens.len() {
            let is_use = tokens[at].text == "use" && tokens[at].kind == Kind::Ident;
            let is_path = ["crate", "super", "self"].contains(&tokens[at].text.as_str()) && is_colons(tokens, at + 1);
            if is_use {
                let is_reexport = at > 0 && (tokens[at - 1].text == "pub" || tokens[at - 1].text == ")");
                at = tree(tokens, at + 1, &[], is_reexport, &mut found);
            } else if is_path && (at == 0 || tokens[at - 1].text != "in") {
                at = tree(tokens, at, &[], false, &mut found);
            } else {
                at += 1;
            }
        }
        found
    }

    /// Names that may be those of crates, in imports, paths and attributes: no module of the file's
    /// own.
    pub fn crates_named(&self) -> Vec<(String, usize)> {
        let (tokens, own) = (&self.tokens, self.definitions());
        let is_first = |at: usize| at < 2 || !is_colons(tokens, at - 2);
        let is_used = |at: usize| is_colons(tokens, at + 1) || (at > 0 && tokens[at - 1].text == "use");
        let idents = (0..tokens.len()).filter(|at| tokens[*at].kind == Kind::Ident && !own.contains(tokens[*at].text.as_str()));
        idents.filter(|at| is_first(*at) && is_used(*at)).map(|at| (tokens[at].text.clone(), tokens[at].line)).collect()
    }

    /// Doc comments and strings, but for alternative names of arguments and keys.
    pub fn texts(&self) -> Vec<Text> {
        let mut found: Vec<Text> = Vec::new();
        for (at, token) in self.tokens.iter().enumerate().filter(|(_, token)| token.kind == Kind::Literal) {
            let Some(text) = unquoted(&token.text) else { continue };
            let before = |n: usize| at.checked_sub(n).map_or("", |at| self.tokens[at].text.as_str());
            if before(1) == "=" && before(2) == "alias" || before(1) == "[" && before(2) == "=" {
                continue;
            }
            let is_doc = before(1) == "=" && before(2) == "doc";
            match found.last_mut().filter(|last| is_doc && last.is_doc && token.line == last.line + last.text.lines().count()) {
                Some(last) => last.text += &format!("\n{text}"),
                None => found.push(Text { line: token.line, text, is_doc }),
            }
        }
        found
    }

    /// Names and lines of constants that are numbers, or lists of numbers.
    pub fn numeric_constants(&self) -> Vec<(&str, usize)> {
        const NUMBERS: [&str; 10] = ["f32", "f64", "Real", "i32", "i64", "u8", "u16", "u32", "u64", "usize"];
        let is = |at: usize, text: &str| self.tokens.get(at).is_some_and(|token| token.text == text);
        let is_numeric = |at: &usize| {
            let kind = at + 3 + usize::from(is(at + 3, "["));
            let end = if kind == at + 3 { kind } else { closing(&self.tokens, at + 3) };
            NUMBERS.iter().any(|number| is(kind, number)) && is(end + 1, "=")
        };
        let constants = (0..self.tokens.len()).filter(|at| is(*at, "const") && is(at + 2, ":")).filter(is_numeric);
        constants.map(|at| (self.tokens[at + 1].text.as_str(), self.tokens[at].line)).collect()
    }

    /// Names that the file defines, at its top level or within its items.
    pub fn definitions(&self) -> BTreeSet<&str> {
        const KEYWORDS: [&str; 9] = ["fn", "struct", "enum", "trait", "type", "const", "static", "union", "mod"];
        let pairs = self.tokens.windows(2).filter(|pair| KEYWORDS.contains(&pair[0].text.as_str()) && pair[1].kind == Kind::Ident);
        let macros = self.tokens.windows(3).filter(|three| three[0].text == "macro_rules");
        pairs.map(|pair| pair[1].text.as_str()).chain(macros.map(|three| three[2].text.as_str())).collect()
    }
}

fn flatten(stream: TokenStream, into: &mut Vec<Token>) {
    for tree in stream {
        let (start, end) = (tree.span().start().line, tree.span().end().line);
        let mut push = |kind, text: String, line, end| into.push(Token { kind, text, line, end });
        match tree {
            TokenTree::Ident(ident) => push(Kind::Ident, ident.to_string(), start, end),
            TokenTree::Punct(punct) => push(Kind::Punct, punct.as_char().to_string(), start, end),
            TokenTree::Literal(literal) => push(Kind::Literal, literal.to_string(), start, end),
            TokenTree::Group(group) => {
                let (open, close) = match group.delimiter() {
                    Delimiter::Brace => ("{", "}"),
                    Delimiter::Bracket => ("[", "]"),
                    Delimiter::Parenthesis | Delimiter::None => ("(", ")"),
                };
                push(Kind::Open, open.to_owned(), start, start);
                flatten(group.stream(), into);
                into.push(Token { kind: Kind::Close, text: close.to_owned(), line: end, end });
            }
        }
    }
}

/// Leaves out `#[cfg(test)] mod name { .. }`, of any visibility.
fn without_tests(tokens: Vec<Token>) -> Vec<Token> {
    let mut kept = Vec::new();
    let mut at = 0;
    while at < tokens.len() {
        match test_module_body(&tokens, at) {
            Some(open) => at = closing(&tokens, open) + 1,
            None => {
                kept.push(tokens[at].clone());
                at += 1;
            }
        }
    }
    kept
}

/// Index of the brace that opens the body of the test module whose attribute begins at `at`.
fn test_module_body(tokens: &[Token], at: usize) -> Option<usize> {
    const ATTRIBUTE: [&str; 7] = ["#", "[", "cfg", "(", "test", ")", "]"];
    let is = |at: usize, text: &str| tokens.get(at).is_some_and(|token| token.text == text);
    if !ATTRIBUTE.iter().enumerate().all(|(i, text)| is(at + i, text)) {
        return None;
    }
    let mut item = at + ATTRIBUTE.len();
    if is(item, "pub") {
        item = if is(item + 1, "(") { closing(tokens, item + 1) + 1 } else { item + 1 };
    }
    (is(item, "mod") && is(item + 2, "{")).then_some(item + 2)
}

/// Index of the token that closes the group that opens at `open`.
fn closing(tokens: &[Token], open: usize) -> usize {
    let mut depth = 0;
    for (at, token) in tokens.iter().enumerate().skip(open) {
        match token.kind {
            Kind::Open => depth += 1,
            Kind::Close => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            return at;
        }
    }
    tokens.len() - 1
}

/// Index of the brace that opens the body of the function whose `fn` stands at `at`.
fn body_after(tokens: &[Token], at: usize) -> Option<usize> {
    let mut i = at;
    while i < tokens.len() {
        match (tokens[i].kind, tokens[i].text.as_str()) {
            (Kind::Open, "{") => return Some(i),
            (Kind::Open, _) => i = closing(tokens, i),
            (Kind::Punct, ";") => return None,
            _ => {}
        }
        i += 1;
    }
    None
}

fn n_lines(tokens: &[Token]) -> usize {
    tokens.iter().flat_map(|token| token.line..=token.end).collect::<BTreeSet<_>>().len()
}

fn is_colons(tokens: &[Token], at: usize) -> bool {
    [at, at + 1].iter().all(|at| tokens.get(*at).is_some_and(|token| token.text == ":"))
}

/// Reads a path or a tree of imports and gives the index behind it.
fn tree(tokens: &[Token], mut at: usize, before: &[String], is_reexport: bool, found: &mut Vec<PathName>) -> usize {
    let mut names = before.to_vec();
    let line = tokens.get(at).map_or(0, |token| token.line);
    while let Some(token) = tokens.get(at) {
        if token.kind == Kind::Ident || token.text == "*" {
            names.push(token.text.clone());
            at += 1;
        } else if token.text == "{" {
            let end = closing(tokens, at);
            at += 1;
            while at < end {
                at = tree(tokens, at, &names, is_reexport, found);
                while at < end && (tokens[at].text == "," || tokens[at].text == "as" || tokens[at - 1].text == "as") {
                    at += 1;
                }
            }
            return end + 1;
        } else {
            break;
        }
        if !is_colons(tokens, at) {
            break;
        }
        at += 2;
    }
    if !names.is_empty() {
        found.push(PathName { names, line, is_reexport });
    }
    at.max(1)
}

/// What a string literal holds; `None` of another literal.
fn unquoted(literal: &str) -> Option<String> {
    let raw = literal.strip_prefix('r').map(|text| text.trim_matches('#'));
    let inside = raw.unwrap_or(literal).strip_prefix('"')?.strip_suffix('"')?;
    if raw.is_some() {
        return Some(inside.to_owned());
    }
    let mut text = String::new();
    let mut chars = inside.chars().peekable();
    while let Some(char) = chars.next() {
        match (char, chars.peek().copied()) {
            ('\\', Some('n')) => {
                chars.next();
                text.push('\n');
            }
            ('\\', Some('\n')) => while chars.next_if(|char| char.is_whitespace()).is_some() {},
            ('\\', Some(escaped)) => {
                chars.next();
                text.push(escaped);
            }
            _ => text.push(char),
        }
    }
    Some(text)
}
