//! Outlines of drawings against their closed forms, and what is named as not read. The drawings of
//! `examples/recordings` are all of one T: a bar of 120 x 30 mm, and one of 30 x 90 mm below it.

use std::f64::consts::PI;

use cohaul::model::geometry::{AreaMoments, area_moments};
use cohaul::scenario::Scenario;
use cohaul::scenario::format::ScenarioFile;
use cohaul_recordings::account::{Account, Kind};
use cohaul_recordings::drawings::{DrawingFormat, DrawingOptions, into_scenario};

use crate::root;

const FOLDER: &str = "examples/recordings";

fn like() -> ScenarioFile {
    let text = std::fs::read_to_string(root::root().join(FOLDER).join("ants.json")).unwrap();
    serde_json::from_str(&text).unwrap()
}

fn drawn(name: &str, text: &str, options: &DrawingOptions) -> Result<(Scenario, Account), String> {
    let format = DrawingFormat::of(name, text.as_bytes()).unwrap_or_else(|| panic!("{name} is a drawing"));
    let mut account = Account::default();
    let made = into_scenario(name, text.as_bytes(), format, options, (like(), None), &mut account);
    let made = made.and_then(|made| made.checked(name)).map_err(|error| error.to_string())?;
    Ok((made, account))
}

fn moments(scenario: &Scenario) -> AreaMoments {
    area_moments(&scenario.system.world.outline)
}

/// Area, and square of the radius of gyration about the centroid.
fn check(name: &str, scenario: &Scenario, area: f64, gyration: f64, tolerance: f64) {
    let found = moments(scenario);
    assert!((found.area / area - 1.0).abs() < tolerance, "{name}: {} of {area} m^2", found.area);
    let second = scenario.system.load.inertia / scenario.system.load.mass;
    assert!((second / gyration - 1.0).abs() < tolerance, "{name}: {second} of {gyration} m^2");
    assert!(found.centroid().norm() < 1e-9, "{name}: {}", found.centroid());
}

/// The T in every format, as it ships: area 63 cm^2, and the moment of inertia of two rectangles.
#[test]
fn the_t_is_the_same_in_every_format() {
    let gyration = 0.001_931_632_653;
    let pixels = DrawingOptions { scale: Some(1e-3), ..DrawingOptions::default() };
    for (name, options) in [
        ("t-block.svg", DrawingOptions::default()),
        ("t-block.dxf", DrawingOptions::default()),
        ("t-block.geojson", pixels),
        ("t-block.obj", pixels),
        ("t-block.xml", DrawingOptions::default()),
    ] {
        let text = std::fs::read_to_string(root::root().join(FOLDER).join(name)).unwrap_or_else(|error| panic!("{name}: {error}"));
        let (made, account) = drawn(name, &text, &options).unwrap_or_else(|error| panic!("{error}"));
        // SVG has single precision.
        check(name, &made, 0.0063, gyration, if name.ends_with("svg") { 1e-5 } else { 1e-8 });
        assert!(account.count(Kind::Read) > 0, "{}", account.text());
        // The bar is above the centroid, the other one below it: the y axis points up.
        let top = made.system.world.outline.parts.iter().flat_map(|part| match part {
            cohaul::model::OutlinePart::Polygon { corners } => corners.clone(),
            _ => Vec::new(),
        });
        let (low, high) = top.fold((0.0_f64, 0.0_f64), |(low, high), corner| (low.min(corner.y), high.max(corner.y)));
        assert!((high - 0.040_714_3).abs() < 1e-5 && (low + 0.079_285_7).abs() < 1e-5, "{name}: {low} to {high}");
    }
}

fn svg(body: &str) -> String {
    format!("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"100mm\" height=\"100mm\" viewBox=\"0 0 200 200\">{body}</svg>")
}

