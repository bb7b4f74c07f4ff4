//! Drawings as outlines of a scenario's load or of an obstacle.

use cohaul::math::{Pose, Vec2};
use cohaul::scenario::format::{OutlineEntry, ScenarioFile, SpringsEntry, SupportsEntry};
use cohaul::scenario::{Findings, ScenarioError, is_in_range};
use kurbo::Point;
use serde::{Deserialize, Serialize};

use super::outline::{Outlined, outline, size};
use super::part::{Found, Shape};
use super::{dxf, entry, geojson, mjcf, obj, svg};
use crate::account::{Account, Kind, Note, Place};

/// Kind of a drawing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum DrawingFormat {
    Svg,
    Dxf,
    #[serde(rename = "geojson")]
    GeoJson,
    Obj,
    Mjcf,
}

impl DrawingFormat {
    /// Name for people.
    pub fn title(self) -> &'static str {
        match self {
            Self::Svg => "SVG",
            Self::Dxf => "DXF",
            Self::GeoJson => "GeoJSON",
            Self::Obj => "OBJ",
            Self::Mjcf => "MJCF",
        }
    }

    /// The kind of a file, from its name and its beginning; `None` if it is no drawing.
    pub fn of(file: &str, bytes: &[u8]) -> Option<Self> {
        let name = file.to_lowercase();
        let text = String::from_utf8_lossy(&bytes[..bytes.len().min(4096)]).to_lowercase();
        let ends = |extensions: &[&str]| extensions.iter().any(|extension| name.ends_with(extension));
        match () {
            () if ends(&[".svg"]) || text.contains("<svg") => Some(Self::Svg),
            () if text.contains("<mujoco") => Some(Self::Mjcf),
            () if ends(&[".dxf"]) => Some(Self::Dxf),
            () if ends(&[".obj"]) => Some(Self::Obj),
            () if ends(&[".geojson"]) => Some(Self::GeoJson),
            () if text.trim_start().starts_with('{') && text.contains("\"coordinates\"") => Some(Self::GeoJson),
            () => None,
        }
    }
}

/// How a drawing is read.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DrawingOptions<'a> {
    /// Length of the unit of the file (m), where the file does not state it.
    pub scale: Option<f64>,
    /// Largest distance of straight lines from a curve (m). The default is 1/2000 of the size.
    pub tolerance: Option<f64>,
    /// Body of an MJCF model.
    pub body: Option<&'a str>,
    /// Whether the y axis of a mesh points up, and not the z axis.
    pub y_up: bool,
}

/// Tolerance of curves over the size of the drawing (1): a circle has 100 corners.
const TOLERANCE: f64 = 5e-4;

/// Smallest tolerance over the size of the drawing (1): more corners than an outline may have.
const SMALLEST_TOLERANCE: f64 = 1e-9;

/// The outline of a drawing, about its centroid.
///
/// # Errors
/// When the file breaks a rule of its format: each with its line or its path.
fn outlined(
    file: &str,
    bytes: &[u8],
    format: DrawingFormat,
    options: &DrawingOptions,
    account: &mut Account,
) -> Result<Outlined, ScenarioError> {
    let mut findings = Findings::default();
    let invalid = |findings: Findings| ScenarioError::Invalid { file: file.to_owned(), findings: findings.0 };
    let Ok(text) = std::str::from_utf8(bytes) else {
        findings.report("", "must be text in UTF-8", "other bytes");
        return Err(invalid(findings));
    };
    // Read twice where the tolerance is a length: the size is known after the first time.
    let mut found = read_as(text, format, options, TOLERANCE, &mut findings);
    let unit = options.scale.or(found.unit);
    if let (Some(tolerance), Some(unit)) = (options.tolerance, unit) {
        let share = tolerance / (unit * size(&found.parts));
        if share.is_finite() && findings.0.is_empty() {
            found = read_as(text, format, options, share.clamp(SMALLEST_TOLERANCE, 0.1), &mut findings);
        }
    }
    if unit.is_none() && findings.0.is_empty() {
        findings.report("units", "must state the unit of lengths, or need --scale-m, its metres", "no unit");
    }
    let (true, Some(unit)) = (findings.0.is_empty(), unit) else { return Err(invalid(findings)) };
    account.files.push(file.to_owned());
    account.source = format.title().to_owned();
    scaled(&mut found, unit);
    let size = size(&found.parts);
    let is_drawing = is_in_range(size) && size > 0.0;
    if !found.parts.is_empty() && !is_drawing {
        findings.report("drawing", "must have a size that is a positive number of metres of at most 1e50", size);
        return Err(invalid(findings));
    }
    let tolerance = options.tolerance.unwrap_or(TOLERANCE * size);
    notes(&found, unit, tolerance, account);
    match outline(&found.parts, tolerance, &mut findings, account) {
        Some(outlined) if findings.0.is_empty() => Ok(outlined),
        _ => Err(invalid(findings)),
    }
}

fn read_as(text: &str, format: DrawingFormat, options: &DrawingOptions, tolerance: f64, findings: &mut Findings) -> Found {
    match format {
        DrawingFormat::Svg => svg::read(text.as_bytes(), tolerance).unwrap_or_else(|fault| {
            let (rule, found) = fault.split_once(", found ").unwrap_or((&fault, "another text"));
            findings.report("", format!("must be {rule}"), found);
            Found::default()
        }),
        DrawingFormat::Dxf => dxf::read(text, tolerance, findings),
        DrawingFormat::Obj => obj::read(text, options.y_up, findings),
        DrawingFormat::Mjcf => mjcf::read(text, options.body, tolerance, findings),
        DrawingFormat::GeoJson => match serde_json::from_str(text) {
            Ok(value) => geojson::read(&value, findings),
            Err(error) => {
                findings.report(format_args!("line {} column {}", error.line(), error.column()), "must be JSON", error);
                Found::default()
            }
        },
    }
}

