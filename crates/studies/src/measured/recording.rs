//! Recordings of real pushes and pulls: a table of instants with the poses of the load and of what
//! moves it.

use cohaul::math::{Pose, Vec2, unwrap_near};
use cohaul::scenario::ScenarioError;

pub use super::columns::Reading;
use super::columns::{Body, Columns};
use crate::csv_input::Table;

/// Measured runs with what was done to read them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Recording {
    pub runs: Vec<MeasuredRun>,
    /// What was left out, put in order or converted, in sentences.
    pub notes: Vec<String>,
}

/// One measured run.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasuredRun {
    pub name: String,
    pub load: Track,
    /// Obstacles by name.
    pub obstacles: Vec<(String, Track)>,
    /// Tips by the index of their spring; headings are zero.
    pub tips: Vec<(usize, Track)>,
    /// Time (s) and force of an obstacle on the load (N, world), by its name.
    pub forces: Vec<(String, Vec<(f64, Vec2)>)>,
    /// Standard deviation of a position of the load on each axis (m) and of its heading (rad), as
    /// the table states them.
    pub uncertainty: Option<[f64; 2]>,
}

/// Poses of a body over increasing times (s).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Track {
    pub samples: Vec<(f64, Pose)>,
}

/// What a row of a run says.
struct Instant {
    time: f64,
    poses: Vec<Option<Pose>>,
    forces: Vec<Option<Vec2>>,
    uncertainty: Option<[f64; 2]>,
}

/// What was counted while reading.
#[derive(Default)]
struct Counts {
    n_out_of_order: usize,
    n_repeated: usize,
    n_unsure: usize,
}

impl Track {
    /// Longest time between two samples (s); zero for fewer than two.
    pub fn longest_gap(&self) -> f64 {
        self.samples.windows(2).map(|pair| pair[1].0 - pair[0].0).fold(0.0, f64::max)
    }
}

impl Recording {
    /// The runs in the table `text` of the file `file`, for a scene with these `obstacles` and
    /// `n_springs`. A table without a column `run` is one run of the name `alone`.
    ///
    /// # Errors
    /// When the table has not the columns of a recording, or a field is no number.
    pub fn parse(
        text: &str,
        file: &str,
        alone: &str,
        (obstacles, n_springs): (&[String], usize),
        reading: &Reading,
    ) -> Result<Self, ScenarioError> {
        let mut table = Table::parse(text, file, &[])?;
        let columns = Columns::of(&mut table, (obstacles, n_springs), reading);
        let mut table = table.whole()?;
        let mut counts = Counts::default();
        let mut runs: Vec<(String, Vec<Instant>)> = Vec::new();
        for row in 0..table.n_rows() {
            let Some(instant) = instant(&mut table, row, &columns, reading, &mut counts) else { continue };
            let name = columns.run.as_deref().map_or(alone, |run| table.text(row, run));
            // Rows of a run mostly follow each other.
            match runs.iter_mut().rev().find(|(run, _)| run == name) {
                Some((_, instants)) => instants.push(instant),
                None => runs.push((name.to_owned(), vec![instant])),
            }
        }
        if table.n_rows() == 0 {
            table.report("rows", "must hold poses", "none");
        }
        table.whole()?;
        let mut recording = Self { notes: columns.notes.clone(), ..Self::default() };
        recording.runs = runs.into_iter().map(|(name, instants)| run_of(name, instants, &columns, &mut counts)).collect();
        recording.notes.extend(counts.notes(reading));
        Ok(recording)
    }

    /// Adds the runs of another table.
    pub fn add(&mut self, other: Self) {
        self.runs.extend(other.runs);
        for note in other.notes {
            if !self.notes.contains(&note) {
                self.notes.push(note);
            }
        }
    }
}