#[test]
fn svg_has_units_transforms_curves_and_holes() {
    let plain = DrawingOptions::default();
    // 100 units are 50 mm; half a turn and a shift change nothing about the centroid.
    let square = "<g transform=\"translate(20 10) rotate(30)\"><rect x=\"0\" y=\"0\" width=\"100\" height=\"40\"/></g>";
    let (made, _) = drawn("a.svg", &svg(square), &plain).unwrap();
    check("turned", &made, 0.05 * 0.02, (0.05_f64.powi(2) + 0.02_f64.powi(2)) / 12.0, 1e-5);
    let (made, account) = drawn("a.svg", &svg("<circle cx=\"100\" cy=\"100\" r=\"60\"/>"), &plain).unwrap();
    let bound = account.notes.iter().find(|note| note.kind == Kind::Flattened).and_then(|note| note.limit).unwrap();
    // A chord is off by at most the bound, and the area by the bound times the circumference.
    let area = PI * 0.03 * 0.03;
    assert!((moments(&made).area - area).abs() < bound * 2.0 * PI * 0.03 + 1e-9, "{}", moments(&made).area);
    let fine = DrawingOptions { tolerance: Some(1e-6), ..plain };
    let (made, _) = drawn("a.svg", &svg("<circle cx=\"100\" cy=\"100\" r=\"60\"/>"), &fine).unwrap();
    // usvg draws a circle by curves that are off by 3e-4 of its radius.
    check("circle", &made, area, 0.5 * 0.03 * 0.03, 6e-4);
    // A frame of 100 x 100 with a hole of 60 x 60, as one path and as two lines.
    let frame = "<path fill-rule=\"evenodd\" d=\"M0 0H100V100H0ZM20 20V80H80V20Z\"/>";
    let lines =
        "<g fill=\"none\" stroke=\"black\"><rect width=\"100\" height=\"100\"/><rect x=\"20\" y=\"20\" width=\"60\" height=\"60\"/></g>";
    let gyration = (0.05_f64.powi(4) - 0.03_f64.powi(4)) / 6.0 / (0.05 * 0.05 - 0.03 * 0.03);
    for body in [frame, lines] {
        let (made, account) = drawn("a.svg", &svg(body), &plain).unwrap();
        check(body, &made, 0.05 * 0.05 - 0.03 * 0.03, gyration, 1e-5);
        assert_eq!(account.count(Kind::Holes), 1, "{}", account.text());
    }
    let with_text = "<rect width=\"10\" height=\"10\"/><text>load</text><path d=\"M0 0L9 9\" stroke=\"red\" fill=\"none\"/>";
    let (_, account) = drawn("a.svg", &svg(with_text), &plain).unwrap();
    assert_eq!(account.count(Kind::LeftOut), 2, "{}", account.text());
    for (text, why) in [
        (svg(""), "must have from 1 to 100000 closed shapes, found 0"),
        (svg("<rect width=\"10\" height=\"10\"/>").replace("100mm", "100"), "must state the unit of lengths, or need --scale-m"),
        ("<svg".to_owned(), "must be XML"),
    ] {
        let error = drawn("a.svg", &text, &plain).unwrap_err();
        assert!(error.contains(why), "{error}");
    }
}

/// Group codes and values, a line each.
fn dxf(entities: &str) -> String {
    let header = "0 SECTION 2 HEADER 9 $INSUNITS 70 4 0 ENDSEC 0 SECTION 2 ENTITIES";
    format!("{header} {entities} 0 ENDSEC 0 EOF").replace(' ', "\n") + "\n"
}

