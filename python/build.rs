//! Tells the Python package the commit that it is built from.

include!("../crates/report/commit.rs");

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    tell_commit();
}