impl Counts {
    fn notes(&self, reading: &Reading) -> Vec<String> {
        let Self { n_out_of_order, n_repeated, n_unsure } = self;
        let note = |n: &usize, what: String| (*n > 0).then(|| format!("{n} {what}"));
        [
            note(n_out_of_order, "rows were put in the order of their times".into()),
            note(n_repeated, "rows were left out: their run has an earlier row of the same time".into()),
            note(n_unsure, format!("poses were left out: their confidence is below {}", reading.least_confidence)),
        ]
        .into_iter()
        .flatten()
        .collect()
    }
}

/// What a row says; `None` where it has a fault.
fn instant(table: &mut Table, row: usize, columns: &Columns, reading: &Reading, counts: &mut Counts) -> Option<Instant> {
    let time = table.number(row, &columns.time.name)? * columns.time.factor;
    let mut poses = Vec::new();
    for body in &columns.bodies {
        let mut pose = body.pose(table, row)?;
        let is_unsure = |table: &mut Table, column: &String| table.number(row, column).is_none_or(|value| value < reading.least_confidence);
        if pose.is_some() && body.confidence.as_ref().is_some_and(|column| is_unsure(table, column)) {
            counts.n_unsure += 1;
            pose = None;
        }
        poses.push(pose);
    }
    let forces = columns.bodies.iter().map(|body| body.force(table, row)).collect::<Option<_>>()?;
    let uncertainty = match &columns.uncertainty {
        Some(of) => of.numbers(table, row)?,
        None => None,
    };
    Some(Instant { time, poses, forces, uncertainty })
}

