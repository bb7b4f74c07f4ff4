//! What the columns of a header mean, in any order and with the names that people use.

use super::points::{AngleUnit, LengthUnit};

/// Columns of one thing's place, by index.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlaceColumns {
    /// Name of the point, as `nose` in `nose.x`; empty where the columns are plainly `x` and `y`.
    pub name: String,
    pub x: Option<usize>,
    pub y: Option<usize>,
    pub heading: Option<usize>,
    pub confidence: Option<usize>,
    pub length: LengthUnit,
    pub angle: AngleUnit,
}

/// What the columns of a table mean, by index.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Columns {
    /// Column of times, with the length of its unit (s).
    pub time: Option<(usize, f64)>,
    pub frame: Option<usize>,
    /// Column of the names of things.
    pub id: Option<usize>,
    pub event: Option<usize>,
    /// Column that is 1 where the thing was not seen.
    pub missing: Option<usize>,
    pub places: Vec<PlaceColumns>,
    /// Columns without a meaning here.
    pub left_out: Vec<usize>,
}

/// A quantity that a column may hold.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Quantity {
    X,
    Y,
    Heading,
    Confidence,
}

const TIMES: [&str; 6] = ["time", "t", "seconds", "sec", "secs", "timestamp"];
const FRAMES: [&str; 5] = ["frame", "frames", "framenumber", "imagenumber", "frameid"];
const FRAME_TAILS: [&str; 6] = ["idx", "index", "number", "nr", "no", "id"];
const IDS: [&str; 18] = [
    "spring",
    "id",
    "track",
    "trackid",
    "tracks",
    "individual",
    "ant",
    "robot",
    "animal",
    "name",
    "particle",
    "identity",
    "object",
    "fish",
    "bee",
    "trajectory",
    "label",
    "agent",
];
const HEADINGS: [&str; 6] = ["heading", "theta", "angle", "orientation", "yaw", "bearing"];
const CONFIDENCES: [&str; 6] = ["likelihood", "confidence", "score", "probability", "prob", "conf"];
/// Words about a place that name nothing.
const FILLERS: [&str; 8] = ["pos", "position", "coord", "coordinate", "loc", "location", "image", "coords"];

/// A column's name as words, without its unit, which is the last one.
fn words(name: &str) -> (Vec<String>, Option<String>) {
    let is_joint = |letter: char| letter.is_whitespace() || "()[]#.-_/:%".contains(letter);
    let mut words: Vec<String> = name.split(is_joint).filter(|word| !word.is_empty()).map(str::to_owned).collect();
    const UNITS: [&str; 17] =
        ["m", "mm", "cm", "um", "µm", "px", "pixel", "pixels", "s", "ms", "sec", "seconds", "rad", "radians", "deg", "degrees", "metres"];
    let is_unit = words.len() > 1 && words.last().is_some_and(|word| UNITS.contains(&word.to_lowercase().as_str()));
    let unit = if is_unit { words.pop().map(|unit| unit.to_lowercase()) } else { None };
    (words, unit)
}

fn length_of(unit: Option<&str>) -> LengthUnit {
    match unit {
        Some("m" | "metres") => LengthUnit::Metres(1.0),
        Some("mm") => LengthUnit::Metres(1e-3),
        Some("cm") => LengthUnit::Metres(1e-2),
        Some("um" | "µm") => LengthUnit::Metres(1e-6),
        Some("px" | "pixel" | "pixels") => LengthUnit::Pixels,
        _ => LengthUnit::Unknown,
    }
}

fn angle_of(unit: Option<&str>) -> AngleUnit {
    match unit {
        Some("rad" | "radians") => AngleUnit::Radians,
        Some("deg" | "degrees") => AngleUnit::Degrees,
        _ => AngleUnit::Unknown,
    }
}

/// The quantity that a word stands for, and what else the word says, as `1` in `x1`.
fn quantity(word: &str) -> Option<(Quantity, &str)> {
    let lower = word.to_lowercase();
    for (letter, quantity) in [("x", Quantity::X), ("y", Quantity::Y)] {
        match lower.strip_prefix(letter) {
            Some("") => return Some((quantity, "")),
            Some(rest) if rest.bytes().all(|byte| byte.is_ascii_digit()) => return Some((quantity, &word[1..])),
            _ => {}
        }
    }
    if HEADINGS.contains(&lower.as_str()) {
        return Some((Quantity::Heading, ""));
    }
    CONFIDENCES.contains(&lower.as_str()).then_some((Quantity::Confidence, ""))
}

impl Columns {
    /// What the columns with these names mean.
    ///
    /// # Errors
    /// When two columns have the same meaning: their indices.
    pub fn of(names: &[&str]) -> Result<Self, [usize; 2]> {
        let mut columns = Self::default();
        for (at, name) in names.iter().enumerate() {
            let (words, unit) = words(name);
            let lower: Vec<String> = words.iter().map(|word| word.to_lowercase()).collect();
            let lower: Vec<&str> = lower.iter().map(String::as_str).collect();
            match lower[..] {
                [word] if TIMES.contains(&word) => {
                    let length = if unit.as_deref() == Some("ms") { 1e-3 } else { 1.0 };
                    set(&mut columns.time, (at, length), |(at, _)| *at)?;
                }
                [word] if FRAMES.contains(&word) => set(&mut columns.frame, at, |at| *at)?,
                [word, tail] if FRAMES.contains(&word) && FRAME_TAILS.contains(&tail) => set(&mut columns.frame, at, |at| *at)?,
                [word] if IDS.contains(&word) => set(&mut columns.id, at, |at| *at)?,
                [word, "id" | "name"] if IDS.contains(&word) => set(&mut columns.id, at, |at| *at)?,
                ["event"] => set(&mut columns.event, at, |at| *at)?,
                ["missing"] => set(&mut columns.missing, at, |at| *at)?,
                _ => columns.add_place(at, &words, unit.as_deref())?,
            }
        }
        columns.settle();
        Ok(columns)
    }

