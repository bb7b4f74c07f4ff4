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

/// Displacement of a body: the shift of its origin (m) and its turn.
#[derive(Clone, Copy, Debug)]
pub struct Travel {
    pub shift: Vec2,
    pub arc: Arc,
}

impl Travel {
    /// Displacement of the point at an `arm` from the origin (m), with all its digits.
    pub fn of_point(&self, arm: &Vec2) -> Vec2 {
        self.shift + self.arc.turning(arm)
    }
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
        self.after(&Travel { shift: self.turn * arc.shift(shift), arc: *arc })
    }

    /// Place after a displacement in the same frame.
    #[inline]
    pub fn after(&self, Travel { shift, arc }: &Travel) -> Self {
        let Pose { position, heading } = self.pose;
        Self::turned(Pose { position: position + shift, heading: heading + arc.angle() }, arc.rotation() * self.turn.column(0))
    }

    /// Place after a body-twist increment (m, m, rad).
    pub fn moved_by(&self, increment: &Vec3) -> Self {
        self.moved(&increment.xy(), &Arc::of(increment.z))
    }
}
