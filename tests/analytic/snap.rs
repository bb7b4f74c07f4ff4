//! A load on one spring whose tip swings so far round the root that the spring's energy is no
//! longer convex: when it slips, it snaps.
//!
//! The supports stand so far out that the load shifts only. At twice its rest length the spring
//! pulls with f_r = k_r l_0 along itself and f_t = k_t psi / l across. Along that pull n the
//! stiffness n' H n = k_r n_r^2 + (k_r / 2 + k_t / l^2) n_t^2 - 2 (k_t psi / l^2) n_r n_t is
//! negative from swings of 4.01 rad on: a load that starts to slip there is pulled the more the
//! further it goes, until the spring is shorter.

use cohaul::backend::{Backend, BackendKind, BackendOptions, Status, Tolerance, TransitionKind, build};
use cohaul::math::{Vec2, direction};
use cohaul::model::{PolarSpring, System};

use crate::common::*;

/// Swing at which the load slips (rad).
const SNAP: f64 = 4.5;
/// Angle that the tip sweeps (rad), at one radian a second.
const SWEPT: f64 = 4.8;
const LENGTH: f64 = 2.0 * REST_LENGTH;

fn slip_limit(swing: f64) -> f64 {
    (RADIAL * REST_LENGTH).hypot(TORSIONAL * swing / LENGTH)
}

fn system(limit: f64) -> System {
    let mut system = paper_system(vec![PolarSpring { root: Vec2::zeros(), ..paper_springs(1)[0] }]);
    system.ground.supports = tripod(100.0, limit / MU);
    system
}

/// A jump that was logged.
#[derive(Clone, Copy, Debug)]
struct Snap {
    /// (s)
    time: f64,
    /// (m)
    shift: f64,
    /// (J)
    energy: f64,
    /// Elastic, at the end of its step (J).
    elastic: f64,
}

/// The jumps while the tip goes round in `n` pieces, and the energy that the ledger has for them
/// (J).
fn snaps(system: &System, options: &BackendOptions, n: u32) -> (Vec<Snap>, f64) {
    let mut run = build(system, at_rest(), options);
    let mut jumps = Vec::new();
    let piece = SWEPT / f64::from(n);
    let look = |time: f64, run: &mut dyn Backend| {
        for transition in run.transitions() {
            if let TransitionKind::Jump { shift, energy, turn, .. } = transition.kind {
                // A shift of all supports 100 m out.
                assert!(turn.abs() < 1e-5, "{turn}");
                jumps.push(Snap { time: time - piece + transition.time, shift, energy, elastic: run.energy().elastic });
            }
        }
    };
    drive(run.as_mut(), |t| vec![(0, LENGTH * direction(t))], SWEPT, n, look);
    (jumps, run.energy().jumps)
}

#[test]
fn a_snap_is_logged_with_its_time_and_size_at_any_step() {
    let limit = slip_limit(SNAP);
    let fixed = BackendOptions::new(BackendKind::QuasiStatic, 1.0);
    let before = 0.5 * RADIAL * REST_LENGTH.powi(2) + 0.5 * TORSIONAL * SNAP * SNAP;
    let found = [(&fixed, 2_400), (&fixed, 9_600)].map(|(options, n)| {
        let (jumps, booked) = snaps(&system(limit), options, n);
        assert_eq!(jumps.len(), 1, "{n}: {jumps:?}");
        let Snap { time, shift, energy, elastic } = jumps[0];
        // Fixed steps name their end; chords of the tip's circle pull less by their sag, 1e-6 of
        // the length.
        assert!(time - SNAP > -1e-5 && time - SNAP < 1.01 * SWEPT / f64::from(n), "{n}: {time}");
        // What the spring gave less what friction took on the way, which is a little longer than
        // the shift: it bends once.
        let most = before - elastic - limit * shift;
        assert!(energy < most && energy > 0.8 * most, "{n}: {energy} {most}");
        assert_eq!(booked, energy);
        jumps[0]
    });
    for other in &found[1..] {
        // At the coarser step the tip is up to a step, 0.1 mm, further on: 2e-3 of the way.
        assert!((other.shift / found[0].shift - 1.0).abs() < 0.01, "{found:?}");
        assert!((other.energy / found[0].energy - 1.0).abs() < 0.02, "{found:?}");
    }
}

