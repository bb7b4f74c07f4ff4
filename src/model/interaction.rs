//! Interaction force between two ants on one load (Eq. 4).

use crate::math::Vec2;

/// Signed interaction force of two ants with `pulls` (N) at `tips` (m), Eq. (4): the difference of
/// their pulls along the line between the tips, positive when they pull apart (N). It moves no
/// load: adding it to both pulls with opposite signs changes neither force nor torque. It is zero
/// for coincident tips, which have no line.
pub fn interaction_force(tips: [Vec2; 2], pulls: [Vec2; 2]) -> f64 {
    let line = tips[0] - tips[1];
    let length = line.norm();
    if length > 0.0 { (pulls[0] - pulls[1]).dot(&line) / length } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pulling_apart_counts_twice_and_pulling_along_does_not_count() {
        let tips = [Vec2::new(1.0, 0.0), Vec2::new(-1.0, 0.0)];
        let outwards = [Vec2::new(0.3, 0.0), Vec2::new(-0.3, 0.0)];
        assert_eq!(interaction_force(tips, outwards), 0.6);
        assert_eq!(interaction_force([tips[1], tips[0]], [outwards[1], outwards[0]]), 0.6);
        assert_eq!(interaction_force(tips, [Vec2::new(0.2, 0.5); 2]), 0.0);
        assert_eq!(interaction_force([tips[0]; 2], outwards), 0.0);
    }
}
