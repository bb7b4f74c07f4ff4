//! The rule by which instruction counts are held against their ceilings, and the file that these
//! stand in. The counting itself is `cargo instructions`.

#[allow(dead_code, reason = "the counter uses the rest")]
#[path = "../benches/instructions/ceilings.rs"]
mod ceilings;

use std::collections::BTreeMap;
use std::fs;

use ceilings::{Ceilings, Finding, ceiling};

fn some_ceilings() -> Ceilings {
    let instructions_per_call = BTreeMap::from([("step".to_owned(), 1000), ("tick".to_owned(), 200)]);
    Ceilings { build: "a build".to_owned(), compiler: "a compiler".to_owned(), margin: 0.05, instructions_per_call }
}

#[test]
fn one_instruction_above_the_ceiling_fails_and_the_ceiling_itself_does_not() {
    assert_eq!(ceiling(1000, 0.05), 1050);
    for (count, finding) in [(1051, Finding::Above), (1050, Finding::Within), (1000, Finding::Within)] {
        assert_eq!(Finding::of(count, Some(1000), 0.05), finding);
        assert_eq!(finding.fails(), count > 1050);
    }
    assert_eq!(Finding::of(1001, Some(1000), 0.0), Finding::Above, "without a margin not one more");
}

#[test]
fn a_path_that_is_a_tenth_faster_asks_for_a_lower_ceiling_and_passes() {
    for (count, finding) in [(900, Finding::Within), (899, Finding::WellBelow), (0, Finding::WellBelow)] {
        assert_eq!(Finding::of(count, Some(1000), 0.05), finding);
        assert!(!finding.fails());
    }
}

#[test]
fn a_path_without_a_ceiling_fails() {
    assert_eq!(Finding::of(1, None, 0.05), Finding::NoCeiling);
    assert!(Finding::NoCeiling.fails());
}

#[test]
fn accepting_some_paths_keeps_the_others_and_accepting_all_drops_what_is_gone() {
    let counted = BTreeMap::from([("step".to_owned(), 800)]);
    let mut ceilings = some_ceilings();
    ceilings.accept(&counted, false);
    assert_eq!(ceilings.instructions_per_call, BTreeMap::from([("step".to_owned(), 800), ("tick".to_owned(), 200)]));
    ceilings.accept(&counted, true);
    assert_eq!(ceilings.instructions_per_call, counted);
}

#[test]
fn ceilings_read_back_as_written_and_a_broken_file_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("ceilings.json");
    assert!(Ceilings::read(&path).unwrap().is_none(), "no file, no ceilings");
    some_ceilings().write(&path).unwrap();
    assert_eq!(Ceilings::read(&path).unwrap(), Some(some_ceilings()));
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "nothing is left beside it");

    let text = fs::read_to_string(&path).unwrap();
    for (was, is, told) in [
        ("\"margin\": 0.05", "\"margin\": -0.05", "margin: must be finite and not negative, found -0.05"),
        ("\"margin\"", "\"margins\"", "unknown field `margins`"),
        ("200", "-200", "invalid value"),
    ] {
        fs::write(&path, text.replace(was, is)).unwrap();
        let error = Ceilings::read(&path).unwrap_err().to_string();
        assert!(error.contains("ceilings.json: ") && error.contains(told), "{error}");
    }
}

#[test]
fn the_stored_ceilings_leave_a_margin_that_a_slow_down_cannot_hide_in() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/benches/instructions/ceilings.json");
    let stored = Ceilings::read(path.as_ref()).unwrap().expect("the project stores ceilings");
    // Another libc moves counts by up to 2 %; a tenth is what somebody would call slower.
    assert!((0.02..0.1).contains(&stored.margin), "{}", stored.margin);
    assert!(stored.instructions_per_call.values().all(|count| *count > 100), "a call that does next to nothing is no hot path: {stored:?}");
}
