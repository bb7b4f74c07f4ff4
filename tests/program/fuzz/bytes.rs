//! Changes of any text: bits, cuts, repetitions, parts of other texts and odd tokens.

use crate::draws::Draws;

/// What readers of numbers, tables and JSON may trip over.
const TOKENS: [&str; 40] = [
    "1e308",
    "-0",
    "NaN",
    "",
    "inf",
    "-1",
    "0",
    "5e-324",
    "1e999",
    "1e-300",
    "null",
    "true",
    "{}",
    "[]",
    "\"",
    "\\u0000",
    "\\ud800",
    "\u{feff}",
    "ü",
    "\u{1F600}",
    "\u{202e}",
    "\0",
    ",",
    ";",
    "\n",
    "\r\n",
    "\t",
    "..",
    ":",
    "log:",
    "/",
    "0/0",
    "18446744073709551616",
    "9223372036854775808",
    "0x10",
    "1_000",
    "=",
    "*",
    "[0]",
    "release",
];

/// Numbers at the ends of what floats and whole numbers hold.
pub const NUMBERS: [&str; 20] = [
    "0",
    "-0.0",
    "-1",
    "1",
    "2",
    "0.5",
    "5e-324",
    "1e-300",
    "1e-50",
    "1e-20",
    "1e-9",
    "1e9",
    "1e20",
    "1e50",
    "1e300",
    "1.7976931348623157e308",
    "-1e300",
    "4294967296",
    "18446744073709551615",
    "1e-3",
];

/// Longest input (bytes).
pub const LONGEST: usize = 1 << 19;

pub fn one_of<'a, T>(list: &'a [T], draws: &mut Draws) -> &'a T {
    &list[draws.below(list.len())]
}

/// One of the texts, changed in a few places.
pub fn changed(texts: &[Vec<u8>], draws: &mut Draws) -> Vec<u8> {
    let mut text = one_of(texts, draws).clone();
    for _ in 0..=draws.below(4) {
        change(&mut text, texts, draws);
        text.truncate(LONGEST);
    }
    text
}

fn change(text: &mut Vec<u8>, texts: &[Vec<u8>], draws: &mut Draws) {
    let at = draws.below(text.len() + 1);
    // Short parts are the most frequent.
    let end = text.len().min(at + (1.0 / draws.unit()) as usize);
    match draws.below(10) {
        0 if at < text.len() => text[at] ^= 1 << draws.below(8),
        1 if at < text.len() => text[at] = draws.below(256) as u8,
        2 => drop(text.drain(at..end)),
        3 => {
            let part = text[at..end].repeat(1 + draws.below(20));
            drop(text.splice(at..at, part));
        }
        4 => {
            let other = one_of(texts, draws);
            let from = draws.below(other.len() + 1);
            text.truncate(at);
            text.extend_from_slice(&other[from..]);
        }
        5 | 6 => drop(text.splice(at..at, one_of(&TOKENS, draws).bytes())),
        7 => replace_number(text, at, draws),
        8 => move_line(text, draws),
        _ if draws.is(0.02) => {
            let part = one_of(&["[", "{\"a\":", "0,", "9", "\"\",", "\n", "1e5,"], draws);
            drop(text.splice(at..at, part.repeat(1 + draws.below(100_000)).into_bytes()));
        }
        _ => text.truncate(end),
    }
}

/// Puts an odd number in the place of the first one from `at` on.
fn replace_number(text: &mut Vec<u8>, at: usize, draws: &mut Draws) {
    let Some(begin) = text[at..].iter().position(u8::is_ascii_digit).map(|n| at + n) else { return };
    let is_of_number = |byte: &u8| byte.is_ascii_digit() || b".eE+-".contains(byte);
    let end = text[begin..].iter().position(|byte| !is_of_number(byte)).map_or(text.len(), |n| begin + n);
    drop(text.splice(begin..end, one_of(&NUMBERS, draws).bytes()));
}

/// Takes a line out, and puts it elsewhere up to three times.
fn move_line(text: &mut Vec<u8>, draws: &mut Draws) {
    let mut lines: Vec<Vec<u8>> = text.split_inclusive(|byte| *byte == b'\n').map(<[u8]>::to_vec).collect();
    if lines.is_empty() {
        return;
    }
    let line = lines.remove(draws.below(lines.len()));
    for _ in 0..draws.below(4) {
        lines.insert(draws.below(lines.len() + 1), line.clone());
    }
    *text = lines.concat();
}
