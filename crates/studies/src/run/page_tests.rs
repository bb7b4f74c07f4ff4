//! Pages as a whole: hostile names, nothing from elsewhere, sizes, and what a replay keeps of its
//! traces.

use serde_json::Value;

use crate::run::page::run_page;
use crate::run::summary::RunSummary;
use cohaul::backend::BackendKind;
use cohaul::scenario::Scenario;
use cohaul::simulation::Trace;
use cohaul::simulation::run_facts::Run;
use cohaul_report::chart::Labelled;
use cohaul_report::page::packed::Packed;
use cohaul_report::page::*;
use cohaul_report::synthetic::{self, manifest};
use cohaul_report::table::Table;

const FOUR_ANTS: &str = include_str!("../../../../scenarios/paper/four-ants-four-springs.json");
const HOSTILE: &str = "</script><b onload=x()>\"' &amp; <!--";

fn four_ants() -> Scenario {
    Scenario::parse(FOUR_ANTS, "four ants").unwrap()
}

fn page_of(scenario: &Scenario, trace: &Trace) -> String {
    let (options, outcome) = (synthetic::options(BackendKind::Rapier), synthetic::outcome(Some(true)));
    let run = Run { scenario, options: &options, outcome: &outcome, path_length: None, wall_time: Some(0.1) };
    run_page(&RunSummary { run, inertia_estimate: None }, trace, scenario, &manifest()).to_html()
}

fn replay_of(scenario: &Scenario, traces: &[&Trace]) -> Value {
    let shown: Vec<Labelled> = traces.iter().map(|trace| Labelled { label: "a run", trace }).collect();
    serde_json::to_value(Replay::new("a replay", scenario, &shown, 0.0).data).unwrap()
}

fn series(packed: &Value) -> (f64, Vec<Option<f64>>) {
    let packed = Packed {
        zero: packed["zero"].as_f64().unwrap(),
        step: packed["step"].as_f64().unwrap(),
        bits: packed["bits"].as_u64().unwrap() as u32,
        data: packed["data"].as_str().unwrap().to_owned(),
    };
    (packed.step, packed.unpacked())
}

#[test]
fn a_hostile_name_is_only_a_name() {
    let scenario = Scenario { name: HOSTILE.to_owned(), ..four_ants() };
    let (hostile, tame) = (page_of(&scenario, &synthetic::trace(50, 1.0)), page_of(&four_ants(), &synthetic::trace(50, 1.0)));
    assert!(hostile.contains("&lt;/script&gt;&lt;b onload=x()&gt;&quot;' &amp;amp; &lt;!--"));
    let count = |page: &str, what: &str| page.matches(what).count();
    for tag in ["<script", "</script", "<b>", "<b ", "<!--"] {
        assert_eq!(count(&hostile, tag), count(&tame, tag), "{tag}");
    }
    let table = Table::new(HOSTILE, [HOSTILE, HOSTILE]).row([HOSTILE, HOSTILE]);
    let blocks = vec![
        Block::text(HOSTILE),
        Block::List(vec![HOSTILE.to_owned()]),
        Block::Numbers(vec![Number::new(HOSTILE, HOSTILE, HOSTILE)]),
        Block::Table(table),
        Block::figure("<svg></svg>", HOSTILE),
        Block::Folded { heading: HOSTILE.to_owned(), blocks: vec![Block::Code(HOSTILE.to_owned())] },
        Block::Replay(Box::new(Replay::new(HOSTILE, &scenario, &[Labelled { label: HOSTILE, trace: &synthetic::trace(5, 1.0) }], 0.0))),
    ];
    let page = Page::new(HOSTILE, Headline::new(Answer::No, HOSTILE)).section(HOSTILE, blocks).to_html();
    assert!(!page.contains("<b onload") && !page.contains("<!--"));
    // The replay's data and the script itself.
    assert_eq!((count(&page, "<script"), count(&page, "</script")), (2, 2));
}

#[test]
fn a_page_names_nothing_elsewhere() {
    let page = page_of(&four_ants(), &synthetic::trace(500, 1.0)).replace("xmlns=\"http://www.w3.org/2000/svg\"", "");
    for way_out in
        ["http:", "https:", "src=", "@import", "<link rel=\"stylesheet", "<iframe", "fetch(", "XMLHttpRequest", "WebSocket", "eval("]
    {
        assert!(!page.contains(way_out), "{way_out}");
    }
    let targets = |before: &str| page.split(before).skip(1).map(|rest| rest.chars().next().unwrap()).collect::<Vec<_>>();
    assert!(targets("url(").iter().all(|first| *first == '#'), "drawings refer to themselves only");
    assert!(page.contains("default-src 'none'; script-src 'sha256-"));
}

