//! Tells the program the commit that it is built from, if it is built from a repository.

use std::process::Command;

fn main() {
    println!("cargo::rerun-if-changed=.git/HEAD");
    println!("cargo::rerun-if-changed=.git/logs/HEAD");
    let asked = Command::new("git").args(["rev-parse", "HEAD"]).output();
    if let Some(output) = asked.ok().filter(|output| output.status.success()) {
        println!("cargo::rustc-env=COHAUL_COMMIT={}", String::from_utf8_lossy(&output.stdout).trim());
    }
}
