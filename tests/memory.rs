//! A run that keeps nothing but its outcome needs no memory that grows with its length, and its
//! loop asks for none at all.

use std::alloc::{GlobalAlloc, Layout, System as Memory};
use std::cell::Cell;

use cohaul::analysis::estimate::with_estimate;
use cohaul::backend::{Backend, BackendKind, BackendOptions, EnergyLedger, Motion, StepReport};
use cohaul::math::{Pose, Twist, Vec2};
use cohaul::scenario::Scenario;
use cohaul::simulation::{Keep, Simulation, controller_of};

/// Counts what the present thread asks for: other tests do not disturb.
struct Counting;

thread_local! {
    static REQUESTS: Cell<u64> = const { Cell::new(0) };
    static BYTES: Cell<isize> = const { Cell::new(0) };
}

// SAFETY: the system's allocator does all the work; the counters are plain cells without
// destructors.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        REQUESTS.set(REQUESTS.get() + 1);
        BYTES.set(BYTES.get() + layout.size() as isize);
        unsafe { Memory.alloc(layout) }
    }

    unsafe fn dealloc(&self, memory: *mut u8, layout: Layout) {
        BYTES.set(BYTES.get() - layout.size() as isize);
        unsafe { Memory.dealloc(memory, layout) }
    }
}

#[global_allocator]
static COUNTING: Counting = Counting;

/// A load that never moves, on springs that pull by how far their tips are away from it. It asks
/// for no memory.
struct Nailed {
    tips: Vec<Option<Vec2>>,
}

impl Backend for Nailed {
    fn attach(&mut self, spring: usize, tip: Vec2) {
        self.tips[spring] = Some(tip);
    }

    fn release(&mut self, spring: usize) {
        self.tips[spring] = None;
    }

    fn advance(&mut self, tip_targets: &[Vec2], _: f64) -> StepReport {
        self.tips.iter_mut().zip(tip_targets).for_each(|(tip, target)| *tip = tip.map(|_| *target));
        StepReport { n_steps: 1, ..StepReport::default() }
    }

    fn motion(&self) -> Motion {
        Motion { pose: Pose::new(0.0, 0.0, 0.0), twist: Twist::ZERO }
    }

    fn tip(&self, spring: usize) -> Option<Vec2> {
        self.tips[spring]
    }

    fn pull(&self, spring: usize) -> Vec2 {
        self.tips[spring].map_or(Vec2::zeros(), |tip| 0.6 * tip)
    }

    fn energy(&self) -> EnergyLedger {
        EnergyLedger::default()
    }
}

fn ten_ants(duration: f64) -> Scenario {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/scenarios/paper/ten-ants-ten-springs.json");
    Scenario { duration, ..Scenario::read(file.as_ref()).unwrap() }
}

/// Runs to the end: requests for memory and bytes held more in the second half than in the first.
fn second_half(mut run: Simulation, duration: f64) -> (u64, isize, Simulation) {
    run.run(|time| time < 0.5 * duration);
    let (requests, bytes) = (REQUESTS.get(), BYTES.get());
    run.run(|_| true);
    (REQUESTS.get() - requests, BYTES.get() - bytes, run)
}

#[test]
fn the_loop_asks_for_no_memory_once_it_runs() {
    let scenario = ten_ants(40.0);
    let options = BackendOptions::new(BackendKind::QuasiStatic, scenario.control_period);
    let of = |keep| {
        let backend = Box::new(Nailed { tips: vec![None; scenario.system.springs.len()] });
        second_half(Simulation::from_parts(&scenario, &options, keep, controller_of(&scenario), backend), scenario.duration)
    };
    let (requests, bytes, run) = of(Keep::Outcome);
    assert!(run.outcome().pulls.n() > 500 && run.trace().rows.is_empty() && run.trace().events.is_empty());
    assert_eq!((requests, bytes), (0, 0));
    // The counters count: the same run with its trace holds a row more at every tick, of at least
    // 100 bytes.
    let (_, bytes, run) = of(Keep::Trace);
    assert!(bytes > 50 * run.trace().rows.len() as isize, "{bytes} bytes");
}

/// Nor does a real load, or what follows it to estimate inertia, hold more memory the longer it
/// runs.
#[test]
fn no_memory_is_held_for_what_is_over() {
    let scenario = ten_ants(6.0);
    let options = BackendOptions::new(BackendKind::QuasiStatic, scenario.control_period);
    let (watched, _estimator) = with_estimate(&scenario.system, scenario.start, &options);
    let (_, bytes, run) =
        second_half(Simulation::from_parts(&scenario, &options, Keep::Outcome, controller_of(&scenario), watched), scenario.duration);
    assert_eq!((run.outcome().time, run.outcome().arrived), (6.0, Some(false)));
    // Lists of what happens in one step may reach their longest late. A trace of this half would be
    // 400 kB.
    assert!(bytes < 4096, "{bytes} bytes");
}
