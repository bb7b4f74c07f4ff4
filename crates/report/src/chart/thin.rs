//! Fewer points, same picture.

/// A graph (x not decreasing) with at most four points in each of `n_columns` equal columns: the
/// first, the lowest, the highest and the last one, in their order (M4: Jugel, Jerzak,
/// Hackenbroich, Markl, VLDB 2014). No extreme of any column is lost, so a line drawn that many
/// pixels wide is the same. Points must be finite.
pub fn by_column(points: &[[f64; 2]], n_columns: usize) -> Vec<[f64; 2]> {
    if points.len() <= 4 * n_columns {
        return points.to_vec();
    }
    chunks(points, ends_of(points, |point| point[0]), n_columns, |point| point[0]).flat_map(|(_, chunk)| extremes(chunk)).collect()
}

/// First, lowest, highest and last point of a column, each once.
fn extremes(points: &[[f64; 2]]) -> impl Iterator<Item = [f64; 2]> {
    let by_height = |a: &usize, b: &usize| points[*a][1].total_cmp(&points[*b][1]);
    let last = points.len() - 1;
    let lowest = (0..=last).min_by(by_height).unwrap_or(0);
    let highest = (0..=last).max_by(by_height).unwrap_or(0);
    let mut kept = vec![0, lowest, highest, last];
    kept.sort_unstable();
    kept.dedup();
    kept.into_iter().map(|at| points[at])
}

/// What is left of one column of a graph that is too dense to follow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Column {
    /// Middle of its points.
    pub x: f64,
    pub low: f64,
    pub mean: f64,
    pub high: f64,
}

/// Range and mean of a graph (x not decreasing) in each of `n_columns` equal columns between two
/// `ends` that has points, in runs of neighbours. What is not finite is a gap, which shows where it
/// leaves a column without points.
pub fn columns(points: &[[f64; 2]], ends: [f64; 2], n_columns: usize) -> Vec<Vec<Column>> {
    let finite: Vec<[f64; 2]> = points.iter().copied().filter(|[x, y]| (x + y).is_finite()).collect();
    let (mut runs, mut next): (Vec<Vec<Column>>, _) = (Vec::new(), None);
    for (at, chunk) in chunks(&finite, ends, n_columns, |point| point[0]) {
        match runs.last_mut().filter(|_| next == Some(at)) {
            Some(run) => run.push(column_of(chunk)),
            None => runs.push(vec![column_of(chunk)]),
        }
        next = Some(at + 1);
    }
    let half = 0.5 * (ends[1] - ends[0]) / n_columns as f64;
    for run in &mut runs {
        // One alone is as wide as it is.
        if let [alone] = run[..] {
            *run = [-half, half].map(|aside| Column { x: alone.x + aside, ..alone }).to_vec();
        }
    }
    runs
}

/// Range and mean in each of `n_columns` equal columns from narrower ones of as many points each.
pub fn merged(columns: &[Column], n_columns: usize) -> Vec<Column> {
    let of = |(_, chunk): (usize, &[Column])| {
        let (first, last) = (chunk[0], chunk[chunk.len() - 1]);
        let low = chunk.iter().map(|column| column.low).fold(f64::INFINITY, f64::min);
        let high = chunk.iter().map(|column| column.high).fold(f64::NEG_INFINITY, f64::max);
        let mean = chunk.iter().map(|column| column.mean).sum::<f64>() / chunk.len() as f64;
        Column { x: 0.5 * (first.x + last.x), low, mean, high }
    };
    chunks(columns, ends_of(columns, |column| column.x), n_columns, |column| column.x).map(of).collect()
}