/// Brings all parts to metres, with the y axis up.
fn scaled(found: &mut Found, unit: f64) {
    let y = if found.y_down { -unit } else { unit };
    let to_metres = |point: &mut Point| *point = Point::new(unit * point.x, y * point.y);
    for part in &mut found.parts {
        match &mut part.shape {
            Shape::Disc { centre, radius } => {
                to_metres(centre);
                *radius *= unit;
            }
            Shape::Rings { rings, .. } => rings.iter_mut().flatten().for_each(to_metres),
        }
    }
}

fn notes(found: &Found, unit: f64, tolerance: f64, account: &mut Account) {
    account.add(Note::new(Kind::Read, found.parts.len(), "closed shapes"));
    if unit != 1.0 {
        account.add(Note::new(Kind::Units, found.parts.len(), format!("shapes in units of {unit} m")));
    }
    if found.y_down {
        account.add(Note::new(Kind::Units, found.parts.len(), "shapes of which the y axis was turned from down to up"));
    }
    let text = "curves replaced by straight lines";
    account.add(Note::new(Kind::Flattened, found.n_curves, text).sized(None, Some(tolerance), "m"));
    let places = found.left_out.iter().take(20).map(|name| Place { name: name.clone(), time_s: None }).collect();
    let note = Note::new(Kind::LeftOut, found.left_out.len(), "shapes that are not read").warning();
    account.add(Note { places, ..note });
}

/// The scenario `like` with the outline of a drawing in place of that of its load, or of the
/// obstacle of this name. The load's centroid is its origin; an obstacle keeps the origin of the
/// drawing.
///
/// # Errors
/// When the drawing breaks a rule, or the scenario has no such obstacle.
pub fn into_scenario(
    file: &str,
    bytes: &[u8],
    format: DrawingFormat,
    options: &DrawingOptions,
    (like, obstacle): (ScenarioFile, Option<&str>),
    account: &mut Account,
) -> Result<ScenarioFile, ScenarioError> {
    let Outlined { entry, .. } = outlined(file, bytes, format, options, account)?;
    let mut made = like;
    match obstacle {
        None => {
            (made.load.radius_m, made.load.outline) = (None, Some(entry));
            if made.load.inertia_kg_m2.take().is_some() {
                let text = "moment of inertia, now that of the mass spread over the drawn outline";
                account.add(Note::new(Kind::Moved, 1, text));
            }
        }
        Some(name) => {
            let known = made.obstacles.iter().map(|obstacle| obstacle.name.as_str()).collect::<Vec<_>>().join(", ");
            let Some(found) = made.obstacles.iter_mut().find(|obstacle| obstacle.name == name) else {
                let mut findings = Findings::default();
                findings.report("--onto", format!("must name an obstacle of the scenario, {known}"), name);
                return Err(ScenarioError::Invalid { file: file.to_owned(), findings: findings.0 });
            };
            found.outline = entry;
        }
    }
    Ok(made)
}

/// A scenario whose load has an outline that breaks a rule, put right: corners that stand twice are
/// left out, overlapping parts are joined, and the origin is moved to the centroid. Springs,
/// supports and the start keep their places in the world.
///
/// # Errors
/// When the outline encloses no area.
pub fn repaired(file: &str, scenario: ScenarioFile, account: &mut Account) -> Result<ScenarioFile, ScenarioError> {
    let mut made = scenario;
    account.files.push(file.to_owned());
    account.source = "outline of a scenario".to_owned();
    let Some(old) = made.load.outline.clone() else { return Ok(made) };
    let mut found = Found { unit: Some(1.0), ..Found::default() };
    entry::add(&old, &Pose::new(0.0, 0.0, 0.0), &mut found);
    let mut findings = Findings::default();
    let size = size(&found.parts);
    if !(is_in_range(size) && size > 0.0) {
        // The rules of scenarios name what is wrong.
        return Ok(made);
    }
    notes(&found, 1.0, TOLERANCE * size, account);
    let Some(Outlined { entry, centroid, .. }) = outline(&found.parts, TOLERANCE * size, &mut findings, account) else {
        return Err(ScenarioError::Invalid { file: file.to_owned(), findings: findings.0 });
    };
    let is_same = matches!((&old, &entry), (OutlineEntry::Disc(_), OutlineEntry::Disc(_)));
    made.load.outline = Some(if is_same { old } else { entry });
    let is_round = matches!(made.ground.supports, SupportsEntry::Tripod(_) | SupportsEntry::Ring(_))
        || made.springs.iter().any(|springs| matches!(springs, SpringsEntry::Ring(_)));
    if is_round && centroid.norm() > 0.0 {
        account.add(Note::new(Kind::Moved, 1, "short form of supports or springs, which now is about the new origin").warning());
    }
    move_origin(&mut made, centroid);
    Ok(made)
}

/// Moves the origin of the load's frame by `shift` (m, in that frame).
fn move_origin(made: &mut ScenarioFile, shift: Vec2) {
    let start = Pose { position: made.load.position_m.into(), heading: made.load.heading_rad };
    made.load.position_m = start.to_world(&shift).into();
    let moved = |[x, y]: [f64; 2]| [x - shift.x, y - shift.y];
    if let SupportsEntry::List(points) = &mut made.ground.supports {
        points.iter_mut().for_each(|support| support.offset_m = moved(support.offset_m));
    }
    for spring in &mut made.springs {
        if let SpringsEntry::One(spring) = spring {
            spring.root_m = moved(spring.root_m);
        }
    }
}
