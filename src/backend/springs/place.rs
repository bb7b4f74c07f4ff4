//! A pose with its rotation matrix, carried from place to place without a sine.

use serde::{Deserialize, Serialize};

use crate::math::{Arc, Mat2, Pose, Vec2, Vec3, perpendicular, rotation};

/// Pose of the load and the rotation by its heading. Two places with the same pose may differ in
/// the last bits of the rotation, which depend on how it was found.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Place {
    pub pose: Pose,
    pub turn: Mat2,
}

impl Place {
    pub fn of(pose: &Pose) -> Self {
        Self { pose: *pose, turn: rotation(pose.heading) }
    }

    /// Place at a pose whose x axis points along `ahead`, a unit vector but for rounding. The
    /// rounding is removed, so that a rotation carried through many places stays one. Its angle
    /// departs from the heading by the rounding of the headings.
    #[inline]
    pub fn turned(pose: Pose, ahead: Vec2) -> Self {
        let ahead = (1.5 - 0.5 * ahead.norm_squared()) * ahead;
        Self { pose, turn: Mat2::from_columns(&[ahead, perpendicular(&ahead)]) }
    }

    /// Place after the body-twist increment with this linear part (m) along this arc.
    #[inline]
    pub fn moved(&self, shift: &Vec2, arc: &Arc) -> Self {
        let Pose { position, heading } = self.pose;
        let pose = Pose { position: position + self.turn * arc.shift(shift), heading: heading + arc.angle() };
        Self::turned(pose, arc.rotation() * self.turn.column(0))
    }

    /// Place after a body-twist increment (m, m, rad).
    pub fn moved_by(&self, increment: &Vec3) -> Self {
        self.moved(&increment.xy(), &Arc::of(increment.z))
    }
}