/// A line through both ends of each column, the nearer one to where it comes from first.
pub fn up_and_down(columns: &[Column]) -> Vec<[f64; 2]> {
    let mut points: Vec<[f64; 2]> = Vec::with_capacity(2 * columns.len());
    for Column { x, low, high, .. } in columns {
        let from = points.last().map_or(*low, |last| last[1]);
        let [near, far] = if (from - low).abs() <= (from - high).abs() { [*low, *high] } else { [*high, *low] };
        points.push([*x, near]);
        if near != far {
            points.push([*x, far]);
        }
    }
    points
}

/// How often the graph, cut at `low` and `high`, runs from one to the other.
pub fn n_crossings(points: &[[f64; 2]], low: f64, high: f64) -> f64 {
    let Some((first, others)) = points.split_first() else { return 0.0 };
    let (mut way, mut last) = (0.0, first[1].clamp(low, high));
    for point in others {
        let here = point[1].clamp(low, high);
        way += (here - last).abs();
        last = here;
    }
    way / (high - low)
}

/// Those of the same of `n_columns` equal columns between two `ends`, with its number.
fn chunks<T>(points: &[T], ends: [f64; 2], n_columns: usize, x: impl Fn(&T) -> f64) -> impl Iterator<Item = (usize, &[T])> {
    let width = (ends[1] - ends[0]) / n_columns as f64;
    // The far end belongs to the last column.
    let column = move |point: &T| (((x(point) - ends[0]) / width) as usize).min(n_columns - 1);
    let mut rest = points;
    std::iter::from_fn(move || {
        let here = column(rest.first()?);
        let (chunk, others) = rest.split_at(rest.partition_point(|point| column(point) <= here));
        rest = others;
        Some((here, chunk))
    })
}

/// Where the first and the last point lie.
fn ends_of<T>(points: &[T], x: impl Fn(&T) -> f64) -> [f64; 2] {
    [points.first(), points.last()].map(|point| point.map_or(0.0, &x))
}

fn column_of(points: &[[f64; 2]]) -> Column {
    let (mut low, mut sum, mut high) = (f64::INFINITY, 0.0, f64::NEG_INFINITY);
    for [_, y] in points {
        // Not `f64::min`, which takes longer as it minds what is no number.
        low = if *y < low { *y } else { low };
        high = if *y > high { *y } else { high };
        sum += y;
    }
    Column { x: 0.5 * (points[0][0] + points[points.len() - 1][0]), low, mean: sum / points.len() as f64, high }
}

