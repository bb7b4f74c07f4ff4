//! Which file uses what another file defines, and circles of such uses.
//!
//! A path is followed to the file that defines its name, through modules and `pub use`. A module
//! that only hands a name on does not use it.

use std::collections::{BTreeMap, BTreeSet};

use crate::Finding;
use crate::source::{Kind, PathName, Source};

/// Files by their modules, `["backend", "friction"]` for `crate::backend::friction`.
struct Tree<'a> {
    files: BTreeMap<Vec<String>, Module<'a>>,
}

struct Module<'a> {
    file: &'a Source,
    definitions: BTreeSet<&'a str>,
    paths: Vec<PathName>,
}

/// A finding for each set of files of the crate in this folder that use each other.
pub fn circles(folder: &str, files: &[&Source]) -> Vec<Finding> {
    let files = files.iter().copied().filter(|file| !file.is_test()).map(|file| (module_of(folder, &file.path), Module::new(file)));
    let tree = Tree { files: files.filter(|(at, _)| !["lib", "main"].contains(&at[0].as_str())).collect() };
    let uses: BTreeMap<&str, BTreeMap<&str, String>> =
        tree.files.iter().map(|(at, module)| (module.file.path.as_str(), tree.uses(at, module))).collect();
    let reached: BTreeMap<&str, BTreeSet<&str>> = uses.keys().map(|path| (*path, reachable(&uses, path))).collect();
    let mut seen = BTreeSet::new();
    let mut findings = Vec::new();
    for path in uses.keys().filter(|path| reached[**path].contains(**path)) {
        if !seen.insert(*path) {
            continue;
        }
        let circle: BTreeSet<&str> = reached[path].iter().filter(|other| reached[**other].contains(path)).copied().collect();
        let ties: Vec<String> = circle
            .iter()
            .flat_map(|from| {
                uses[from].iter().filter(|(to, _)| circle.contains(*to)).map(move |(to, name)| format!("{from} uses {name} of {to}"))
            })
            .collect();
        seen.extend(&circle);
        findings.push(Finding::new(path, 1, format!("{} files in a circle:\n    {}", circle.len(), ties.join("\n    "))));
    }
    findings
}

fn reachable<'a>(uses: &BTreeMap<&'a str, BTreeMap<&'a str, String>>, from: &str) -> BTreeSet<&'a str> {
    let mut reached = BTreeSet::new();
    let mut open: Vec<&str> = uses[from].keys().copied().collect();
    while let Some(path) = open.pop() {
        if reached.insert(path) {
            open.extend(uses.get(path).into_iter().flat_map(BTreeMap::keys));
        }
    }
    reached
}

/// The module of a file, `["backend", "friction"]` for `src/backend/friction/mod.rs`.
pub fn module_of(folder: &str, path: &str) -> Vec<String> {
    let inside = path.trim_start_matches(folder).trim_start_matches('/').trim_end_matches(".rs").trim_end_matches("/mod");
    inside.split('/').map(str::to_owned).collect()
}

/// Names from the root of the crate on to what `path` names in the module `at`; none for a name
/// that stands alone.
pub fn from_the_root(at: &[String], path: &PathName) -> Vec<String> {
    let n_relative = path.names.iter().take_while(|name| ["crate", "super", "self"].contains(&name.as_str())).count();
    let n_up = path.names[..n_relative].iter().filter(|name| *name == "super").count();
    let base = match path.names[0].as_str() {
        "crate" => &[],
        "super" | "self" => &at[..at.len() - n_up],
        _ => return Vec::new(),
    };
    base.iter().chain(&path.names[n_relative..]).cloned().collect()
}

impl<'a> Module<'a> {
    fn new(file: &'a Source) -> Self {
        Self { file, definitions: file.definitions(), paths: file.paths() }
    }
}

impl<'a> Tree<'a> {
    /// Files that a module uses, each with one name that it takes.
    fn uses(&self, at: &[String], module: &Module) -> BTreeMap<&'a str, String> {
        let mut used = BTreeMap::new();
        for path in &module.paths {
            let leaf = path.names.last().expect("a path has names");
            let times = module.file.tokens.iter().filter(|token| token.kind == Kind::Ident && token.text == *leaf).count();
            if path.is_reexport && times < 2 {
                continue;
            }
            if let Some(defining) = self.defining(at, path).filter(|defining| defining.path != module.file.path) {
                used.entry(defining.path.as_str()).or_insert_with(|| leaf.clone());
            }
        }
        used
    }

    /// The file that defines what `path` names, seen from the module `at`.
    fn defining(&self, at: &[String], path: &PathName) -> Option<&'a Source> {
        // An import of a child of this module; other names that stand first are crates.
        let is_of_child = self.files.contains_key(&[at, &path.names[..1]].concat());
        let names = if is_of_child { [at, &path.names].concat() } else { from_the_root(at, path) };
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        if names.is_empty() { None } else { self.follow(Vec::new(), &names, 0) }
    }

    /// The file that defines `names` in a module, through what the module hands on.
    fn follow(&self, mut module: Vec<String>, names: &[&str], depth: usize) -> Option<&'a Source> {
        let (name, rest) = match names.split_first() {
            Some((name, rest)) => (*name, rest),
            None => return self.files.get(&module).map(|module| module.file),
        };
        module.push(name.to_owned());
        if self.files.contains_key(&module) {
            return self.follow(module, rest, depth);
        }
        module.pop();
        let Module { file, definitions, paths } = self.files.get(&module)?;
        if depth > 8 || definitions.contains(name) {
            return Some(file);
        }
        let handed_on = paths.iter().filter(|path| path.is_reexport);
        for path in handed_on.filter(|path| path.names.last().is_some_and(|leaf| leaf == name || leaf == "*")) {
            let names: Vec<String> = path.names.iter().map(|leaf| if leaf == "*" { name.to_owned() } else { leaf.clone() }).collect();
            let through = PathName { names, ..*path };
            let found = if ["crate", "super", "self"].contains(&through.names[0].as_str()) {
                self.defining(&module, &through)
            } else {
                self.follow(module.clone(), &through.names.iter().map(String::as_str).collect::<Vec<_>>(), depth + 1)
            };
            if let Some(found) = found.filter(|found| found.path != file.path) {
                return Some(found);
            }
        }
        Some(file)
    }
}