#[test]
fn dxf_has_bulges_chains_and_circles() {
    let plain = DrawingOptions { tolerance: Some(1e-7), ..DrawingOptions::default() };
    // A stadium: two half circles of radius 10 mm, 40 mm apart.
    let stadium = "0 LWPOLYLINE 90 4 70 1 10 0 20 0 10 40 20 0 42 1 10 40 20 20 10 0 20 20 42 1";
    let chain = "0 LINE 10 0 20 0 11 40 21 0 0 ARC 10 40 20 10 40 10 50 270 51 90 0 LINE 10 0 20 20 11 40 21 20 \
                 0 ARC 10 0 20 10 40 10 50 90 51 270";
    for text in [stadium, chain] {
        let (made, account) = drawn("a.dxf", &dxf(text), &plain).unwrap_or_else(|error| panic!("{error}"));
        let area = 0.04 * 0.02 + PI * 1e-4;
        assert!((moments(&made).area / area - 1.0).abs() < 1e-4, "{}: {}", moments(&made).area, account.text());
        assert_eq!(account.count(Kind::Flattened), 2);
    }
    let (made, _) = drawn("a.dxf", &dxf("0 CIRCLE 10 5 20 6 40 12.2"), &plain).unwrap();
    assert!((made.system.load.radius - 0.0122).abs() < 1e-15, "a circle stays a disc");
    let (_, account) = drawn("a.dxf", &dxf("0 CIRCLE 10 5 20 6 40 12 0 SPLINE 70 8 0 INSERT 2 X"), &plain).unwrap();
    assert_eq!(account.count(Kind::LeftOut), 2, "{}", account.text());
    for (text, why) in [
        (dxf("0 CIRCLE 10 5 20 6"), "line 16: must have the group code 40, found CIRCLE"),
        (dxf("0 CIRCLE 10 5 20 six 40 1"), "must be a number of at most 1e50 for group code 20, found six"),
        ("0\nSECTION\nx\n".to_owned(), "line 3: must be a group code"),
    ] {
        let error = drawn("a.dxf", &text, &plain).unwrap_err();
        assert!(error.contains(why), "{error}");
    }
}

#[test]
fn models_and_maps_name_what_they_leave_out() {
    let plain = DrawingOptions::default();
    let model = |geoms: &str| format!("<mujoco><worldbody><body name=\"load\"><freejoint/>{geoms}</body></worldbody></mujoco>");
    let (made, _) = drawn("a.xml", &model("<geom type=\"cylinder\" size=\"0.05 0.01\" pos=\"1 2 0\"/>"), &plain).unwrap();
    check("cylinder", &made, PI * 0.0025, 0.5 * 0.0025, 1e-12);
    let capsule = "<geom type=\"capsule\" fromto=\"0 0 0 0.04 0 0\" size=\"0.01\"/>";
    let (made, _) = drawn("a.xml", &model(capsule), &DrawingOptions { tolerance: Some(1e-7), ..plain }).unwrap();
    assert!((moments(&made).area / (0.04 * 0.02 + PI * 1e-4) - 1.0).abs() < 1e-3, "{}", moments(&made).area);
    let turned = "<geom type=\"box\" size=\"0.1 0.05 0.01\" euler=\"0 0 30\"/><geom name=\"hull\" type=\"mesh\" mesh=\"m\"/>";
    let (made, account) = drawn("a.xml", &model(turned), &plain).unwrap();
    check("box", &made, 0.02, (0.04 + 0.01) / 12.0, 1e-9);
    assert!(account.text().contains("hull of type mesh"), "{}", account.text());
    let hole = "{\"type\":\"Polygon\",\"coordinates\":[[[0,0],[4,0],[4,4],[0,4],[0,0]],[[1,1],[1,3],[3,3],[3,1],[1,1]]]}";
    let (made, account) = drawn("a.geojson", hole, &DrawingOptions { scale: Some(0.01), ..plain }).unwrap();
    check("hole", &made, 12e-4, (256.0 - 16.0) / 6.0 / 12.0 * 1e-4, 1e-9);
    assert_eq!((account.count(Kind::Holes), account.count(Kind::Repeated)), (1, 2));
    for (name, text, why) in [
        (
            "a.xml",
            model("<geom type=\"box\" size=\"0.1 0.05 0.01\" euler=\"30 0 0\"/>"),
            "line 1, geom: must be turned about the z axis only",
        ),
        ("a.xml", "<mujoco><worldbody/></mujoco>".to_owned(), "must have one body with geoms"),
        (
            "a.geojson",
            "{\"type\":\"Polygon\",\"coordinates\":[[[0,0],[4,0]]]}".to_owned(),
            "coordinates[0]: must have at least four positions",
        ),
        ("a.obj", "v 0 0 0\nv 1 0\nf 1 2 3\n".to_owned(), "line 2: must be v and three numbers, found v 1 0"),
    ] {
        let error = drawn(name, &text, &plain).unwrap_err();
        assert!(error.contains(why), "{error}");
    }
}
