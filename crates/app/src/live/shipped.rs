//! Scenes that come with the program.

const SHIPPED: [(&str, &str); 10] = [
    ("four ants", include_str!("../../../../scenarios/paper/four-ants-four-springs.json")),
    ("ten ants", include_str!("../../../../scenarios/paper/ten-ants-ten-springs.json")),
    ("four tips", include_str!("../../../../scenarios/paper/four-tips-prescribed.json")),
    ("wall with a gap", include_str!("../../../../scenarios/paper/wall-with-gap.json")),
    ("release", include_str!("../../../../scenarios/analytic/release-jump.json")),
    ("ramp and hold", include_str!("../../../../scenarios/analytic/ramp-and-hold.json")),
    ("tow past a corner", include_str!("../../../../scenarios/robots/tow-past-corner.json")),
    ("two fingers", include_str!("../../../../scenarios/robots/two-fingers.json")),
    ("pusher", include_str!("../../../../scenarios/contact/pusher.json")),
    ("rebound", include_str!("../../../../scenarios/contact/rebound.json")),
];

/// The text of the scenario with this name; the first one without a name.
pub fn shipped(name: Option<&str>) -> Option<&'static str> {
    SHIPPED.iter().find(|(own, _)| name.is_none_or(|name| name == *own)).map(|(_, text)| *text)
}

pub fn names() -> impl Iterator<Item = &'static str> {
    SHIPPED.iter().map(|(name, _)| *name)
}
