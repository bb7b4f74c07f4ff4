//! What the words of a report mean.

/// What `word` means; `None` of one that stands for itself.
pub fn meaning(word: &str) -> Option<&'static str> {
    TERMS.iter().find(|(term, _)| *term == word).map(|(_, meaning)| *meaning)
}

pub const TERMS: &[(&str, &str)] = &[
    (
        "quasi-static",
        "without inertia: at every instant springs and friction balance, by the paper's max-min principle with exact friction cones",
    ),
    ("inertial", "the same springs, supports and friction cones with the load's mass: the reference"),
    ("rapier", "the rigid-body engine rapier2d on the same scene, at the step that was asked for"),
    ("inertia effect", "inertial minus quasi-static: what neglecting inertia changes"),
    ("engine error", "rapier minus inertial: how much the engine bends the physics, by its step and beyond what any step removes"),
    ("own error", "how far quasi-static and inertial may still be wrong; nothing is claimed below it"),
    (
        "on the rim",
        "shift of the load's origin plus its radius times the turn, where that is largest: how far a point of the load can be off",
    ),
    (
        "agreement",
        "the distance up to which paths count as the same: a share, 1 % unless asked otherwise, of the way that the load's rim goes without inertia, or of how far it gets with it where that is more",
    ),
    (
        "epsilon",
        "v sqrt(k m) / f, the inertia of the driven load against friction: far below 1, a moving tip drags the load as if it had no mass",
    ),
    (
        "Phi",
        "omega_n T_e, the time between grasps and releases in radians of the load's oscillation on a spring: beyond pi a swing has time to overshoot",
    ),
    ("zeta", "damping of the springs over critical damping: from about 0.5 on, hardly anything is left of an overshoot"),
    (
        "replayed",
        "grasps, releases and tip motions of one recorded run, driven into all backends: paths then answer the same question, point by point",
    ),
    (
        "closed loop",
        "ants decide for themselves on each backend; paths part at the first decision that falls differently, so that only distributions compare",
    ),
    (
        "onset, stop, capture, jump",
        "the load begins to move, comes to rest, turns about a support that stopped slipping, or, without inertia, moves a finite way in no time",
    ),
];
