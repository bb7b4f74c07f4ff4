//! The machine that times come from.

use cohaul_report::manifest::{COMPILER, build_of_program};
use serde::Serialize;

/// What a time depends on besides the program's source; `null` where the system does not say.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Host {
    pub cpu: Option<String>,
    /// Processors this program may use.
    pub n_cpus: Option<usize>,
    /// Processes that wanted to run, averaged over the last minute.
    pub load_average: Option<f64>,
    pub version: &'static str,
    pub commit: Option<&'static str>,
    pub rustc: Option<&'static str>,
    /// Whether it was built to be fast: times of a build for debugging mean nothing.
    pub is_optimised: bool,
}

impl Host {
    pub fn here() -> Self {
        let (version, commit) = build_of_program();
        Self {
            cpu: std::fs::read_to_string("/proc/cpuinfo").ok().and_then(|text| cpu_name(&text)),
            n_cpus: std::thread::available_parallelism().ok().map(usize::from),
            load_average: std::fs::read_to_string("/proc/loadavg").ok().and_then(|text| text.split(' ').next()?.parse().ok()),
            version,
            commit,
            rustc: COMPILER,
            is_optimised: !cfg!(debug_assertions),
        }
    }
}

fn cpu_name(cpuinfo: &str) -> Option<String> {
    let line = cpuinfo.lines().find(|line| line.starts_with("model name"))?;
    line.split_once(':').map(|(_, name)| name.trim().to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_name_of_a_processor_is_found() {
        let text = "processor\t: 0\nmodel\t\t: 85\nmodel name\t: Some CPU @ 2.0 GHz\nflags\t\t: fpu\n";
        assert_eq!(cpu_name(text).as_deref(), Some("Some CPU @ 2.0 GHz"));
        assert_eq!(cpu_name("processor\t: 0\n"), None);
    }
}