/// Twelve hundred rows are kept whole: what differs is quantisation, half a step of each series.
#[test]
fn a_replay_holds_the_poses_tips_and_pulls_of_its_trace() {
    let trace = synthetic::trace(1200, 1.0);
    let data = replay_of(&four_ants(), &[&trace]);
    let run = &data["runs"][0];
    let pose = |row: &cohaul::simulation::Row| [row.time, row.motion.pose.position.x, row.motion.pose.position.y, row.motion.pose.heading];
    for (at, name) in ["times", "x", "y", "heading"].into_iter().enumerate() {
        let (step, values) = series(&run[name]);
        assert_eq!(values.len(), 1200);
        // Of a range of order one or 100 s: far below what the eye or a reader sees.
        assert!(step < 1e-7, "{name}: {step}");
        for (row, value) in trace.rows.iter().zip(values) {
            assert!((pose(row)[at] - value.unwrap()).abs() <= 0.5 * step + 1e-14, "{name}");
        }
    }
    for spring in 0..4 {
        let (step, pulls) = series(&run["pulls"][spring]);
        let (tip_step, tips) = series(&data["stages"][0]["tips"][spring][1]);
        // A range of 25 mN, or of 0.3 m, in 16 bits.
        assert!(step < 1e-6 && tip_step < 1e-5, "{step} {tip_step}");
        for (row, (pull, y)) in trace.rows.iter().zip(pulls.into_iter().zip(tips)) {
            let held = row.tips.iter().find(|tip| tip.spring == spring);
            assert_eq!((pull.is_some(), y.is_some()), (held.is_some(), held.is_some()));
            if let Some(tip) = held {
                assert!((tip.pull.norm() - pull.unwrap()).abs() <= 0.5 * step + 1e-14);
                assert!((tip.position.y - y.unwrap()).abs() <= 0.5 * tip_step + 1e-14);
            }
        }
    }
    assert_eq!(data["stages"][0]["events"].as_array().unwrap().len(), trace.events.len());
}

#[test]
fn runs_at_the_same_tips_share_them_and_others_have_their_own() {
    let (scenario, trace) = (four_ants(), synthetic::trace(300, 1.0));
    let (moved, longer) = (synthetic::trace(300, 1.001), synthetic::trace(301, 1.0));
    let moved = Trace { events: trace.events.clone(), ..moved };
    assert_eq!(replay_of(&scenario, &[&trace, &moved])["stages"].as_array().unwrap().len(), 1);
    assert_eq!(replay_of(&scenario, &[&trace, &longer])["stages"].as_array().unwrap().len(), 2);
}

#[test]
fn empty_short_and_broken_traces_make_a_page_without_broken_numbers() {
    let mut broken = synthetic::trace(40, 1.0);
    broken.rows[7].motion.pose.position.x = f64::NAN;
    broken.rows[9].motion.twist.angular = f64::INFINITY;
    for trace in [Trace::default(), synthetic::trace(1, 1.0), broken] {
        let data = replay_of(&four_ants(), &[&trace, &trace]).to_string();
        // JSON has neither NaN nor infinity: serde_json would make them null.
        assert!(!data.contains(":null") && !data.contains("[null") && !data.contains("NaN") && !data.contains("inf"), "{data:.2000}");
        assert_eq!(series(&replay_of(&four_ants(), &[&trace])["runs"][0]["x"]).1.len(), trace.rows.len());
    }
    let nothing: Value = replay_of(&four_ants(), &[]);
    assert_eq!(nothing["runs"].as_array().unwrap().len(), 0);
}

/// What the paper's scene takes with three backends, and a load with a thousand springs.
#[test]
fn a_page_stays_small() {
    let traces = [1.0, 1.001, 0.999].map(|lag| synthetic::trace(28_000, lag));
    let size = |scenario: &Scenario| replay_of(scenario, &traces.each_ref()).to_string().len();
    assert!(size(&four_ants()) < 1_000_000, "{}", size(&four_ants()));
    let mut many = four_ants();
    many.system.springs = many.system.springs.iter().cycle().take(1000).copied().collect();
    let crowd = size(&many);
    assert!(crowd < 1_800_000, "{crowd}");
    let replay = Replay::new("many", &many, &[Labelled { label: "a run", trace: &traces[0] }], 0.0);
    assert!(replay.caption.iter().any(|note| note == "200 of 1000 springs are drawn."), "{:?}", replay.caption);
}