    fn add_place(&mut self, at: usize, words: &[String], unit: Option<&str>) -> Result<(), [usize; 2]> {
        let mut found = words.iter().enumerate().filter_map(|(index, word)| quantity(word).map(|found| (index, found)));
        // The last one counts, as in `angle.x` of a node with that name.
        let Some((index, (quantity, rest))) = found.next_back() else {
            self.left_out.push(at);
            return Ok(());
        };
        let others = words.iter().enumerate().filter(|(other, _)| *other != index).map(|(_, word)| word.as_str());
        let name = others.chain([rest]).filter(|word| !word.is_empty() && !FILLERS.contains(&word.to_lowercase().as_str()));
        let name = name.collect::<Vec<_>>().join("_");
        let place = match self.places.iter().position(|place| place.name == name) {
            Some(known) => &mut self.places[known],
            None => {
                self.places.push(PlaceColumns { name, ..PlaceColumns::default() });
                self.places.last_mut().expect("it was added")
            }
        };
        match quantity {
            Quantity::X => set(&mut place.x, at, |at| *at)?,
            Quantity::Y => set(&mut place.y, at, |at| *at)?,
            Quantity::Heading => set(&mut place.heading, at, |at| *at)?,
            Quantity::Confidence => set(&mut place.confidence, at, |at| *at)?,
        }
        match quantity {
            Quantity::X => place.length = length_of(unit),
            Quantity::Heading => place.angle = angle_of(unit),
            _ => {}
        }
        Ok(())
    }

    /// Gives plain headings and confidences to the places that have none of their own, and leaves
    /// out what is no place.
    fn settle(&mut self) {
        let (whole, parts): (Vec<_>, Vec<_>) = self.places.drain(..).partition(|place| place.x.is_some() && place.y.is_some());
        self.places = whole;
        for part in parts {
            let mut is_used = false;
            if part.name.is_empty() && part.x.is_none() && part.y.is_none() {
                for place in &mut self.places {
                    let takes_heading = part.heading.is_some() && place.heading.is_none();
                    if takes_heading {
                        (place.heading, place.angle) = (part.heading, part.angle);
                    }
                    let takes_confidence = part.confidence.is_some() && place.confidence.is_none();
                    if takes_confidence {
                        place.confidence = part.confidence;
                    }
                    is_used |= takes_heading || takes_confidence;
                }
            }
            if !is_used {
                self.left_out.extend([part.x, part.y, part.heading, part.confidence].into_iter().flatten());
            }
        }
        self.left_out.sort_unstable();
    }

    /// Keeps the first place of these names that is there, and leaves out the others.
    pub fn prefer(&mut self, names: &[&str]) {
        let found = names.iter().find_map(|name| self.places.iter().position(|place| place.name.eq_ignore_ascii_case(name)));
        let Some(found) = found else { return };
        let mut kept = self.places.swap_remove(found);
        for other in self.places.drain(..) {
            self.left_out.extend([other.x, other.y].into_iter().flatten());
            if kept.heading.is_none() {
                (kept.heading, kept.angle) = (other.heading, other.angle);
            }
        }
        kept.name = String::new();
        self.places = vec![kept];
        self.left_out.sort_unstable();
    }
}

/// Sets a meaning once.
fn set<T>(place: &mut Option<T>, value: T, index: impl Fn(&T) -> usize) -> Result<(), [usize; 2]> {
    match place {
        Some(before) => Err([index(before), index(&value)]),
        None => {
            *place = Some(value);
            Ok(())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn places(header: &str) -> Vec<(String, Option<usize>, Option<usize>, LengthUnit)> {
        let names: Vec<&str> = header.split(',').collect();
        Columns::of(&names).unwrap().places.into_iter().map(|place| (place.name, place.x, place.y, place.length)).collect()
    }

    #[test]
    fn names_and_units_are_those_that_people_use() {
        let (metres, pixels, unknown) = (LengthUnit::Metres(1.0), LengthUnit::Pixels, LengthUnit::Unknown);
        for (header, name, x, y, length) in [
            ("time_s,x_m,y_m", "", 1, 2, metres),
            ("frame,pos_x,pos_y,id", "", 1, 2, unknown),
            ("Y [px],X [px],Frame Number", "", 1, 0, pixels),
            ("time,x1,y1", "1", 1, 2, unknown),
            ("track,frame_idx,instance.score,nose.x,nose.y,nose.score", "nose", 3, 4, unknown),
            ("frame,X#wcentroid (cm),Y#wcentroid (cm)", "wcentroid", 1, 2, LengthUnit::Metres(1e-2)),
        ] {
            assert_eq!(places(header), [(name.to_owned(), Some(x), Some(y), length)], "{header}");
        }
        assert_eq!(Columns::of(&["t", "x", "pos_x", "y"]), Err([1, 2]));
        let trace = Columns::of(&["time_s", "x_m", "y_m", "heading_rad", "vx_m_per_s", "likelihood"]).unwrap();
        let place = &trace.places[0];
        assert_eq!((place.heading, place.angle, place.confidence), (Some(3), AngleUnit::Radians, Some(5)));
        assert_eq!(trace.left_out, [4]);
    }
}
