//! The paper's series of one recording or run: load speed, turn rate, sum of the interaction forces
//! and group size over time, and the test for a phase change in the window of the studies.

use serde::Serialize;

use super::facts::{Changes, Series, WINDOW_S, ticks_in};
use super::window::gathered;
use cohaul::math::{Summary, Vec2};
use cohaul::simulation::Row;
use cohaul_report::quantity::{number, quantity};
use cohaul_report::table::Table;

/// What a recording shows of the load and its team.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Transport {
    /// Ants that pull once the team has gathered: the median number while any pulls (1).
    pub n_gathered: usize,
    /// Start and end of the window in which a change is looked for (s): from the first frame with
    /// so many pulling ants to 60 mm before the nest, or to the end without a nest.
    pub window_s: [f64; 2],
    /// Means over the windows of half a second in it: load speed (m/s), turn rate of either sense
    /// (rad/s), and sum of the sizes of all interaction forces, Eq. (4) (N).
    pub load_speed_m_per_s: f64,
    pub turn_rate_rad_per_s: f64,
    pub interaction_n: f64,
    /// Over the whole recording, by the rounded mean number of pulling ants in half a second.
    pub by_group_size: Vec<OfGroup>,
    /// The best change of mean of each series in the window, and the printed change of all three.
    pub changes: Changes,
    /// The whole recording.
    #[serde(skip)]
    series: Series,
    #[serde(skip)]
    n_pulling: Vec<f64>,
}

/// Load speed while a group pulled.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct OfGroup {
    pub n_pulling: usize,
    pub time_s: f64,
    pub load_speed_m_per_s: f64,
}

impl Transport {
    /// Of frames at equal times, `period` apart (s). Motion is the displacement over half a second:
    /// the sum of all steps would count the noise of a camera. `None` where not even one window of
    /// half a second is there. `seed` is that of the random orders of the tests.
    pub fn of(rows: &[Row], period: f64, nest: Option<Vec2>, seed: u64) -> Option<Self> {
        let ticks = ticks_in(WINDOW_S, period);
        let series = Series::of_rows(rows, period, ticks);
        if series.speed.is_empty() {
            return None;
        }
        let n_pulling = |rows: &[Row]| rows[..ticks].iter().map(|row| row.tips.len()).sum::<usize>() as f64 / ticks as f64;
        let n_pulling: Vec<f64> = rows.windows(ticks + 1).step_by(ticks).map(n_pulling).collect();
        let in_window = Series::once_gathered(rows, period, nest);
        let mean = |values: &[f64]| Summary::of(values.iter().copied()).mean();
        let groups = n_pulling.iter().map(|n| n.round() as usize);
        let of_group = |size: usize| {
            let speeds = Summary::of(groups.clone().zip(&series.speed).filter(|(n, _)| *n == size).map(|(_, speed)| *speed));
            let time_s = speeds.n() as f64 * series.window_s;
            (speeds.n() > 0).then(|| OfGroup { n_pulling: size, time_s, load_speed_m_per_s: speeds.mean() })
        };
        let most = groups.clone().max().unwrap_or(0);
        Some(Self {
            n_gathered: gathered(rows),
            window_s: in_window.span(),
            load_speed_m_per_s: mean(&in_window.speed),
            turn_rate_rad_per_s: mean(&in_window.turn_rate),
            interaction_n: mean(&in_window.interaction),
            by_group_size: (0..=most).filter_map(of_group).collect(),
            changes: Changes::of(&in_window, seed),
            series,
            n_pulling,
        })
    }

    /// One row for each half second.
    pub fn series_table(&self) -> Table {
        let rows: Vec<usize> = (0..self.series.speed.len()).collect();
        Table::of(
            &rows,
            &[
                ("time", "s", &|at| (self.series.start_s + self.series.window_s * *at as f64).into()),
                ("load speed", "m/s", &|at| self.series.speed[*at].into()),
                ("turn rate", "rad/s", &|at| self.series.turn_rate[*at].into()),
                ("interaction", "N", &|at| self.series.interaction[*at].into()),
                ("n pulling", "", &|at| self.n_pulling[*at].into()),
            ],
        )
    }

    /// Means, speeds by group size and changes, for people.
    pub fn text(&self) -> String {
        let [from, to] = self.window_s.map(|time| quantity(time, "s"));
        let means = [
            format!("{} pull from {from} to {to}", self.n_gathered),
            format!("load speed {}", quantity(self.load_speed_m_per_s, "m/s")),
            format!("turn rate {}", quantity(self.turn_rate_rad_per_s, "rad/s")),
            format!("interaction {}", quantity(self.interaction_n, "N")),
        ];
        let groups = Table::new("", ["pulling", "time", "load speed"]).with_rows(
            self.by_group_size
                .iter()
                .map(|of| [of.n_pulling.to_string(), quantity(of.time_s, "s"), quantity(of.load_speed_m_per_s, "m/s")]),
        );
        let change = |(name, of): (&str, super::ChangeOf)| {
            let Some(at) = of(&self.changes) else { return [name.to_owned(), "too short".to_owned(), String::new(), String::new()] };
            let unit = [("speed", "m/s"), ("turn rate", "rad/s"), ("interaction", "N")].iter().find(|(own, _)| *own == name);
            let unit = unit.map_or("", |(_, unit)| unit);
            let means = format!("{} to {}", quantity(at.change.mean_before, unit), quantity(at.change.mean_after, unit));
            [name.to_owned(), quantity(at.time_s, "s"), means, number(at.change.p_value)]
        };
        let changes = Table::new("", ["change of", "at", "mean before and after", "p"]).with_rows(Changes::OF_SERIES.map(change));
        let phase = self.changes.phase.map_or_else(String::new, |at| {
            let found = if at.change.is_significant() { "change" } else { "no change beyond chance, likeliest" };
            format!("all three at once: {found} at {}, p = {}\n", quantity(at.time_s, "s"), number(at.change.p_value))
        });
        format!("{}\n\n{}\n{}{phase}", means.join("\n"), groups.text(), changes.text())
    }
}