/// A line in the plane without the points that lie within `tolerance` of the one kept before them;
/// its ends stay. No point of the line is further than `tolerance` from a kept one.
pub fn by_distance(points: &[[f64; 2]], tolerance: f64) -> Vec<[f64; 2]> {
    let Some((last, others)) = points.split_last() else { return Vec::new() };
    let mut kept: Vec<[f64; 2]> = Vec::new();
    for point in others {
        let is_far = |before: &[f64; 2]| (point[0] - before[0]).powi(2) + (point[1] - before[1]).powi(2) > tolerance * tolerance;
        if kept.last().is_none_or(is_far) {
            kept.push(*point);
        }
    }
    kept.push(*last);
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wave(n: usize) -> Vec<[f64; 2]> {
        let mut points: Vec<_> = (0..n).map(|k| [k as f64 * 0.01, (k as f64 * 0.7).sin() + (k as f64 * 1e-3).cos()]).collect();
        points[n / 3][1] = 40.0;
        points[n / 2][1] = -70.0;
        points
    }

    fn range(points: &[[f64; 2]]) -> (f64, f64) {
        points.iter().fold((f64::MAX, f64::MIN), |(low, high), point| (low.min(point[1]), high.max(point[1])))
    }

    #[test]
    fn every_extreme_of_every_column_survives() {
        let points = wave(120_001);
        let thinned = by_column(&points, 400);
        assert!(thinned.len() <= 1600, "{}", thinned.len());
        assert_eq!((thinned.first(), thinned.last()), (points.first(), points.last()));
        assert!(thinned.windows(2).all(|pair| pair[0][0] < pair[1][0]));
        for column in 0..400 {
            // The last point stands on the far edge of the last column.
            let inside = |point: &&[f64; 2]| ((point[0] / (1200.0 / 400.0)) as usize).min(399) == column;
            let all: Vec<_> = points.iter().filter(inside).copied().collect();
            let kept: Vec<_> = thinned.iter().filter(inside).copied().collect();
            assert_eq!(range(&kept), range(&all), "{column}");
        }
        assert_eq!(range(&thinned), (-70.0, 40.0));
    }

    #[test]
    fn columns_keep_the_range_and_the_mean() {
        let points = wave(120_001);
        let runs = columns(&points, [0.0, 1200.0], 100);
        let [columns] = &runs[..] else { panic!("{} runs of a graph without gaps", runs.len()) };
        assert_eq!(columns.len(), 100);
        let low = columns.iter().map(|column| column.low).fold(f64::MAX, f64::min);
        let high = columns.iter().map(|column| column.high).fold(f64::MIN, f64::max);
        assert_eq!((low, high), range(&points));
        assert!(columns.iter().all(|column| column.low <= column.mean && column.mean <= column.high));
        let mean = points.iter().map(|point| point[1]).sum::<f64>() / points.len() as f64;
        // Columns have 1200 points each, the last one 1201.
        assert!((columns.iter().map(|column| column.mean).sum::<f64>() / 100.0 - mean).abs() < 1e-4);
        assert_eq!(n_crossings(&[[0.0, 0.0], [1.0, 2.0], [2.0, -1.0]], -1.0, 1.0), 1.5);
    }

    /// Gaps narrower than a column do not part it; wider ones leave what lies between them apart,
    /// and a column alone has its width.
    #[test]
    fn columns_are_those_of_the_whole_axis_however_a_graph_is_broken() {
        let is_there =
            |x: f64| ((x * 10.0) as u32).is_multiple_of(2) && !(30.0..40.0).contains(&x) && !(45.0..47.0).contains(&x) || x == 35.5;
        let points: Vec<[f64; 2]> =
            (0..=10_000).map(|k| f64::from(k) * 0.01).map(|x| [x, if is_there(x) { x.fract() } else { f64::NAN }]).collect();
        let runs = columns(&points, [0.0, 100.0], 100);
        let of = |run: &Vec<Column>| (run.len(), run[0].x.floor(), run[run.len() - 1].x.floor());
        assert_eq!(runs.iter().map(of).collect::<Vec<_>>(), [(30, 0.0, 29.0), (2, 35.0, 36.0), (5, 40.0, 44.0), (53, 47.0, 99.0)]);
        assert_eq!((runs[1][0].x, runs[1][1].x), (35.0, 36.0));
        // Every other tenth is missing, the last one of each second too.
        assert!(runs[0].iter().all(|column| column.low < 0.005 && (column.high - 0.89).abs() < 0.005));
    }

    #[test]
    fn few_points_stay_as_they_are() {
        let points = wave(50);
        assert_eq!(by_column(&points, 400), points);
        assert_eq!(by_column(&[], 400), Vec::<[f64; 2]>::new());
        assert_eq!(by_column(&[[1.0, 2.0]; 5000], 400), [[1.0, 2.0]; 2], "one instant has two ends");
    }

    #[test]
    fn no_point_of_a_path_is_far_from_a_kept_one() {
        let path: Vec<[f64; 2]> =
            (0..5000).map(|k| (k as f64 * 0.01).sin_cos().into()).map(|[s, c]: [f64; 2]| [40.0 * s, 30.0 * c * c]).collect();
        let kept = by_distance(&path, 0.5);
        assert!(kept.len() < path.len() / 2);
        assert_eq!((kept.first(), kept.last()), (path.first(), path.last()));
        for point in &path {
            assert!(kept.iter().any(|near| (point[0] - near[0]).hypot(point[1] - near[1]) <= 0.5));
        }
    }
}
