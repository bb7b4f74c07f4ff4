//! What a load meets along a displacement.
//!
//! A displacement is looked at piece by piece, each as long as a share of the smallest feature. A
//! piece is free where no two features that were apart at its start overlap at its end. Where
//! outlines cross at its end that did not at its start, it is halved until features overlap. What
//! overlaps in between alone leaves no trace: a corner that is clipped by less than a piece.

use super::obstacles::{Obstacles, Task};
use super::surroundings::{Pair, PairKey, Surroundings};
use super::touching::Touching;
use crate::backend::numerics::{CLOSED_GAP, CROSSED, MOST_PIECES, PIECE, PIECE_HALVINGS};
use crate::backend::springs::Place;
use crate::math::Vec3;
use crate::model::System;

/// A straight displacement of a load, along which the `kept` contacts stay closed.
pub(super) struct Displacement<'a> {
    pub start: &'a Place,
    pub twist: &'a Vec3,
    /// Begin and end (s).
    pub times: [f64; 2],
    pub kept: &'a [Touching],
    /// Whether other contacts, which are closed at its end alone, overlap in between: outlines may
    /// cross there by them.
    pub has_chords: bool,
}

/// Part of a displacement between two shares of it, with the places and times there.
struct Piece {
    shares: [f64; 2],
    places: [Place; 2],
    times: [f64; 2],
}

impl Displacement<'_> {
    fn time(&self, share: f64) -> f64 {
        self.times[0] + share * (self.times[1] - self.times[0])
    }

    fn place(&self, obstacles: &Obstacles, system: &System, share: f64) -> Place {
        let place = self.start.moved_by(&(share * self.twist));
        if self.kept.is_empty() || share == 1.0 {
            return place;
        }
        Place::of(&obstacles.close(system, &place.pose, self.kept, self.time(share)))
    }
}

impl Obstacles {
    /// Share of an increment after which a load meets a feature, at the start of the piece in which
    /// it does; `None` for a free path. The `known` features are left out where the end of the
    /// increment says all of them, and those that touch anywhere.
    pub(super) fn first_hit(
        &mut self,
        system: &System,
        start: &Place,
        twist: &Vec3,
        task: &Task,
        known: &[(PairKey, bool)],
    ) -> Option<f64> {
        let is_known = |pair: &Pair, n_pieces: usize| known.iter().any(|(key, touches)| *key == pair.key && (*touches || n_pieces == 1));
        let has_chords = known.iter().any(|(_, touches)| *touches);
        let (_, [share, _]) =
            self.hits(system, &Displacement { start, twist, times: [task.from, task.to], kept: &[], has_chords }, is_known)?;
        Some(share)
    }

    /// Features that a load passes through along a displacement, but the known ones, in the first
    /// piece in which it does, with the shares between which this piece lies. The first share is
    /// zero where the end of the piece does not show what the load passes through. Whether a pair
    /// is known may depend on the number of pieces. `None` for a free path. No features where a
    /// displacement is too long to be looked at as a whole, or where outlines come to cross by
    /// known ones: then it is free up to the second share.
    pub(super) fn hits(
        &mut self,
        system: &System,
        displacement: &Displacement,
        is_known: impl Fn(&Pair, usize) -> bool,
    ) -> Option<(Vec<Pair>, [f64; 2])> {
        let Displacement { start, twist, times: [from, to], .. } = *displacement;
        let of_load = twist.xy().norm() + system.load.radius * twist.z.abs();
        let moved = of_load + self.surroundings.longest_path(system, from, to);
        if self.known_clearance(system, start, from) > moved {
            return None;
        }
        let n_pieces = (moved / (PIECE * self.surroundings.fineness())).ceil().max(1.0) as usize;
        let mut pairs = Vec::new();
        let (mut here, mut now) = (*start, from);
        for index in 0..n_pieces.min(MOST_PIECES) {
            let shares = [index, index + 1].map(|index| index as f64 / n_pieces as f64);
            let (there, then) = (displacement.place(self, system, shares[1]), displacement.time(shares[1]));
            let piece = Piece { shares, places: [here, there], times: [now, then] };
            let is_new = |pair: &Pair| !is_known(pair, n_pieces);
            if let Some(shares) = self.hit_in(system, displacement, piece, is_new, &mut pairs) {
                return Some((pairs, shares));
            }
            (here, now) = (there, then);
        }
        pairs.clear();
        let looked_at = [MOST_PIECES - 1, MOST_PIECES].map(|piece| piece as f64 / n_pieces as f64);
        (n_pieces > MOST_PIECES).then_some((pairs, looked_at))
    }