/// A run from its rows, in the order of time and with headings that do not jump by a turn.
fn run_of(name: String, mut instants: Vec<Instant>, columns: &Columns, counts: &mut Counts) -> MeasuredRun {
    counts.n_out_of_order += instants.windows(2).filter(|pair| pair[1].time < pair[0].time).count();
    instants.sort_by(|a, b| a.time.total_cmp(&b.time));
    let n = instants.len();
    instants.dedup_by(|later, earlier| later.time == earlier.time);
    counts.n_repeated += n - instants.len();
    let track = |body: usize| {
        let mut samples: Vec<(f64, Pose)> = Vec::new();
        for (time, pose) in instants.iter().filter_map(|instant| Some((instant.time, instant.poses[body]?))) {
            let heading = samples.last().map_or(pose.heading, |(_, last)| unwrap_near(pose.heading, last.heading));
            samples.push((time, Pose { heading, ..pose }));
        }
        Track { samples }
    };
    let forces =
        |body: usize| -> Vec<(f64, Vec2)> { instants.iter().filter_map(|instant| Some((instant.time, instant.forces[body]?))).collect() };
    let mut run = MeasuredRun {
        name,
        load: Track::default(),
        obstacles: Vec::new(),
        tips: Vec::new(),
        forces: Vec::new(),
        uncertainty: instants.iter().rev().find_map(|instant| instant.uncertainty),
    };
    for (at, columns) in columns.bodies.iter().enumerate() {
        match &columns.body {
            Body::Load => run.load = track(at),
            Body::Tip(spring) => run.tips.push((*spring, track(at))),
            Body::Obstacle(name) => {
                run.obstacles.push((name.clone(), track(at)));
                if columns.force.is_some() {
                    run.forces.push((name.clone(), forces(at)));
                }
            }
        }
    }
    run
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCENE: [&str; 1] = ["finger"];

    fn read(text: &str, reading: &Reading) -> Result<Recording, String> {
        let obstacles = SCENE.map(str::to_owned);
        Recording::parse(text, "a.csv", "a", (&obstacles, 1), reading).map_err(|error| error.to_string())
    }

    #[test]
    fn rows_are_sorted_and_what_is_missing_stays_missing() {
        let text = "run,time_s,finger_x_mm,finger_y_mm,load_x_m,load_y_m,load_heading_deg,note\n\
                    2,0.1,1,2,,,,a\n2,0,0,0,0.5,0.25,179,b\n2,0.2,2,4,0.5,0.25,-179,c\n2,0.2,9,9,,,,d\n1,0,0,0,nan,NaN,,e\n";
        let found = read(text, &Reading::default()).unwrap();
        assert_eq!(found.runs.iter().map(|run| run.name.as_str()).collect::<Vec<_>>(), ["2", "1"]);
        let run = &found.runs[0];
        assert_eq!(run.obstacles[0].1.samples.iter().map(|(time, _)| *time).collect::<Vec<_>>(), [0.0, 0.1, 0.2]);
        assert_eq!(run.obstacles[0].1.samples[1].1, Pose::new(1e-3, 2e-3, 0.0));
        let [(from, a), (to, b)] = run.load.samples[..] else { panic!("{run:?}") };
        // Across half a turn: 2 degrees, and not 358.
        assert!((from, to) == (0.0, 0.2) && (b.heading - a.heading - 2f64.to_radians()).abs() < 1e-12);
        assert!(found.runs[1].load.samples.is_empty());
        let notes = found.notes.join("\n");
        for note in ["1 rows were put in the order", "1 rows were left out: their run", "note: passed over", "mm were converted"] {
            assert!(notes.contains(note), "{note}: {notes}");
        }
    }

    #[test]
    fn columns_have_any_names_and_poses_a_confidence() {
        let columns = [
            ("time_s", "t"),
            ("load_x_m", "X"),
            ("load_y_m", "Y"),
            ("load_heading_rad", "H"),
            ("finger_force_x_n", "force_x_n"),
            ("finger_force_y_n", "force_y_n"),
            ("load_confidence", "score"),
        ];
        let columns = columns.map(|(name, column)| (name.to_owned(), column.to_owned())).to_vec();
        let text = "t,X,Y,H,score,finger_x_m,finger_y_m,force_x_n,force_y_n\n0,1,2,3,0.95,0,0,0.5,-1\n1,1,2,3,0.5,0,0,,\n";
        let found = read(text, &Reading { columns: columns.clone(), least_confidence: 0.9 }).unwrap();
        assert_eq!(found.runs[0].name, "a");
        assert_eq!(found.runs[0].load.samples, [(0.0, Pose::new(1.0, 2.0, 3.0))]);
        assert_eq!(found.runs[0].forces, [("finger".to_owned(), vec![(0.0, Vec2::new(0.5, -1.0))])]);
        let wrong = [("load_x_m".to_owned(), "Z".to_owned())].to_vec();
        let fault = read(text, &Reading { columns: wrong, least_confidence: 0.0 }).unwrap_err();
        assert!(fault.contains("load_x_m: must be a column of the table, found Z"), "{fault}");
    }

    #[test]
    fn faults_name_line_and_rule() {
        let head = "time_s,load_x_m,load_y_m,load_heading_rad,finger_x_m,finger_y_m\n";
        for (text, fault) in [
            (format!("{head}0,1,,3,0,0\n"), "line 2, load_y_m: must be there with load_x_m, or both left out, found nothing"),
            (format!("{head}0,1,2,x,0,0\n"), "line 2, load_heading_rad: must be a finite number, found x"),
            (format!("{head},1,2,3,0,0\n"), "line 2, time_s: must be a finite number, found nothing"),
            (head.to_owned(), "rows: must hold poses, found none"),
            ("time_s,load_x_m,load_y_m\n0,1,2\n".to_owned(), "header: must have a column load_heading_rad"),
            ("time_s,load_x_m,load_y_m,load_heading_rad\n0,1,2,3\n".to_owned(), "header: must have the places of an obstacle or tip"),
            ("time_s,load_x_m,load_y_in,load_heading_rad,finger_x_m,finger_y_m\n".to_owned(), "must have a column load_y_m"),
        ] {
            let found = read(&text, &Reading::default()).unwrap_err();
            assert!(found.contains(fault), "{text}: {found}");
        }
    }
}
