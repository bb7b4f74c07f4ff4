//! Contacts that are closed, and what became of them between two instants.

use serde::{Deserialize, Serialize};
use smallvec::SmallVec;

use super::gap::FeaturePair;
use super::solve::{SideForce, SideMode};
use super::surroundings::{Pair, PairKey, PairKind};
use crate::backend::numerics::{ALIKE, NARROW_FACE};
use crate::backend::report::TransitionKind;
use crate::backend::springs::Place;
use crate::math::{Pose, Vec2, perpendicular, rotation};

/// A contact that is closed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Touching {
    pub key: PairKey,
    pub mode: SideMode,
    pub force: SideForce,
    /// Slip coordinate (m).
    pub slip: f64,
    /// Force on the load (N, world) and where it acts (m, world).
    pub on_load: [Vec2; 2],
    /// Unit normal from obstacle to load (world).
    pub normal: Vec2,
}

/// A face by which a load touches: all contacts with one normal.
///
/// On one obstacle or on several that are flush, a face holds the load by the two ends of what
/// touches, and which features lie there changes as the load slides on.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Face {
    /// Unit normal from obstacle to load (world).
    normal: Vec2,
    /// Interval of the contact points along the face (m).
    extent: [f64; 2],
    /// Mode of the contacts that press, or else of the first one, and whether any of them does.
    mode: SideMode,
    presses: bool,
    /// The pair where one point rolls or slides about another: others have another curvature.
    bend: Option<PairKey>,
}

/// All faces by which a load touches.
#[derive(Clone, Debug, Default)]
pub struct Faces(SmallVec<[Face; 2]>);

impl Touching {
    /// A contact that is closed for a load at `at` in the frame of an obstacle at this pose.
    pub fn new(pair: &Pair, (mode, force, slip): (SideMode, SideForce, f64), at: &Place, obstacle: &Pose) -> Self {
        let normal = rotation(obstacle.heading) * pair.features.normal(at);
        Self { key: pair.key, mode, force, slip, on_load: on_load(&pair.features, &force, at, obstacle), normal }
    }
}

impl Faces {
    pub fn of(touching: &[Touching]) -> Self {
        let mut faces = Self::default();
        for Touching { key, mode, force, on_load: [_, point], normal, .. } in touching {
            let presses = force.normal > 0.0;
            let known = faces.0.iter_mut().find(|face| face.normal.dot(normal) >= ALIKE);
            let along = perpendicular(known.as_ref().map_or(normal, |face| &face.normal)).dot(point);
            match known {
                Some(face) => {
                    face.extent = [face.extent[0].min(along), face.extent[1].max(along)];
                    if presses && !face.presses {
                        (face.mode, face.presses) = (*mode, true);
                    }
                }
                None => faces.0.push(Face {
                    normal: *normal,
                    extent: [along; 2],
                    mode: *mode,
                    presses,
                    bend: Some(*key).filter(|key| key.kind == PairKind::PointOnPoint),
                }),
            }
        }
        faces
    }

    /// Whether a load of this `radius` (m) that touched by these faces goes on to do so in the same
    /// modes when it touches by the others.
    pub fn go_on(&self, others: &Self, radius: f64) -> bool {
        let is_narrow = |face: &Face| face.extent[1] - face.extent[0] <= NARROW_FACE * radius;
        let is_alike =
            |a: &Face, b: &Face| a.mode == b.mode && a.bend == b.bend && is_narrow(a) == is_narrow(b) && a.normal.dot(&b.normal) >= ALIKE;
        self.0.len() == others.0.len() && self.0.iter().all(|face| others.0.iter().any(|other| is_alike(face, other)))
    }
}

/// Force of a contact on the load (N, world) and where it acts (m, world), for a load at `at` in
/// the frame of an obstacle.
pub fn on_load(features: &FeaturePair, force: &SideForce, at: &Place, obstacle: &Pose) -> [Vec2; 2] {
    let normal = features.normal(at);
    let in_frame = force.normal * normal + force.tangential * perpendicular(&normal);
    [rotation(obstacle.heading) * in_frame, obstacle.to_world(&features.contact_point(at))]
}

/// What happened at the obstacles between two sets of contacts.
pub fn transitions(before: &[Touching], after: &[Touching]) -> SmallVec<[TransitionKind; 2]> {
    let mut kinds = SmallVec::new();
    let goes_on = |(a, b): (&Touching, &Touching)| a.key == b.key && a.mode == b.mode;
    if before.len() == after.len() && before.iter().zip(after).all(goes_on) {
        return kinds;
    }
    let of = |touching: &[Touching], obstacle: usize| {
        let mine = || touching.iter().filter(move |touching| touching.key.obstacle == obstacle);
        (mine().count() > 0).then(|| mine().any(|touching| touching.mode == SideMode::Stick))
    };
    let mut obstacles: SmallVec<[usize; 4]> = before.iter().chain(after).map(|touching| touching.key.obstacle).collect();
    obstacles.sort_unstable();
    obstacles.dedup();
    for obstacle in obstacles {
        kinds.extend(match (of(before, obstacle), of(after, obstacle)) {
            (None, Some(_)) => Some(TransitionKind::Touch { obstacle }),
            (Some(_), None) => Some(TransitionKind::Separation { obstacle }),
            (Some(false), Some(true)) => Some(TransitionKind::SideStick { obstacle }),
            (Some(true), Some(false)) => Some(TransitionKind::SideSlip { obstacle }),
            _ => None,
        });
    }
    kinds
}
