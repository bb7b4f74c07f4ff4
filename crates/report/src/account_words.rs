//! The account of a run in plain words.

use super::quantity::of_run::short_quantity;
use super::quantity::short;
use cohaul::simulation::rules::Rule;
use cohaul::simulation::{Account, Finding, Health};

/// The word for it.
pub fn name(health: Health) -> &'static str {
    match health {
        Health::Ok => "ok",
        Health::Doubtful => "doubtful",
        Health::Failed => "failed",
    }
}

/// What happened, by the worst finding; `None` for a run that is ok.
pub fn cause(account: &Account) -> Option<&'static str> {
    account.worst().map(|finding| finding.rule().means)
}

/// A warning for each finding: what happened, its measure beside the limit, and what to do.
pub fn warnings(account: &Account) -> impl Iterator<Item = String> + '_ {
    account.findings.iter().map(warning)
}

fn warning(finding: &Finding) -> String {
    let rule = finding.rule();
    let since = finding.since_s.map_or(String::new(), |time| format!(", first after {}", short_quantity(time, "s")));
    let measured = measure(rule, finding);
    format!("the run {}: {}{since}{measured}; {}", verb(finding.health), rule.means, rule.cure)
}

fn verb(health: Health) -> &'static str {
    if health == Health::Failed { "failed" } else { "is doubtful" }
}

/// The measure beside the limit that it exceeds; nothing for one that only exists or does not.
fn measure(rule: &Rule, Finding { health, found, .. }: &Finding) -> String {
    let limit = if *health == Health::Failed { rule.failed } else { rule.doubtful };
    let value = |value: f64| match rule.unit {
        "" => short(value),
        unit => short_quantity(value, unit),
    };
    let above = if limit > 0.0 { format!(", above {}", value(limit)) } else { String::new() };
    if rule.measure.is_empty() { String::new() } else { format!(" ({}: {}{above})", rule.measure, value(*found)) }
}
