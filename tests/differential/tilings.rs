//! Walls of flush blocks against the wall in one piece.
//!
//! A wall of 1 to 25 blocks, lines or pieces is turned, scaled and shifted, and a box is pressed on
//! it and pulled along it. However it is cut, it is one wall.

use cohaul::backend::BackendKind::{self, Inertial, QuasiStatic};
use rayon::prelude::*;

use crate::draws::{Draws, asked};
use crate::known::{ROUGH, TOP, block, line, one_piece, pressed};
use crate::posed::Pose;
use crate::run::{EXACT, Run, Steps, expect_none, keep, run, step_error};
use crate::scene::{Body, Part, Scene, fixed, rectangle};

/// Largest distance of both runs over the size (1), apart from the error of steps with inertia,
/// which may be divided at joints. Shifts by metres round the corners of a load of millimetres to
/// 1e-13 of its size, and thousand steps add up.
const SAME: f64 = 1e-8;
/// Ends of the wall (m).
const FROM: f64 = -0.6;
const TO: f64 = 1.2;
/// Number of tilings of the long survey.
const MANY: u64 = 1000;

/// Ways to make one wall of pieces.
#[derive(Clone, Copy, Debug)]
enum Form {
    Blocks,
    /// Separate lines, some from right to left.
    Lines,
    /// A line with points in it.
    Chain,
    /// An obstacle of flush blocks.
    Compound,
}

impl Form {
    const ALL: [Self; 4] = [Self::Blocks, Self::Lines, Self::Chain, Self::Compound];

    fn wall(self, ends: &[f64], friction: f64, draws: &mut Draws) -> Vec<Body> {
        let pieces = ends.windows(2).map(|piece| (piece[0], piece[1]));
        match self {
            Self::Blocks => pieces.map(|(a, b)| block(a, b, TOP, friction)).collect(),
            Self::Lines => pieces
                .map(|(a, b)| if draws.is(0.5) { line(&[[a, TOP], [b, TOP]], friction) } else { line(&[[b, TOP], [a, TOP]], friction) })
                .collect(),
            Self::Chain => vec![line(&ends.iter().map(|x| [*x, TOP]).collect::<Vec<_>>(), friction)],
            Self::Compound => {
                let parts: Vec<Part> = pieces.map(|(a, b)| rectangle([0.5 * (a + b), TOP - 0.05], [b - a, 0.1])).collect();
                vec![fixed(parts, friction)]
            }
        }
    }
}

/// A wall in pieces and the same in one piece.
pub struct Tiling {
    pieces: Scene,
    whole: Scene,
    what: String,
}

impl Tiling {
    pub fn new(seed: u64) -> Self {
        let mut draws = Draws::new(seed);
        let friction = if draws.is(0.5) { ROUGH } else { 0.0 };
        let mut cuts: Vec<f64> = (0..draws.below(25)).map(|_| draws.between(-0.4, 1.0)).collect();
        // A joint under the front corner at the start.
        cuts.extend(draws.is(0.2).then_some(0.1));
        cuts.extend([FROM, TO]);
        cuts.sort_by(f64::total_cmp);
        let form = Form::ALL[draws.below(4)];
        let targets: &[f64] = if draws.is(0.15) { &[0.6, 0.1] } else { &[0.6] };
        let pose = Pose::random(&mut draws);
        let wall = form.wall(&cuts, friction, &mut draws);
        let posed = |obstacles| pose.of(&pressed(&format!("tiling {seed}"), obstacles, targets));
        let what = format!("{seed}: {} pieces, {form:?}, friction {friction}, {} ways, {pose:?}", cuts.len() - 1, targets.len());
        Self { pieces: posed(wall), whole: posed(one_piece(friction)), what }
    }

    /// The scene in pieces, and how far its run is from that in one piece where that is too far.
    pub fn wrong(&self, kind: BackendKind) -> Option<String> {
        let [pieces, whole]: [Run; 2] = [&self.pieces, &self.whole].map(|scene| run(scene, kind, Steps::Default));
        let apart = pieces.apart(&whole, self.pieces.size());
        let of_steps = if kind == Inertial { step_error(&self.whole, kind, &whole) } else { 0.0 };
        (apart > SAME + of_steps).then(|| {
            let (end, right) = (pieces.end(), whole.end());
            keep(&format!("tiling-{}-{}", kind.name(), self.pieces.name.replace(' ', "-")), &self.pieces, right);
            format!("{}, {}: {apart:.1e} of the size, ends at {end:?}, right is {right:?}, {:?}", kind.name(), self.what, pieces.status)
        })
    }
}

fn unequal(seeds: std::ops::Range<u64>, kind: BackendKind) -> Vec<String> {
    seeds.into_par_iter().filter_map(|seed| Tiling::new(seed).wrong(kind)).collect()
}

#[test]
fn without_inertia_a_wall_in_pieces_is_a_wall_in_one_piece() {
    expect_none(unequal(0..40, QuasiStatic));
}

#[test]
fn with_inertia_a_wall_in_pieces_is_a_wall_in_one_piece() {
    expect_none(unequal(0..20, Inertial));
}

/// `COHAUL_SEED` is the first seed in place of 1000, `COHAUL_COUNT` the number of walls.
#[test]
#[ignore = "takes minutes"]
fn many_walls_in_pieces_are_walls_in_one_piece() {
    let (first, count) = (asked("COHAUL_SEED", 1000), asked("COHAUL_COUNT", MANY));
    let unequal: Vec<String> = EXACT.into_iter().flat_map(|kind| unequal(first..first + count, kind)).collect();
    unequal.iter().for_each(|one| println!("{one}"));
    println!("{} of {count} walls are unequal", unequal.len());
    expect_none(unequal);
}
