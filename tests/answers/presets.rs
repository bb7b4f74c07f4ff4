//! Where the default preset comes from.

use cohaul::model::behaviour::ReleasePace;
use cohaul::scenario::presets::{Preset, ants};

/// The rule by which the default preset was chosen.
#[test]
fn the_preset_paper_is_the_closest_accepted_set() {
    let mut table = csv::Reader::from_reader(&include_bytes!("../../results/2026-11-25-parameter-search/accepted.csv")[..]);
    let names = table.headers().unwrap().clone();
    let rows: Vec<csv::StringRecord> = table.records().map(Result::unwrap).collect();
    let number = |row: &csv::StringRecord, name: &str| -> f64 { row[names.iter().position(|own| own == name).unwrap()].parse().unwrap() };
    let closest = rows.iter().min_by(|a, b| number(a, "distance").total_cmp(&number(b, "distance"))).unwrap();
    let chosen = ants(Preset::Paper, 1);
    let speed = number(closest, "speed_in_Transport_m_per_s");
    for (own, theirs) in [
        (chosen.pull_speed, speed),
        (chosen.release.period, number(closest, "way_of_a_tip_between_release_decisions_m") / speed),
        (chosen.grasp_decision_period, number(closest, "grasp_decision_period_s")),
        (chosen.sensing_range, number(closest, "sensing_range_m")),
        (chosen.arrival_radius, number(closest, "nest_radius_m")),
        (chosen.start_half_width, number(closest, "start_area_half_width_m")),
        (chosen.target_redraw_period, number(closest, "redraw_period_of_the_believed_position_s")),
    ] {
        // Half of the third digit of a number that begins with one.
        assert!((own / theirs - 1.0).abs() < 5e-3, "{own} {theirs}");
    }
    assert_eq!(&closest[names.iter().position(|name| name == "times_of_release_decisions").unwrap()], "hazard");
    assert_eq!(chosen.release_pace, ReleasePace::Hazard);
}