    /// Shares between which a load passes through features in a piece of a displacement, with these
    /// `pairs`; `None` for a free piece. See [`Self::hits`].
    fn hit_in(
        &mut self,
        system: &System,
        displacement: &Displacement,
        mut piece: Piece,
        is_new: impl Fn(&Pair) -> bool,
        pairs: &mut Vec<Pair>,
    ) -> Option<[f64; 2]> {
        let closed = CLOSED_GAP * system.load.radius;
        for halving in 0..=PIECE_HALVINGS {
            let Piece { shares: [from, to], places: [here, there], times: [now, then] } = piece;
            let of_piece = there.pose.edge_displacement(&here.pose, system.load.radius);
            let reach = 1.001 * (of_piece + self.surroundings.longest_path(system, now, then)) + closed;
            pairs.clear();
            self.surroundings.pairs(system, &here, now, reach, pairs);
            let mut may_cross = false;
            pairs.retain(|pair| {
                let path = &system.world.obstacles[pair.key.obstacle].path;
                let end = Surroundings::relative(&there, &path.pose_at(then));
                let gap = pair.features.gap(&end);
                may_cross |= gap < -closed;
                if gap >= -closed || !is_new(pair) {
                    return false;
                }
                let start = Surroundings::relative(&here, &path.pose_at(now));
                self.surroundings.beyond(pair, [&start, &end]) <= 0.0 && !self.surroundings.passes_end(pair, &start, &end)
            });
            if !pairs.is_empty() {
                return Some([if halving == 0 { from } else { 0.0 }, to]);
            }
            if halving == 0 && !(may_cross && !displacement.has_chords && self.comes_to_cross(system, &piece.places, piece.times)) {
                return None;
            }
            let share = 0.5 * (from + to);
            let (middle, time) = (displacement.place(self, system, share), displacement.time(share));
            piece = if self.cross(system, &middle, time) {
                Piece { shares: [from, share], places: [here, middle], times: [now, time] }
            } else {
                Piece { shares: [share, to], places: [middle, there], times: [time, then] }
            };
        }
        Some([0.0, piece.shares[0]])
    }

    /// Whether features that were apart at the start overlap at the end of an increment, but the
    /// known ones. Those that the load reaches through a known one are not on the path elsewhere.
    pub(super) fn overlaps_at_end(&mut self, system: &System, start: &Place, twist: &Vec3, task: &Task, known: &[(PairKey, bool)]) -> bool {
        let of_load = twist.xy().norm() + system.load.radius * twist.z.abs();
        let moved = of_load + self.surroundings.longest_path(system, task.from, task.to);
        if moved == 0.0 || !known.iter().any(|(_, touches)| *touches) {
            return false;
        }
        let closed = CLOSED_GAP * system.load.radius;
        let mut pairs = Vec::new();
        self.surroundings.pairs(system, start, task.from, 1.001 * moved + closed, &mut pairs);
        let end = start.moved_by(twist);
        pairs.iter().filter(|pair| !known.iter().any(|(key, _)| *key == pair.key)).any(|pair| {
            let path = &system.world.obstacles[pair.key.obstacle].path;
            let [before, after] = [(start, task.from), (&end, task.to)].map(|(at, time)| Surroundings::relative(at, &path.pose_at(time)));
            let overlaps = pair.features.gap(&after) < -closed && self.surroundings.beyond(pair, [&before, &after]) <= 0.0;
            overlaps && !self.surroundings.passes_end(pair, &before, &after)
        })
    }

    /// Whether the outlines of load and obstacles cross at the second place, and did not at the
    /// first.
    pub(super) fn comes_to_cross(&mut self, system: &System, [start, end]: &[Place; 2], times: [f64; 2]) -> bool {
        self.cross(system, end, times[1]) && !self.cross(system, start, times[0])
    }

    fn cross(&mut self, system: &System, place: &Place, time: f64) -> bool {
        self.surroundings.crosses(system, place, time, CROSSED * system.load.radius)
    }
}
