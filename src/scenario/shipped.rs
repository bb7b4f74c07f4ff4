//! Scenes that come with the library: all of `scenarios/`.

/// Names and texts of the files with these names.
macro_rules! texts {
    ($($name:literal,)*) => {
        [$(($name, include_str!(concat!("../../scenarios/", $name, ".json")))),*]
    };
}

const SHIPPED: [(&str, &str); 57] = texts![
    "paper/corridor",
    "paper/doorway",
    "paper/five-ants-ten-springs",
    "paper/four-ants-four-springs",
    "paper/four-tips-held",
    "paper/four-tips-prescribed",
    "paper/one-ant-one-spring",
    "paper/post",
    "paper/structure-1",
    "paper/structure-2",
    "paper/ten-ants-ten-springs",
    "paper/wall-with-gap",
    "robots/caging",
    "robots/doorway",
    "robots/fence",
    "robots/sorting",
    "robots/tow-past-corner",
    "robots/two-fingers",
    "contact/box-lift",
    "contact/box-wall-friction",
    "contact/box-wall-slip",
    "contact/box-wall-stick",
    "contact/disc-roll",
    "contact/disc-roll-slip",
    "contact/jump-and-rebound",
    "contact/jump-to-wall",
    "contact/notch-jam",
    "contact/oblique-impact",
    "contact/oblique-rebound",
    "contact/post-arc",
    "contact/post-jump",
    "contact/posts-gap",
    "contact/push-aside",
    "contact/pusher",
    "contact/pusher-uniform",
    "contact/rebound",
    "contact/wall-slide",
    "analytic/centre-pull",
    "analytic/qs-ref-1",
    "analytic/ramp-and-hold",
    "analytic/release-jump",
    "analytic/slide",
    "analytic/slide-spin",
    "analytic/spin",
    "analytic/tripod-slide-spin-free",
    "analytic/tripod-slide-spin-pinned",
    "analytic/tripod-spin-pinned",
    "stress/collinear-supports",
    "stress/heavy",
    "stress/hold-below-limit",
    "stress/hold-below-limit-off-centre",
    "stress/hundred-supports",
    "stress/stiff-light",
    "stress/thousand-springs",
    "stress/tip-jump",
    "stress/zero-friction",
    "stress/zero-normal-load",
];

/// A scene to begin with.
pub const FIRST: &str = "paper/four-ants-four-springs";

/// The text of the scene with this name; `None` if there is none.
pub fn shipped(name: &str) -> Option<&'static str> {
    SHIPPED.iter().find(|(own, _)| *own == name).map(|(_, text)| *text)
}

/// Names of all these scenes, as `contact/pusher`.
pub fn names() -> impl Iterator<Item = &'static str> {
    SHIPPED.iter().map(|(name, _)| *name)
}
