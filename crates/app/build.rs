//! Tells the program the commit that it is built from.

include!("../report/commit.rs");

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    tell_commit();
}
