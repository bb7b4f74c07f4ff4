//! The scenes of a benchmark that is asked for no others, in the program itself: all analytic ones,
//! the paper's load with prescribed tips, and loads that are pushed or slide along obstacles.

use super::scene::Scene;
use cohaul::scenario::Scenario;

/// Names and texts.
pub const STANDARD: &[(&str, &str)] = &[
    ("centre-pull", include_str!("../../../../scenarios/analytic/centre-pull.json")),
    ("qs-ref-1", include_str!("../../../../scenarios/analytic/qs-ref-1.json")),
    ("ramp-and-hold", include_str!("../../../../scenarios/analytic/ramp-and-hold.json")),
    ("release-jump", include_str!("../../../../scenarios/analytic/release-jump.json")),
    ("slide-spin", include_str!("../../../../scenarios/analytic/slide-spin.json")),
    ("slide", include_str!("../../../../scenarios/analytic/slide.json")),
    ("spin", include_str!("../../../../scenarios/analytic/spin.json")),
    ("tripod-slide-spin-free", include_str!("../../../../scenarios/analytic/tripod-slide-spin-free.json")),
    ("tripod-slide-spin-pinned", include_str!("../../../../scenarios/analytic/tripod-slide-spin-pinned.json")),
    ("tripod-spin-pinned", include_str!("../../../../scenarios/analytic/tripod-spin-pinned.json")),
    ("four-tips-held", include_str!("../../../../scenarios/paper/four-tips-held.json")),
    ("four-tips-prescribed", include_str!("../../../../scenarios/paper/four-tips-prescribed.json")),
    ("box-wall-friction", include_str!("../../../../scenarios/contact/box-wall-friction.json")),
    ("post-arc", include_str!("../../../../scenarios/contact/post-arc.json")),
    ("push-aside", include_str!("../../../../scenarios/contact/push-aside.json")),
    ("pusher-uniform", include_str!("../../../../scenarios/contact/pusher-uniform.json")),
];

/// The standard scenes.
///
/// # Panics
/// Never: the texts are scenarios of the project.
pub fn standard_scenes() -> Vec<Scene> {
    STANDARD.iter().map(|(name, text)| Scene::new(*name, &parsed(name, text))).collect()
}

/// The paper's scene, whose friction problems the solvers get.
pub fn four_ants() -> Scenario {
    parsed("four-ants", include_str!("../../../../scenarios/paper/four-ants-four-springs.json"))
}

/// The paper's scene in which a tick is timed with more and more ants.
pub fn crowd() -> Scenario {
    parsed("ten-ants", include_str!("../../../../scenarios/paper/ten-ants-ten-springs.json"))
}

fn parsed(name: &str, text: &str) -> Scenario {
    Scenario::parse(text, name).expect("scenarios of the project are valid")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_analytic_scenes_are_there() {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios/analytic");
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let stem = path.file_stem().unwrap().to_str().unwrap();
            assert!(STANDARD.iter().any(|(name, _)| *name == stem), "{stem}");
        }
        assert_eq!(standard_scenes().len(), STANDARD.len());
        assert!(four_ants().system.springs.len() == 4 && crowd().system.springs.len() == 10);
    }
}
