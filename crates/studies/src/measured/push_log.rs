//! Logs of single pushes as JSON, in the form of the MIT push data set (Yu, Bauza, Fazeli and
//! Rodriguez, *More than a million ways to be pushed*, IROS 2016): lists of rows [time, x, y,
//! heading] under `object_pose` and `tip_pose`, and [time, x, y, torque] under `ft_wrench`, in SI
//! units.

use std::collections::BTreeMap;

use serde_json::Value;

/// Lists of a log, the columns of a recording that they fill, and whether they may be left out.
const LISTS: [(&str, &str, &[&str], bool); 3] = [
    ("object_pose", "load", &["_x_m", "_y_m", "_heading_rad"], false),
    ("tip_pose", "", &["_x_m", "_y_m", "_heading_rad"], false),
    ("ft_wrench", "", &["_force_x_n", "_force_y_n"], true),
];

/// The text of a recording of one run: a row for each time of any list, with the pushing obstacle
/// under this name.
///
/// # Errors
/// When the text is no such log: place, rule, and what was found.
pub fn csv_of_push_log(text: &str, obstacle: &str) -> Result<String, String> {
    let log: Value = serde_json::from_str(text).map_err(|error| format!("must be JSON: {error}"))?;
    let (mut header, mut n_columns) = ("time_s".to_owned(), 0);
    // Times are ordered as bits, which is their order where they are not negative.
    let mut rows: BTreeMap<u64, Vec<String>> = BTreeMap::new();
    for (list, body, endings, is_optional) in LISTS {
        let Some(entries) = log.get(list).and_then(Value::as_array) else {
            if is_optional {
                continue;
            }
            return Err(format!("{list}: must be a list of rows, found {}", log.get(list).map_or("nothing", |_| "something else")));
        };
        let body = if body.is_empty() { obstacle } else { body };
        endings.iter().for_each(|ending| header += &format!(",{body}{ending}"));
        for (at, entry) in entries.iter().enumerate() {
            let numbers: Vec<f64> = entry.as_array().into_iter().flatten().filter_map(Value::as_f64).collect();
            if numbers.len() <= endings.len() || numbers[0] < 0.0 {
                return Err(format!("{list}[{at}]: must be a time, zero or later, and {} numbers, found {entry}", endings.len()));
            }
            let row = rows.entry((numbers[0] + 0.0).to_bits()).or_default();
            row.resize(n_columns, String::new());
            row.extend(numbers[1..=endings.len()].iter().map(f64::to_string));
        }
        n_columns += endings.len();
        rows.values_mut().for_each(|row| row.resize(n_columns, String::new()));
    }
    let row = |(time, fields): (&u64, &Vec<String>)| format!("{},{}\n", f64::from_bits(*time), fields.join(","));
    Ok(header + "\n" + &rows.iter().map(row).collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_are_joined_by_their_times() {
        let log = r#"{ "object_pose": [[0.5, 1, 2, 3], [0.0, 4, 5, 6]], "tip_pose": [[0.0, 7, 8, 9], [0.25, 1, 1, 1]],
                       "ft_wrench": [[0.25, 0.5, -0.5, 0.1]], "other": 1 }"#;
        let text = csv_of_push_log(log, "tip").unwrap();
        let expected = "time_s,load_x_m,load_y_m,load_heading_rad,tip_x_m,tip_y_m,tip_heading_rad,tip_force_x_n,tip_force_y_n\n\
                        0,4,5,6,7,8,9,,\n0.25,,,,1,1,1,0.5,-0.5\n0.5,1,2,3,,,,,\n";
        assert_eq!(text, expected);
    }

    #[test]
    fn faults_name_place_and_rule() {
        for (log, fault) in [
            ("[", "must be JSON"),
            (r#"{ "tip_pose": [] }"#, "object_pose: must be a list of rows, found nothing"),
            (r#"{ "object_pose": 3, "tip_pose": [] }"#, "object_pose: must be a list of rows, found something else"),
            (r#"{ "object_pose": [[0, 1, 2]], "tip_pose": [] }"#, "object_pose[0]: must be a time, zero or later, and 3 numbers"),
            (r#"{ "object_pose": [[0, 1, null, 3]], "tip_pose": [] }"#, "object_pose[0]: must be a time"),
        ] {
            let found = csv_of_push_log(log, "tip").unwrap_err();
            assert!(found.contains(fault), "{log}: {found}");
        }
    }
}
