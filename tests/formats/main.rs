//! No key of a format changes without its version: keys and types of real outputs of small scenes
//! are those of the lists beside this file.
//!
//! ```text
//! keys.rs      key paths with types, and the comparison with a list
//! outputs.rs   the outputs of each command, the files that users keep, and the live page
//! schema.rs    key paths of scenarios, from the schema
//! *.txt        one list for each format
//! ```
//!
//! `COHAUL_REWRITE=1` adds new keys to the lists, and writes the list of another version anew. A
//! type that these scenes do not show may be written into a list by hand.

#![cfg(unix)]

mod keys;
mod outputs;
mod schema;

use std::collections::BTreeMap;
use std::path::PathBuf;

use cohaul::formats;
use keys::{Keys, compare, text_of};

/// The list of the format of this name.
fn list_of(name: &str) -> PathBuf {
    let file = name.trim_start_matches("cohaul ").replace(' ', "-") + ".txt";
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/formats").join(file)
}

#[test]
fn no_key_changes_without_its_version() {
    let mut found: BTreeMap<&str, Keys> = outputs::all();
    found.insert(formats::SCENARIO.name, schema::keys());
    let rewrites = std::env::var_os("COHAUL_REWRITE").is_some();
    let mut faults = Vec::new();
    for format in formats::ALL {
        let path = list_of(format.name);
        let keys = found.remove(format.name).unwrap_or_else(|| panic!("no output of {:?} is looked at", format.name));
        let stored = std::fs::read_to_string(&path).ok();
        let Err(misfit) = compare(format, stored.as_deref(), &keys) else { continue };
        match misfit.list.filter(|_| rewrites) {
            Some(list) => std::fs::write(&path, text_of(format.version, &list)).expect("a list can be written"),
            None => faults.push(format!("{}:\n  {}", path.display(), misfit.why.join("\n  "))),
        }
    }
    assert!(found.is_empty(), "outputs of no known format: {:?}", found.keys());
    let how = "COHAUL_REWRITE=1 cargo test --test formats adds new keys, and writes the list of another version anew";
    assert!(faults.is_empty(), "{}\n{how}", faults.join("\n"));
}