/// A little friction less, and the load slips while the energy along its way is still convex: it
/// creeps after the tip.
#[test]
fn a_load_that_slips_earlier_does_not_snap() {
    for swing in [1.0, 2.0] {
        for n in [48, 480, 4_800] {
            let (jumps, _) = snaps(&system(slip_limit(swing)), &BackendOptions::new(BackendKind::QuasiStatic, 1.0), n);
            assert!(jumps.is_empty(), "{swing} {n}: {jumps:?}");
        }
    }
}

/// Steps of second order follow the balance as far as it goes, and snap from there as the plain
/// ones do: up to the way of the tip in a step, 26 um.
#[test]
fn a_snap_is_the_same_in_second_order() {
    let [plain, second] = [false, true].map(|second_order| {
        let options = BackendOptions { second_order, ..BackendOptions::new(BackendKind::QuasiStatic, 1.0) };
        snaps(&system(slip_limit(SNAP)), &options, 9_600).0
    });
    assert_eq!((plain.len(), second.len()), (1, 1), "{plain:?} {second:?}");
    let step = SWEPT / 9_600.0;
    assert!((plain[0].time - second[0].time).abs() < 1.01 * step, "{plain:?} {second:?}");
    assert!((plain[0].shift - second[0].shift).abs() < 2.0 * LENGTH * step, "{plain:?} {second:?}");
}

/// A tip that is pushed across the load from where its spring is rooted turns it over as soon as it
/// slips. How far past that the first step ends is the error control's to find, down to 1e-9 of the
/// way, where the load sets off with next to no force: as far as the descent is followed, it leads
/// to one place.
///
/// Known answer of a program that shares no code with this one: the instant at which no friction
/// balances the pull any more, by the moments about all points, and where the gradient flow of
/// energy and friction leads from rest then, in three legs. Damped dynamics end elsewhere: dashpots
/// in proportion to the spring take the load 6.82 mm, viscous supports 6.77 mm. The jump says so.
#[test]
fn a_load_that_sets_off_with_next_to_no_force_turns_over_to_its_balance() {
    const ONSET: f64 = 0.559_866_67;
    const SHIFT: f64 = 5.1271e-3;
    const TURN: f64 = 1.5787;
    const ENERGY: f64 = 2.7538e-5;
    let mut system = paper_system(vec![isotropic(LOAD_RADIUS * Vec2::x(), 0.0)]);
    system.ground.supports = tripod(0.005, SLIP_LIMIT / MU);
    let tip = |t: f64| vec![(0, Vec2::new(LOAD_RADIUS - 0.05 * t, 0.01 * t))];
    for tolerance in [1e-5, 1e-6, 1e-7, 1e-8] {
        let options = BackendOptions::within(BackendKind::QuasiStatic, Tolerance::at_edge(tolerance, &system.load));
        let mut run = build(&system, at_rest(), &options);
        let mut jumps = Vec::new();
        let look = |time: f64, run: &mut dyn Backend| {
            let snap = |kind| {
                let TransitionKind::Jump { shift, turn, energy, is_uncertain } = kind else { return None };
                assert!(is_uncertain, "its end depends on the dissipation");
                Some((shift, turn, energy))
            };
            jumps.extend(run.transitions().iter().filter_map(|seen| Some((time - 0.01 + seen.time, snap(seen.kind)?))));
        };
        let report = drive(run.as_mut(), tip, 1.0, 100, look);
        assert_eq!((report.status, report.n_not_converged), (Status::Converged, 0), "{tolerance}");
        let [(time, (shift, turn, energy))] = jumps[..] else { panic!("{tolerance}: {jumps:?}") };
        // The tip goes 51 mm/s, and the load, once over, no further than it.
        let late = (time - ONSET) * 0.051;
        assert!(late > -1e-9 && late < tolerance, "{tolerance}: {time}");
        // That answer's digits, and legs that end within 2 um of where further ones lead.
        assert!((shift - SHIFT).abs() < 2e-6 + late, "{tolerance}: {shift}");
        assert!((turn - TURN).abs() < 4e-4 + late / LOAD_RADIUS, "{tolerance}: {turn}");
        // Its digits, and the pull that the tip works against while it goes on.
        assert!((energy - ENERGY).abs() < 2e-9 + SLIP_LIMIT * late, "{tolerance}: {energy}");
    }
}
