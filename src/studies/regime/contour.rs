//! Lines of equal value on a grid: marching squares (Lorensen and Cline, 1987, in the plane), straight within a square.

/// Segments of the line on which the field, bilinear between nodes, has the value `level`. `field` is in rows of `x.len()` values, one row a value of `y`; squares with a
/// node that has no finite value have no line. Where two opposite corners are above and two below, the mean decides how they are joined.
pub fn contour(x: &[f64], y: &[f64], field: &[f64], level: f64) -> Vec<[[f64; 2]; 2]> {
    assert_eq!(field.len(), x.len() * y.len(), "a value a node");
    let mut segments = Vec::new();
    for row in 0..y.len().saturating_sub(1) {
        for column in 0..x.len().saturating_sub(1) {
            let corners = [[0, 0], [1, 0], [1, 1], [0, 1]].map(|[i, j]| {
                let (i, j) = (column + i, row + j);
                ([x[i], y[j]], field[j * x.len() + i] - level)
            });
            if corners.iter().all(|(_, height)| height.is_finite()) {
                segments.extend(in_square(&corners));
            }
        }
    }
    segments
}

/// The same segments as whole lines, so that dashes run on from one to the next.
pub fn lines(mut segments: Vec<[[f64; 2]; 2]>) -> Vec<Vec<[f64; 2]>> {
    let mut lines = Vec::new();
    while let Some([a, b]) = segments.pop() {
        let mut line = vec![a, b];
        for _ in 0..2 {
            while let Some((at, next)) =
                segments.iter().enumerate().find_map(|(at, segment)| Some((at, beyond(segment, line[line.len() - 1])?)))
            {
                segments.swap_remove(at);
                line.push(next);
            }
            // Then on from its other end.
            line.reverse();
        }
        lines.push(line);
    }
    lines
}

/// The other end of a segment that ends at `point`. Neighbouring squares find a point of their common edge with the same digits but for rounding.
fn beyond([a, b]: &[[f64; 2]; 2], point: [f64; 2]) -> Option<[f64; 2]> {
    let is_same = |end: &[f64; 2]| (end[0] - point[0]).abs() + (end[1] - point[1]).abs() < 1e-9;
    if is_same(a) {
        Some(*b)
    } else if is_same(b) {
        Some(*a)
    } else {
        None
    }
}

/// Corners in their order around the square, with their heights over the level.
fn in_square(corners: &[([f64; 2], f64); 4]) -> Vec<[[f64; 2]; 2]> {
    let crossing = |edge: usize| {
        let ((a, from), (b, to)) = (corners[edge], corners[(edge + 1) % 4]);
        // A height of zero counts as above, on both sides of an edge alike.
        ((from >= 0.0) != (to >= 0.0)).then(|| {
            let share = from / (from - to);
            [a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])]
        })
    };
    let at: Vec<[f64; 2]> = (0..4).filter_map(crossing).collect();
    match at[..] {
        [a, b] => vec![[a, b]],
        [a, b, c, d] => {
            let mean: f64 = corners.iter().map(|(_, height)| height).sum();
            // The middle hangs together with the first corner and its opposite, and the other two are cut off, or the other way round.
            if (mean >= 0.0) == (corners[0].1 >= 0.0) { vec![[a, b], [c, d]] } else { vec![[d, a], [b, c]] }
        }
        _ => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A plane is met exactly: every end of a segment lies on the line, and the line is as long as it should be.
    #[test]
    fn a_straight_line_is_found_where_it_is() {
        let x: Vec<f64> = (0..6).map(f64::from).collect();
        let y: Vec<f64> = (0..4).map(f64::from).collect();
        let field: Vec<f64> = y.iter().flat_map(|y| x.iter().map(move |x| x + 2.0 * y)).collect();
        let segments = contour(&x, &y, &field, 4.3);
        assert!(segments.iter().flatten().all(|[x, y]| (x + 2.0 * y - 4.3).abs() < 1e-14));
        let length: f64 = segments.iter().map(|[a, b]| (a[0] - b[0]).hypot(a[1] - b[1])).sum();
        // From (4.3, 0) to (0, 2.15).
        assert!((length - 4.3f64.hypot(2.15)).abs() < 1e-13, "{length}");
        assert!(contour(&x, &y, &field, 100.0).is_empty());
    }

    /// A circle by chords: its radius to the square of the grid over eight radii, in one closed line.
    #[test]
    fn a_circle_is_closed_and_round() {
        let axis: Vec<f64> = (-10..=10).map(|i| 0.1 * f64::from(i)).collect();
        let field: Vec<f64> = axis.iter().flat_map(|y| axis.iter().map(move |x| x.hypot(*y))).collect();
        let segments = contour(&axis, &axis, &field, 0.73);
        let ends: Vec<[f64; 2]> = segments.iter().flatten().copied().collect();
        assert!(ends.iter().all(|[x, y]| (x.hypot(*y) - 0.73).abs() < 0.01 / (8.0 * 0.73) + 1e-3));
        // Every end is that of one other segment too.
        let n_at = |point: &[f64; 2]| ends.iter().filter(|end| (end[0] - point[0]).abs() + (end[1] - point[1]).abs() < 1e-12).count();
        assert!(ends.iter().all(|end| n_at(end) == 2));
    }

    /// The circle is one line that ends where it began; two circles are two.
    #[test]
    fn segments_become_whole_lines() {
        let axis: Vec<f64> = (-10..=10).map(|i| 0.1 * f64::from(i)).collect();
        let field: Vec<f64> = axis.iter().flat_map(|y| axis.iter().map(move |x| x.hypot(*y))).collect();
        let segments = [contour(&axis, &axis, &field, 0.73), contour(&axis, &axis, &field, 0.41)].concat();
        let n_segments = segments.len();
        let lines = lines(segments);
        assert_eq!(lines.len(), 2);
        assert_eq!(lines.iter().map(|line| line.len() - 1).sum::<usize>(), n_segments);
        assert!(lines.iter().all(|line| (line[0][0] - line[line.len() - 1][0]).abs() < 1e-9));
    }

    #[test]
    fn saddles_join_through_the_middle_and_gaps_stay_empty() {
        let (x, y) = ([0.0, 1.0], [0.0, 1.0]);
        // High at two opposite corners: the higher mean joins them, and cuts the low ones off.
        let joined = contour(&x, &y, &[2.0, -1.0, -1.0, 2.0], 0.0);
        assert_eq!(joined.len(), 2);
        let off_diagonal = |[a, b]: &[[f64; 2]; 2]| ((0.5 * (a[0] + b[0])) - (0.5 * (a[1] + b[1]))).abs();
        assert!(joined.iter().all(|segment| off_diagonal(segment) > 0.5));
        let parted = contour(&x, &y, &[1.0, -2.0, -2.0, 1.0], 0.0);
        assert!(parted.iter().all(|segment| off_diagonal(segment) < 1e-12));
        assert!(contour(&x, &y, &[2.0, -1.0, f64::NAN, 2.0], 0.0).is_empty());
    }
}
