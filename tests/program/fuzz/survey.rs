//! Many changed inputs on a reader: what it answers, shrunk where it should not.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Once;
use std::time::{Duration, Instant};

use rayon::prelude::*;
use serde_json::Value;

use crate::draws::{Draws, asked};
use crate::watch::{TO_STOP, within};
use crate::{bytes, structure};

/// A kind of input and what reads it.
pub struct Format {
    pub name: &'static str,
    pub texts: Vec<Vec<u8>>,
    /// The same as JSON, for changes of their structure; empty for other formats.
    pub files: Vec<Value>,
    /// Reads an input as far as the program does; the message of the error if it is refused. A
    /// panic is a fault.
    pub read: fn(&[u8]) -> Result<(), String>,
}

/// Longest message of an error (characters), of some 25 lines.
const LONGEST_MESSAGE: usize = 12_000;
/// Time of an input, which a machine that is busy may need (s).
const LIMIT: Duration = Duration::from_secs(10);
/// Attempts and time to shrink an input.
const MOST_ATTEMPTS: usize = 2000;
const LONGEST_SHRINKING: Duration = Duration::from_secs(20);

/// A fault: where it happened, and the input.
struct Fault {
    place: String,
    seed: u64,
    input: Vec<u8>,
}

thread_local! {
    static PLACE: RefCell<Option<String>> = const { RefCell::new(None) };
    static IS_GUARDED: RefCell<bool> = const { RefCell::new(false) };
}

/// Keeps the place of a panic of a reader instead of printing it.
fn take_note_of_panics() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let otherwise = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |info| {
            if IS_GUARDED.with_borrow(|is| *is) {
                let place = info.location().map_or_else(String::new, |at| format!("{}:{}", at.file(), at.line()));
                let message = info.payload_as_str().unwrap_or_default();
                PLACE.set(Some(format!("{place}: {}", message.chars().take(300).collect::<String>())));
            } else {
                otherwise(info);
            }
        }));
    });
}

/// What went wrong with an input; `None` if nothing did. The answer says whether it was accepted.
fn fault(format: &Format, about: &str, input: &[u8]) -> (Option<String>, bool) {
    PLACE.set(None);
    let was = IS_GUARDED.replace(true);
    let answer = catch_unwind(AssertUnwindSafe(|| within(LIMIT, about, || (format.read)(input))));
    IS_GUARDED.set(was);
    match answer {
        Err(_) => (Some(PLACE.take().unwrap_or_default()), false),
        Ok((_, time)) if time > LIMIT + TO_STOP => (Some("it takes too long".to_owned()), false),
        Ok((Some(Err(told)), _)) => (bad_message(&told, input), false),
        Ok((answer, _)) => (None, answer.is_some()),
    }
}

fn bad_message(told: &str, input: &[u8]) -> Option<String> {
    if told.chars().count() > LONGEST_MESSAGE {
        return Some(format!("a message of {} lines that is too long", told.lines().count()));
    }
    let has_nan = |text: &str| text.split(|letter: char| !letter.is_ascii_alphanumeric()).any(|word| word == "NaN");
    let is_new = has_nan(told) && !has_nan(&String::from_utf8_lossy(input));
    is_new.then(|| format!("a message with NaN: {}", told.chars().take(500).collect::<String>()))
}

/// The beginning of a place: the file and the line, or all of it.
fn key(place: &str) -> &str {
    place.split(": ").next().unwrap_or_default()
}

/// The input of a seed.
fn input(format: &Format, seed: u64) -> Vec<u8> {
    let mut draws = Draws::new(seed);
    if !format.files.is_empty() && draws.is(0.7) {
        structure::changed(&format.files, &mut draws)
    } else {
        bytes::changed(&format.texts, &mut draws)
    }
}

/// Reads `usual` changed inputs, or as many as are asked for.
///
/// # Panics
/// When an input breaks what must hold, with its seed and the smallest form of it.
pub fn survey(format: &Format, usual: u64) {
    take_note_of_panics();
    // States that the program has saved are read here, as by itself.
    cohaul_report::manifest::built_from(option_env!("COHAUL_COMMIT"));
    let (first, count) = (asked("COHAUL_SEED", 1), asked("COHAUL_COUNT", usual));
    let clock = Instant::now();
    for text in &format.texts {
        let (fault, is_accepted) = fault(format, format.name, text);
        assert!(fault.is_none() && is_accepted, "{}: unchanged: {fault:?}: {}", format.name, String::from_utf8_lossy(text));
    }
    let one = |seed: u64| {
        let input = input(format, seed);
        let (fault, is_accepted) = fault(format, &format!("{} {seed}", format.name), &input);
        (fault.map(|place| Fault { place, seed, input }), u64::from(is_accepted))
    };
    let found: Vec<_> = (first..first + count).into_par_iter().map(one).collect();
    let n_accepted: u64 = found.iter().map(|(_, n)| n).sum();
    let mut kinds: BTreeMap<String, (u64, Fault)> = BTreeMap::new();
    for fault in found.into_iter().filter_map(|(fault, _)| fault) {
        let kind = kinds.entry(key(&fault.place).to_owned()).or_insert_with(|| (0, Fault { place: String::new(), ..fault.copy() }));
        kind.0 += 1;
        if kind.1.place.is_empty() || fault.input.len() < kind.1.input.len() {
            kind.1 = fault;
        }
    }
    println!("{}: {count} inputs, {n_accepted} accepted, in {:.1} s", format.name, clock.elapsed().as_secs_f64());
    let told: Vec<String> = kinds.values().map(|(n, fault)| described(format, *n, fault)).collect();
    assert!(told.is_empty(), "{}:\n{}", format.name, told.join("\n\n"));
}

impl Fault {
    fn copy(&self) -> Self {
        Self { place: self.place.clone(), seed: self.seed, input: self.input.clone() }
    }
}

fn described(format: &Format, n: u64, fault: &Fault) -> String {
    let small = shrunk(format, fault);
    let text: String = String::from_utf8_lossy(&small).chars().take(4000).collect();
    format!("{} of seed {} and {} more: {text}", fault.place, fault.seed, n - 1)
}

/// A smaller input with the same fault.
fn shrunk(format: &Format, fault: &Fault) -> Vec<u8> {
    let (clock, mut n_left) = (Instant::now(), MOST_ATTEMPTS);
    let mut is_same = |input: &[u8]| {
        if n_left == 0 || clock.elapsed() > LONGEST_SHRINKING {
            return false;
        }
        n_left -= 1;
        self::fault(format, "shrinking", input).0.is_some_and(|place| key(&place) == key(&fault.place))
    };
    let mut small = fault.input.clone();
    if let Ok(mut value) = serde_json::from_slice::<Value>(&small) {
        while let Some(less) = structure::without_a_part(&value).into_iter().find(|less| is_same(less.to_string().as_bytes())) {
            small = less.to_string().into_bytes();
            value = less;
        }
    }
    let mut length = small.len() / 2;
    while length > 0 {
        let mut at = 0;
        while at < small.len() {
            let less = [&small[..at], &small[small.len().min(at + length)..]].concat();
            if is_same(&less) { small = less } else { at += length }
        }
        length /= 2;
    }
    small
}
