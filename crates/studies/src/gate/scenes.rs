//! The scenes that are recorded unless others are named.

use cohaul::scenario::Scenario;

/// Names and texts: ground friction alone, springs, releases, walls, impacts and pushing, all
/// short.
const USUAL: [(&str, &str); 10] = [
    ("slide-spin", include_str!("../../../../scenarios/analytic/slide-spin.json")),
    ("tripod-slide-spin-pinned", include_str!("../../../../scenarios/analytic/tripod-slide-spin-pinned.json")),
    ("ramp-and-hold", include_str!("../../../../scenarios/analytic/ramp-and-hold.json")),
    ("release-jump", include_str!("../../../../scenarios/analytic/release-jump.json")),
    ("wall-slide", include_str!("../../../../scenarios/contact/wall-slide.json")),
    ("box-wall-friction", include_str!("../../../../scenarios/contact/box-wall-friction.json")),
    ("post-arc", include_str!("../../../../scenarios/contact/post-arc.json")),
    ("rebound", include_str!("../../../../scenarios/contact/rebound.json")),
    ("oblique-impact", include_str!("../../../../scenarios/contact/oblique-impact.json")),
    ("pusher", include_str!("../../../../scenarios/contact/pusher.json")),
];

/// Names and scenarios.
pub fn usual() -> Vec<(String, Scenario)> {
    let read = |(name, text): (&str, &str)| (name.to_owned(), Scenario::parse(text, name).expect("scenarios of the project are valid"));
    USUAL.into_iter().map(read).collect()
}
