//! Tells the program the commit that it is built from, if it is built from a repository, the compiler and how it is built.

use std::env;
use std::process::Command;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    let asked = Command::new("git").args(["rev-parse", "HEAD", "--git-path", "HEAD", "--git-path", "logs/HEAD"]).output();
    if let Some(output) = asked.ok().filter(|output| output.status.success()) {
        let said = String::from_utf8_lossy(&output.stdout);
        let mut lines = said.lines();
        println!("cargo::rustc-env=COHAUL_COMMIT={}", lines.next().unwrap_or_default());
        // A path that is not there would make every build start anew.
        for head in lines.filter(|head| std::path::Path::new(head).exists()) {
            println!("cargo::rerun-if-changed={head}");
        }
    }
    if let (Ok(profile), Ok(level)) = (env::var("PROFILE"), env::var("OPT_LEVEL")) {
        println!("cargo::rustc-env=COHAUL_PROFILE={profile} profile, opt-level {level}");
    }
    let compiler = env::var_os("RUSTC").and_then(|rustc| Command::new(rustc).arg("--version").output().ok());
    if let Some(output) = compiler.filter(|output| output.status.success()) {
        println!("cargo::rustc-env=COHAUL_COMPILER={}", String::from_utf8_lossy(&output.stdout).trim());
    }
}
