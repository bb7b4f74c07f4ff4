//! Every numeric constant of the backends, by what it belongs to.
//!
//! A doc comment says what a constant is, its unit in parentheses, the reason for its value, and as
//! far as it is known what goes wrong where it is larger or smaller. Counts have no unit. Lengths,
//! forces and energies are compared with those of the load, so that most constants have the unit 1.
//! A name stands for one meaning: what two methods mean by the same number is one constant.

// Springs and their tips, and the certificate that a load at rest sticks.

/// Largest swing (rad): beyond it a float does not count turns any more.
pub const LARGEST_SWING: f64 = 1e12;
/// Largest coordinate of a tip and largest entry of a motion (SI units): beyond it energies have no
/// finite value. Scenarios end at 1e50.
pub const LARGEST_ENTRY: f64 = 1e60;
/// Radius of the ball of tips that a stick certificate covers, over the length of the spring (1).
/// The law of the spring changes little in it.
pub const CERTIFICATE_BALL: f64 = 0.125;
/// Largest turn of a spring whose tip stays in the ball of its certificate (rad): arcsin(1/8),
/// rounded up.
pub const CERTIFICATE_TURN: f64 = 0.1254;

// The friction problem in three variables.

/// Residual up to which an answer counts as exact: some tens of roundings of the sums in it (1).
pub const EXACT: f64 = 1e-13;
/// Distance of supports over their extent that is none (1): no solver could tell them apart.
pub const SAME_POINT: f64 = 1e-12;
/// Largest distance of supports from their middle over the size of the load that is short (1).
pub const CLUSTERED: f64 = 0.1;
/// Largest distance of a support from the middle of all, over the distance of the middle from the
/// origin, below which twists are about the middle (1).
pub const ABOUT_MIDDLE: f64 = 1e-2;
/// Largest number of supports of which each is tried as the one that the load turns about. With
/// more of them the continuation finds the pin at less cost.
pub const FEW_SUPPORTS: usize = 8;
/// Slip of a support over the size of the twist below which its direction is left to the polar
/// coordinates (1). Turns count by the reach of the supports.
pub const SLOWEST_GLIDING: f64 = 1e-3;
/// Most iterations of Newton's method on a slipping load; a start that needs more was not near.
pub const GLIDING_ITERATIONS: u32 = 8;
/// Residual at which Newton's method has nothing left to gain (1): a few roundings.
pub const NOTHING_LEFT: f64 = 1e-15;
/// Most iterations for a single support: six or so are needed where there is a minimum.
pub const SINGLE_ITERATIONS: u32 = 60;
/// Resistance to turning about a support, over the largest resistance, that is rounding (1).
pub const LEAST_TURN_STIFFNESS: f64 = 1e-14;
/// Change of an angle in one step beyond which Newton's method is not trusted (rad).
pub const SLIPPING_TURN: f64 = 1.5;
/// Most iterations in a row, in polar coordinates, in which the residual does not fall.
pub const SLIPPING_PATIENCE: u32 = 4;
/// Largest number of iterations in polar coordinates; near an answer some six are needed.
pub const SLIPPING_ITERATIONS: u32 = 40;
/// Number of stages of smoothed friction, down to the rounding of double precision.
pub const SMOOTHED_STAGES: i32 = 15;
/// Number of stages at a coarse accuracy: nearly every answer is found in them.
pub const COARSE_STAGES: i32 = 4;
/// Accuracy of the first stages (1): the exact methods or the next stage take over from there.
pub const COARSE_ACCURACY: f64 = 1e-3;
/// Largest number of iterations of one stage; a stage takes some ten.
pub const STAGE_ITERATIONS: u32 = 60;
/// Largest number of iterations in all stages and in the exact methods between them; where these
/// find the answer, all take some hundred.
pub const SMOOTHED_ITERATIONS: u32 = 300;
/// Most rounds that move forces back within limits: enough for nearly all loads that can rest.
pub const REST_ROUNDS: u32 = 16;
/// Share of its limit that a force beyond it is moved back to (1).
pub const MOVED_BACK_TO: f64 = 0.98;
/// Over-relaxation of forces that are moved back (1): the next round corrects what goes too far.
pub const OVER_RELAXATION: f64 = 1.6;
/// Most rounds of weighting in the search for room: enough to about a percent below slipping.
pub const MOST_WEIGHTINGS: u32 = 16;
/// Number of parabolas that replace the losses of the cones before Newton's method takes over.
pub const N_PARABOLAS: u32 = 2;
/// Room that is not worth the search, as a share of each limit (1).
pub const LEAST_ROOM_SOUGHT: f64 = 0.01;
/// Share of the possible room at rest that is enough (1): more is not worth further rounds.
pub const ENOUGH_ROOM: f64 = 0.5;
/// Least weight of a cone in the search for room (1): at zero the cone would be lost for good.
pub const LEAST_WEIGHT: f64 = 1e-4;
/// Margin for rounding in a certificate of rest, as a share of each limit (1).
pub const REST_MARGIN: f64 = 1e-9;
/// Tolerance for clarabel in scaled units (1): about where rounding ends its iterations on problems
/// of this kind. By default it stops at 1e-8 of the objective, which is 1e-4 of the twist.
pub const CLARABEL_TOLERANCE: f64 = 1e-13;
/// Error of clarabel's increments over their size (1). It exceeds the root of the tolerance, 3e-7,
/// since an objective is flat at its minimum.
pub const CLARABEL_ACCURACY: f64 = 1e-6;
/// Share of its limit by which clarabel's force of a sticking support is below it (1).
pub const CLARABEL_STICKS: f64 = 1e-6;

// One increment with springs and friction, by descent and by Newton's method.

/// Size of a Newton step over that of the increment at which this is exact to rounding (1).
pub const RELATIVE_TOLERANCE: f64 = 1e-12;
/// Size of a Newton step over the extent of the load, for increments near rounding (1).
pub const ABSOLUTE_TOLERANCE: f64 = 1e-15;
/// Residual of the cone problem, or size of the last Newton step over the load's extent, above
/// which a step has not converged, and residual up to which forces at rest have not changed (1). It
/// is a thousand times what converged steps reach, and far below what the error of a path could
/// show.
pub const LARGEST_RESIDUAL: f64 = 1e-9;
/// Largest number of iterations of Newton's method on springs and friction from a guess. Descent
/// from rest is better where a guess takes more.
pub const CORRECTOR_ITERATIONS: u64 = 6;
/// Second correction over the increment after which a third one can still be far smaller (1).
pub const STRETCHED: f64 = 0.05;
/// Size of a correction, over that of the increment, that is rounding (1).
pub const CORRECTION_ROUNDING: f64 = 4.0 * f64::EPSILON;
/// Size of a correction, over that of the increment, up to which the next ones need no derivative
/// of their own (1). The error left is its third power.
pub const CLOSE_CORRECTION: f64 = 3e-5;
/// Most iterations of a descent: two to six where it converges, and no number suffices at a kink.
pub const DESCENT_ITERATIONS: u64 = 60;
/// Size of a step over that of the increment up to which it is short (1).
pub const SHORT_STEP: f64 = 0.1;
/// Size of a step over that of the one before up to which the next ones are likely to follow (1).
/// Steps of springs that are not convex shrink to 0.9 and more, which tells how far they may lead.
pub const STEADY: f64 = 0.98;
/// Largest number of corrections once the steps of a descent are short and steady.
pub const MOST_CORRECTIONS: u32 = 4;
/// Longest turn in one Newton step (rad), and largest size that a descent or a linear step with
/// contacts is extended to (1). Linear and quadratic models say little beyond.
pub const LONGEST_TURN: f64 = 0.5;
/// Iterations after which a descent with springs that are not convex counts as slow.
pub const SLOW_DESCENT: u64 = 4;
/// Slip of a support over the size of the increment below which friction holds the support (1).
pub const HELD_SLIP: f64 = 1e-6;
/// Smallest share of the friction's curvature that is tried, over that of the springs' (1).
pub const LEAST_CURVATURE: f64 = 0.125;
/// Iterations of a descent after each of which springs and friction are tried at once.
pub const JOINT_EACH: u64 = 4;
/// Largest number of iterations of Newton's method on springs and friction at once.
pub const JOINT_ITERATIONS: u64 = 20;
/// Longest step of Newton's method on springs and friction at once, over the increment (1).
pub const JOINT_STEP: f64 = 0.25;

// Gaps, corners, faces and depths: whether and where a load touches obstacles.

/// Gap over the load's radius that is rounding (1): far above that of a single gap.
pub const CLOSED_GAP: f64 = 1e-11;
/// Gap and overlap over the load's radius up to which contacts are kept (1): ten times rounding.
pub const KEPT_GAP: f64 = 10.0 * CLOSED_GAP;
/// Rounding of a gap and of a slip, over the sum of the lengths that they come from (1). In a step,
/// a load that leans on a corner may move by no more than thousands of it, and a slip that is
/// rounding must not point its friction.
pub const GAP_ROUNDING: f64 = 2.0 * f64::EPSILON;
/// Overlap over the load's radius that is none (1): the least step in a wall that stops a load.
/// Closed gaps are a hundredth of it, and rounding of many steps is less.
pub const FLUSH_OVERLAP: f64 = 1e-9;
/// Rounding of a gap at corners over the distance between load and obstacle (1).
pub const CORNER_ROUNDING: f64 = 16.0 * f64::EPSILON;
/// Distance over the load's radius from an edge's end up to which corner meets corner (1). The
/// Gauss map decides nothing inside an edge, so that anything above [`FLUSH_OVERLAP`] will do.
pub const EDGE_END: f64 = 1e-3;
/// Sine of the angle by which a normal may lie outside of a cone of normals (1): rounding.
pub const CONE_ROUNDING: f64 = 1e-7;
/// Sine of the angle between two edges that lie along each other (1): 0.1 rad. The turn of a load
/// in a step may make them parallel. Which of the two ends has the face depends on the sign of the
/// angle.
pub const ALONG: f64 = 0.1;
/// Cosine between the normals of one face (1): 0.1 rad, far more than a load turns in a step.
pub const ALIKE: f64 = 0.995;
/// Sine of the angle between two edges below which they are one (1): no load meets the corner.
pub const STRAIGHT_EDGE: f64 = 1e-9;
/// Share of the smallest feature that a load moves by in one piece, and share of the shorter edge
/// by which edges go on behind an enclosed corner (1). A larger piece could step over a feature.
pub const PIECE: f64 = 0.25;
/// Most pieces of a displacement that are looked at (1). A longer one is cut behind them.
pub const MOST_PIECES: usize = 4096;
/// Most times that a piece is halved at whose end outlines cross (1): down to rounding.
pub const PIECE_HALVINGS: usize = 40;
/// Depth over the load's radius by which outlines cross (1): a hundred times what a contact may
/// overlap by, so that those that touch corner to corner do not.
pub const CROSSED: f64 = 1e-8;
/// Depth over the load's radius beyond which a load lies inside an obstacle (1): ten times the
/// overlap up to which a step in a wall is none.
pub const INSIDE: f64 = 1e-8;
/// Depth over the load's radius beyond which a load that lies inside an obstacle after a step
/// without convergence is squeezed (1). Where no motion exists, each step ends deeper; where one
/// exists, those of random scenes end a hundred times less deep.
pub const SQUEEZED: f64 = 0.01;
/// Rounding of positions and of outlines over the lengths that they come from (1).
pub const GATE_ROUNDING: f64 = 64.0 * f64::EPSILON;
/// Penetration over the load's radius at the start of a step, and across a closed face (1): the
/// rounding of many steps. Deeper features lie on the other side of the load.
pub const DEEP: f64 = 1e-6;
/// Difference of the normals of flush obstacles (1): rounding of headings and of far corners.
pub const FLUSH_NORMAL: f64 = 1e-7;
/// Least margin of the list of near obstacles over the load's radius (1). A smaller one is renewed
/// more often, a larger one lists more.
pub const NEAR_MARGIN: f64 = 0.5;
/// Distance of contact points over the load's radius that is none (1): rounding of many steps.
pub const NARROW_FACE: f64 = 1e-6;
/// Difference of the normals of two contacts of one wall, and distance of its sides over the length
/// of the cones (1): rounding. Over the size of a load it is far less than the engine's rounding of
/// contact points, and more than that of normals.
pub const PARALLEL_NORMALS: f64 = 1e-9;

// One linear step with contacts.

/// Slip over the size of the increment beyond which it has a direction (1): below is rounding.
pub const NO_SLIP: f64 = 1e-13;
/// Size of an increment that is rest, over that which is looked for (1): far above rounding.
pub const RESTS: f64 = 1e-11;
/// Rounding of the slip of a support, over the size of the increment (1).
pub const ROUNDED_SLIP: f64 = 1e-13;
/// Residual up to which an answer is reported as one (1): ten times what ends a search.
pub const CONVERGED: f64 = 1e-11;
/// Residual up to which an answer is taken without looking for a better one (1).
pub const ACCEPTED: f64 = 1e-12;
/// Largest number of changes of contact modes in one walk.
pub const MODE_CHANGES: u32 = 6;
/// Slip over the size of the increment below which a contact sticks (1).
pub const SLOW_CONTACT: f64 = 1e-7;
/// Increment over that without contacts below which lengths are compared with it (1).
pub const SMALL_INCREMENT: f64 = 0.1;
/// Largest number of contacts up to which all combinations of their modes are tried.
pub const FEW_CONTACTS: usize = 4;
/// Contacts at most whose modes differ between an answer that is not stable and one that is looked
/// for near it. None of 20,000 random steps and of 1,319 steps of a jam had a stable answer that
/// differed in more and moved the load otherwise; two of the jam did that differ in three.
pub const MOST_OTHERS: usize = 3;
/// Length of the part of a unit row across the others below which it depends on them (1).
pub const DEPENDENT_ROW: f64 = 1e-9;
/// Imbalance of unit rows that is rounding (1).
pub const UNIT_IMBALANCE: f64 = 1e-12;
/// Overlap over the size of the increment that is rounding (1).
pub const ROUNDED_OVERLAP: f64 = 1e-12;
/// Largest number of reflections before all groups of contacts are tried. They take as long as some
/// hundred groups, and thirty contacts have 31,900.
pub const MOST_REFLECTIONS: usize = 50;
/// Most iterations in given contact modes; a start that needs more was not near.
pub const MODE_ITERATIONS: u32 = 14;
/// Iterations in a row that do not halve the residual, after which hardly any search converges.
pub const MOST_IDLE: u32 = 6;
/// Residual below which a rise is rounding (1).
pub const ROUNDED_RISE: f64 = 1e-11;
/// Error of a dependent equation, over the size of the increment, that is rounding (1).
pub const CONSISTENT: f64 = 1e-11;
/// Ridge that stands for the stiffness of directions without any, over the largest one (1).
pub const SOFT_RIDGE: f64 = 1e-12;
/// Error of a condition, over the increment that well-posed rows give, that is no rounding (1).
pub const CONTRADICTS: f64 = 1e-6;
/// Largest condition number of three rows that give an increment up to rounding (1).
pub const WELL_POSED: f64 = 1e8;
/// Slip offset over the increment at which rest is asked whether it is stable (1). It is shorter
/// than what a load slides by in a short step before its springs hold it again.
pub const DISTURBANCE: f64 = 1e-9;
/// Size of the increment over the offset [`DISTURBANCE`] that the disturbed step is solved for (1).
pub const MAGNIFIED: f64 = 1e3;
/// Slip offset over the size of the increment at which the search for a slide begins (1).
pub const FIRST_OFFSET: f64 = 1e-3;
/// Slips beyond the offsets that are rounding, over the offsets (1).
pub const OFFSET_ROUNDING: f64 = 1e-6;
/// Largest number of rounds of Newton's method on the slip offsets.
pub const OFFSET_ROUNDS: u32 = 40;
/// Largest number of rounds of Newton's method away from a rest that is not stable.
pub const DISTURBED_ROUNDS: u32 = 12;
/// Difference of two increments over their size that is rounding (1).
pub const SAME_INCREMENT: f64 = 1e-9;
/// Change of slip offsets over the largest that is rounding (1): the convex step has such slips but
/// no answer, as where friction cones contradict gaps.
pub const UNCHANGED_OFFSETS: f64 = 1e-12;
/// Rounds after which steps of the slip offsets are shortened: Newton's method goes to and fro.
pub const FULL_ROUNDS: u32 = 25;
/// Growth of the slip by its offset from which on the offset is not near its root (1).
pub const STEEP_SLIP: f64 = 0.9;
/// Rounds of rotations at most that decouple a slope into its eigenvalues: one takes some three.
pub const MOST_ROTATIONS: usize = 200;
/// Convex step over that without contacts up to which it is next to the limit of slipping (1).
pub const NEXT_TO_REST: f64 = 1e-3;
/// Largest number of iterations of the interior-point path; a convex step takes some twenty.
pub const PATH_ITERATIONS: u32 = 80;
/// Smoothing at the end of the interior-point path (1): some hundreds of roundings.
pub const LAST_SMOOTHING: f64 = 1e-13;
/// Imbalance of forces at the end of the interior-point path (1).
pub const PATH_IMBALANCE: f64 = 1e-11;
/// Error of a condition over the smoothing of the interior-point path that does not matter (1).
pub const NEAR_SMOOTHING: f64 = 10.0;
/// Rounding of a gap on the interior-point path, over the gap (1).
pub const PATH_ROUNDING: f64 = 1e-15;
/// Share of the distance to a limit that a step of the interior-point path may go (1): at 1 it
/// would end on the limit, and so would the path.
pub const SHARE_TO_LIMIT: f64 = 0.97;
/// Number of rounds that balance forces at rest: the second one balances what rounding has left.
pub const BALANCE_ROUNDS: u32 = 2;
/// Least room of a force at rest, over its limit (1).
pub const LEAST_ROOM: f64 = 1e-9;
/// Ridge for forces that do not span all wrenches, over the largest entry (1).
pub const FORCE_RIDGE: f64 = 1e-15;
/// Least work of a slide, over its slip and the limits of the ground, that is not rounding (1).
pub const LEAST_WORK: f64 = 1e-9;
/// Largest number of parts into which a family of slides is divided. Of 3,300 random families next
/// to their limits, six were divided into as many, and nine of ten into at most six.
pub const MOST_PARTS: usize = 64;

// One nonlinear step with contacts: Newton's method, linear steps, reach and resistance.

/// Most forces of contacts on a load that turns about a support: it has one degree of freedom.
pub const MOST_ABOUT_PIVOT: usize = 1;
/// Most iterations on a nonlinear step in given modes; a guess that needs more was not near.
pub const CONTACT_ITERATIONS: usize = 12;
/// Residual over the forces at which a nonlinear step in given modes ends (1): 100 roundings.
pub const BALANCED: f64 = 3e-14;
/// Residual over the forces at which a nonlinear step may end where it no longer improves (1).
pub const STALLED: f64 = 1e-11;
/// Largest number of linear steps in a nonlinear one.
pub const LINEAR_STEPS: usize = 40;
/// Most linear steps for an answer that has to be near: nearly all are found in fewer.
pub const LINEAR_STEPS_NEAR: usize = 10;
/// Largest number of linear steps without an answer, each of which takes as long as many with one.
pub const FAILED_STEPS: u32 = 3;
/// Linear steps after which only half of each is taken, where whole ones do not settle.
pub const STEPS_IN_FULL: usize = 20;
/// Cosine of the angle between linear steps that point the same way (1).
pub const ALIGNED: f64 = 0.9;
/// Linear steps in one direction after which they are doubled: most searches end in fewer.
pub const STEPS_ALIKE: i32 = 2;
/// Most times that the motion of the obstacles in a step is halved (1).
pub const MOTION_HALVINGS: i32 = 6;
/// Displacement over the load's radius to which the first resistance holds the load (1).
pub const FIRST_YIELD: f64 = 0.3;
/// Ratio of one resistance to the one before (1).
pub const STIFFER: f64 = 8.0;
/// Largest number of resistances that are tried, each [`STIFFER`] than the one before.
pub const MOST_RESISTANCES: usize = 6;
/// Ratio of one resistance to the one before on a path that an earlier one has held (1).
pub const STIFFER_AGAIN: f64 = 2.0;
/// Increment, over the load's radius, that is none (1).
pub const SHORTEST_INCREMENT: f64 = 1e-9;
/// Increment over the load's radius beyond which it is no answer (1): there a gap as small as a
/// contact may have is far below the rounding of positions. Where nothing resists, and rounding
/// alone says that contacts can be met, increments overflow.
pub const LONGEST_INCREMENT: f64 = 1e9;
/// Largest number of attempts with farther and farther features.
pub const REACH_ATTEMPTS: usize = 12;
/// Reach of the first look for features, over the load's radius (1).
pub const FIRST_REACH: f64 = 0.01;
/// Last reach over the load's radius (1). Longer paths are cut where they would pass a feature.
pub const LONGEST_REACH: f64 = 2.0;
/// Ratio of a resistance to that of the next leg of the same path (1). A leg is four times as long
/// as the one before where that is possible. Where it is not, six attempts with twice the stiffness
/// each reach eight times the resistance before.
pub const SOFTER: f64 = 4.0;
/// Most rounds that close contacts: each squares the error, unless contacts open each other.
pub const MOST_CLOSINGS: usize = 12;

// Touches and impacts: when they happen, and the velocity after them.

/// Speed across a contact over the largest speed at which it counts as closed (1): rounding.
pub const CLOSED_SPEED: f64 = 1e-9;
/// Slip over half of what the curvature adds to it within a step, up to which it may stop within
/// the step or have just begun (1): as for supports.
pub const CREEPING: f64 = 4.0;
/// Singular value of the gains of contacts over the largest one that is rounding (1).
pub const SINGULAR_GAIN: f64 = 1e-10;
/// Relative gain of energy in an impact that is rounding (1).
pub const GAINED_ENERGY: f64 = 1e-12;
/// Most impacts in turn by Poisson's law (1). A contact that parted before an impact may approach
/// after it, and is met by a plastic one.
pub const POISSON_IMPACTS: usize = 4;
/// Largest number of touches in one step (1). The rest of the step is taken as one of implicit
/// Euler that regards all features within reach, and without bounces.
pub const MOST_TOUCHES: usize = 64;
/// Number of Newton iterations after which a step is divided no further, neither by touches nor for
/// want of an answer (1). A touch takes some hundred of them. A part without an answer takes
/// thousands, and so does each of its halves.
pub const STEP_ITERATIONS: u64 = 20_000;
/// Largest number of times that a step without an answer is halved (1).
pub const STEP_HALVINGS: usize = 5;
/// Number of touches that one without any motion before it counts for (1).
pub const STANDSTILL: usize = 8;
/// Largest number of attempts to locate a touch.
pub const LOCATING_ATTEMPTS: usize = 80;
/// Largest number of attempts to locate a touch that are by Newton's method: the first ones.
pub const LOCATING_NEWTON_ATTEMPTS: usize = 20;
/// Most times that a touch is located again, since the load met other features on its curved path.
/// Then the step is taken as one of implicit Euler.
pub const EARLIER_TOUCHES: usize = 8;
/// Fall of a loss by extrapolation, over slip limit times radius, with which there is none (1).
pub const LEAST_FALL: f64 = 1e-4;
/// Gap over the load's radius at which a touch is located (1): some hundreds of roundings.
pub const LOCATED_GAP: f64 = 1e-13;
/// Gap over the load's radius up to which features touch when a touch is located (1): as for
/// contacts that are kept, and far more than what locating leaves.
pub const TOUCHED_GAP: f64 = 1e-10;
/// Gap over the load's radius that is rounding, where the speed of a bounce is judged (1).
pub const ROUNDED_GAP: f64 = 1e-12;
/// Height of a bounce that is none, over the tolerance of a macro-step (1).
pub const NEGLIGIBLE_BOUNCE: f64 = 0.01;
/// Least share of a macro-step that is left at a touch its steps did not see (1): the first
/// estimates may be poor.
pub const SHORTEST_CUT: f64 = 0.1;
/// Largest share of a macro-step that is left at a touch its steps did not see (1): less than all.
pub const LONGEST_CUT: f64 = 1.0 - 1e-6;
/// Pull of a contact over its force before, up to which it is an error of extrapolation (1): what
/// it does within that share of a macro-step is lost in its tolerance.
pub const PULL_ERROR: f64 = 1e-3;
/// Slip over the speed of the load that is none where it reverses (1).
pub const REVERSED_SLIP: f64 = 1e-9;

// Division of time: default steps, error control, its work and its energies.

/// Longest default step of the quasi-static method (s), the control period of the paper. The tips
/// go so far in longer steps that jumps of the load are not recognised.
pub const LONGEST_DEFAULT: f64 = 2.5e-3;
/// Shortest step that is taken by default (s). A scene may be too stiff to resolve in reasonable
/// time, and all methods are stable at longer steps.
pub const SHORTEST_STEP: f64 = 1e-5;
/// Largest angle of the fastest oscillation in a step (rad), twice that of the default step with
/// springs at rest: moderate deformations leave the step as it is.
pub const LARGEST_ANGLE: f64 = 0.2;
/// Angle of the fastest oscillation in a step beyond which the step does not resolve it (rad).
pub const UNRESOLVED_ANGLE: f64 = 1.0;
/// Deformation of a spring over its rest length, or the load's radius if that is longer, up to
/// which its stiffness is near that at rest (1). All such springs together are not evaluated.
pub const SMALL_DEFORMATION: f64 = 0.5;
/// Excess of a duration over a multiple of the step that is ignored, over the step (1): rounding.
pub const IGNORED_EXCESS: f64 = 1e-9;
/// Share of a step or an advance within which a waypoint of an obstacle lies at its start or its
/// end (1): more than times lose by rounding, and less than errors of a step show.
pub const SAME_INSTANT: f64 = 1e-6;
/// Largest ratio of two steps (1). The method is stable up to 1 + sqrt(2) (Grigorieff, 1983).
pub const LARGEST_RATIO: f64 = 2.0;
/// Error of a macro-step over that of the run (1). The errors add up at first, until friction and
/// springs bring the load back to its path.
pub const MACRO_STEP_SHARE: f64 = 1e-4;
/// Largest error of a macro-step over the load's radius (1). Beyond it the error is no longer small
/// compared with the quantities that it is estimated from.
pub const LARGEST_MACRO_STEP_ERROR: f64 = 1e-3;
/// Smallest error of a macro-step over the load's radius (1): positions are rounded below it.
pub const SMALLEST_MACRO_STEP_ERROR: f64 = 1e-13;
/// Largest number of repetitions of a run with smaller errors of the macro-steps.
pub const MOST_TIGHTENED: u32 = 3;
/// Tolerance of the run that checks another one, over that of the other (1).
pub const CHECK_SHARE: f64 = 4.0;
/// Bound of the error over the largest distance of the run and the one that checks it (1). A
/// located change is taken in two steps by one run and in one step by the other; to first order the
/// error of the first is as large as the distance.
pub const TANDEM_SAFETY: f64 = 2.0;
/// Bound of the errors that both runs share, over the tolerance (1). On random scenes errors that
/// exceed twice the distance move the edge by at most 0.06 of the tolerance; a shift and a turn of
/// this share move it by 0.1.
pub const SHARED_ERROR: f64 = 0.05;
/// Bound of the errors that both runs share at obstacles, over the tolerance (1): both meet the
/// same touches. On random scenes such errors move the edge by up to 0.95 of the tolerance; a shift
/// and a turn of this share move it by 1.
pub const SHARED_AT_OBSTACLES: f64 = 0.5;
/// Work that a run at obstacles, and all its repetitions together, may take for each simulated
/// second, in Newton iterations and solved friction problems (1): one to two seconds of a processor
/// with inertia, up to five without. What a second leaves is there for the next one, and the first
/// second is there at once. Of random scenes that are decided at all, nearly none needs half.
pub const WORK_PER_SECOND: f64 = 2e6;
/// Largest number of macro-steps before a longer one, which failed, is tried again.
pub const MOST_WAIT: u32 = 64;
/// Shortest macro-step over the advance (1). What still differs there is a jump.
pub const SHORTEST_MACRO_STEP: f64 = 1.0 / (1u64 << 30) as f64;
/// Shortest macro-step over the advance (1) in the long run where they neither converge nor agree
/// at any length. Shorter ones are no better there, and much slower.
pub const SHORTEST_UNSOLVED: f64 = 1.0 / 16.0;
/// Error of a macro-step with a change over that of a smooth one (1): there are few of them.
pub const CHANGE_SHARE: f64 = 10.0;
/// Displacement of tips and obstacles over the error of a macro-step with a change in it, in which
/// a change of a load without inertia is located (1). It moves only as they do.
pub const LOCATED: f64 = 0.1;
/// Rounding of energies that have added up over a run and been extrapolated (1).
pub const ENERGY_ROUNDING: f64 = 1e-14;
/// Most rows of extrapolation: errors fall with the power of the row, roundings grow by four each.
pub const MOST_ROWS: usize = 8;
/// Length over the advance down to which macro-steps are shortened because steps did not converge
/// (1). Where shorter ones do not either, answers are compared and their status says so.
pub const SHORTENED_TO_SOLVE: f64 = 1.0 / 1024.0;
/// Growth of the shortest macro-step, for the rest of an advance, after each one that had to be
/// taken as it was (1). Where nothing converges the load still arrives, and the statuses of the
/// steps and the run beside show what that is worth.
pub const FORCED_GROWTH: f64 = 2.0;
/// Number of rows below which a macro-step may be longer at less cost in all. At obstacles the
/// errors need not be a series: they may be as large at twice the length, and macro-steps that have
/// become short would remain so. Longer ones are tried there whatever the number of rows, and less
/// and less often where they fail.
pub const FAVOURED_ROWS: usize = 5;
/// Length over the shortest macro-step up to which one is not shortened (1).
pub const LONGEST_SHORTEST: f64 = 1.5;
/// Share of the tolerance that a macro-step aims at, so that few fail (1).
pub const AIM: f64 = 0.5;
/// Largest growth between macro-steps (1). After a located change it starts from almost nothing.
pub const FASTEST_GROWTH: f64 = 64.0;
/// Number of attempts in an advance after which macro-steps have met what they do not resolve, such
/// as a motion that no force resists (1).
pub const MANY_ATTEMPTS: f64 = 256.0;
/// Attempts added to [`MANY_ATTEMPTS`] for each longest macro-step that fits into an advance (1).
pub const MANY_A_MACRO_STEP: f64 = 64.0;
/// Cone problems that count for an attempt (1). One among obstacles may need many more.
pub const SOLVES_AN_ATTEMPT: f64 = 512.0;
/// Growth of the shortest macro-step after each time that [`MANY_ATTEMPTS`] were made (1).
pub const GROWTH_AFTER_MANY: f64 = 32.0;
/// Length of the macro-steps that lead to where a load jumps, over that of one which leads beyond
/// (1): an attempt that finds no balance takes hundreds of times as long as one that finds it.
pub const TOWARDS_JUMP: f64 = 0.125;
/// Attempts in a row that may be cut by little: Newton's method locates touches.
pub const MOST_CUTS: u32 = 8;
/// Largest defect outside of jumps, over the largest entry, with which the ledger of a run under
/// error control counts as closed (1). Such a run keeps the energy of each macro-step to a share of
/// its tolerance. The ledgers of runs that lose or gain energy by a wrong event are off by
/// percents; a thousandth lies between both, and below all that is printed of an energy.
pub const CLOSED_LEDGER: f64 = 1e-3;
/// Largest gain of energy over the energy that went in, and largest share of the path that a run of
/// the engine may lose by rounding (1): the share of a path that a verdict allows as its error.
pub const LARGEST_SHARE: f64 = 0.01;

// Jumps of a load without inertia, and its paths between them.

/// Longest displacement of a tip in one macro-step while the load is at rest, over its radius (1).
/// A load that slips only between the nodes of a macro-step is not seen to slip.
pub const LONGEST_TIP_DISPLACEMENT: f64 = 0.125;
/// Displacement of an obstacle in a step over the radius by which it bends about the load (1).
pub const LARGEST_BEND: f64 = 0.5;
/// Largest number of pieces of a path that obstacles divide.
pub const PATH_PIECES: usize = 1024;
/// Largest number of pieces of a path that end where no longer one has an answer. Of random paths
/// with more than four of them, 98 % have fewer than 35.
pub const HELD_PIECES: u32 = 128;
/// Number of Newton iterations after which a path is divided no further (1): about a second's
/// worth. A path whose pieces become shorter and shorter would take minutes.
pub const PATH_WORK: u64 = 1_000_000;
/// Number of Newton iterations after which a path is divided no further under error control, where
/// a jump ends that is not decided (1): a small part of the work of a simulated second.
pub const JUMP_WORK: u64 = 100_000;
/// Most iterations of a jump: each is orders of magnitude shorter, and three are rarely needed.
pub const JUMP_ITERATIONS: u32 = 10;
/// Edge displacement over the load's radius (1) up to which a jump is the rounding of a load at the
/// very edge of slipping. Springs that only friction holds there magnify rounding.
pub const SMALLEST_JUMP: f64 = 1e-9;
/// Rounding of the places of a load and an obstacle, over their distance from the world's origin
/// (1): some roundings of numbers of that size. Below it, motion with a pusher reads as a jump.
pub const ROUNDED_PLACE: f64 = 16.0 * f64::EPSILON;
/// Edge displacement over the load's radius (1) that needs no further iteration of a jump.
pub const JUMP_ROUNDING: f64 = 1e-12;
/// Relative rounding of the energies of a run, of which the defect of a step is a difference (1).
pub const JUMP_ENERGY_ROUNDING: f64 = 1e-13;
/// Share of forces out of line up to which the end of a jump is certain (1): to 1 % of its length
/// on a thousand random jumps.
pub const CERTAIN_END: f64 = 0.005;
/// Shares of the path of a jump at which forces are compared (1).
pub const JUMP_SHARES: [f64; 3] = [0.0, 0.5, 0.9];
/// Slip of a support in a jump over that of the fastest one below which it sticks (1).
pub const STICKING_SLIP: f64 = 1e-9;
/// Stiffness of a dashpot in a step of vanishing duration, over that of all attached springs (1).
/// The relaxation that it lets pass is this much of its time too early.
pub const RIGID_DASHPOT: f64 = 1e6;
/// First macro-step where forces or the velocities of tips change at once, over the shortest time
/// in which the load can relax (1). Longer implicit steps agree with each other on where a
/// relaxation ends, whatever the path that leads there.
pub const FIRST_MACRO_STEP: f64 = 1e-3;
/// Displacement after a change of the velocity of a tip that needs no macro-step of
/// [`FIRST_MACRO_STEP`], over the tolerance of one (1).
pub const SAME_VELOCITY: f64 = 0.1;
/// Distance by which a tip may miss the continuation of its last path, over the radius of the load
/// and the distance from the origin (1): far above rounding, far below what a step is wrong by.
pub const STRAIGHT_TIP: f64 = 1e-11;
/// Energy that error control may lose in a macro-step, over its tolerance (1).
pub const LOST_ENERGY: f64 = 100.0;

// The equation of motion: longest macro-steps and the integrators.

/// Longest macro-step with inertia, as the angle of the fastest oscillation (rad).
pub const LONGEST_MACRO_STEP: f64 = 2.0;
/// Speed of a support below which it may stop or have stopped within a macro-step, over the change
/// of the load's speed by its turn about the support in that time (1).
pub const SLOW_SUPPORT: f64 = 2.0;
/// Force that the rounding of a position would ask for, over the slip limit, which limits how short
/// macro-steps are at obstacles (1). Contact forces keep their digits in shorter steps. Yet where
/// contacts begin to slide, stick or part, these need not agree: random scenes ended with larger
/// errors without the limit.
pub const ROUNDED_FORCE: f64 = 1e-3;
/// Newmark's beta that cancels the error of frequencies (1), stable up to omega h = sqrt(6).
pub const FOX_GOODWIN: f64 = 1.0 / 12.0;
/// Newmark's beta that evaluates springs at the mean of both ends (1), stable at any step.
pub const MIDPOINT: f64 = 0.25;
/// Largest change of friction in one step that is extrapolated, over the largest friction force or
/// its torque about the load's radius (1).
pub const LARGEST_FRICTION_CHANGE: f64 = 0.5;

// The rigid-body engine: its contacts, its rounding and when a step of it has converged.

/// Residual above which a step counts as not converged (1). A thousandth of the forces is less than
/// the error of a step of a millisecond. Converged iterations end near 1e-15 in f64. In f32 they
/// end near 1e-5, and at 1e-3 for a step of 10 us.
pub const ENGINE_TOLERANCE: f64 = 1e-3;
/// Speed below which a load is at rest (m/s, rad/s): the engine's iterations shrink a speed to the
/// smallest numbers there are, not to zero. At this speed a load moves less than the diameter of a
/// nucleus in a thousand years.
pub const REST_SPEED: f64 = 1e-30;
/// Shift of any point of the load in a step that counts as none (m).
pub const STILL_SHIFT: f64 = 1e-21;
/// Speed of any point that is rounding (m/s): a gram loses it to 1e-15 N in a millisecond.
pub const ROUNDED_SPEED: f64 = 1e-15;
/// Path over the load's radius below which losses are compared with this (1). A load that is held
/// in f32 creeps by 1e-9 m/s while its position stays; such a load is not to count as moving.
pub const SHORTEST_PATH: f64 = 0.1;
/// Largest velocity at which a penetration is removed, over the radius of the load (1/s): the
/// engine's default, with the radius as the unit of length.
pub const FASTEST_CORRECTION: f64 = 3.0;
/// Angle up to which a normal counts as right (rad). In f32, points are known to 1e-5 of the size
/// of a load; wrong normals are wrong by degrees.
pub const RIGHT_NORMAL: f64 = 1e-4;
/// Least distance of two contacts that shows a direction, over that from the load's origin (1).
pub const APART_CONTACTS: f64 = 1e-3;
/// Number of axes in a half turn of the polygon that replaces a friction cone (1).
pub const N_POLYGON_AXES: usize = 8;
/// Number of steps in which the load may lose its speed towards an obstacle. In the first one it
/// closes the gap exactly, in the second one it stops. What it loses against an obstacle later is
/// an error of the steps.
pub const N_IMPACT_STEPS: u8 = 2;
/// Numbers of sweeps in the attempts at a step with contacts, over the usual number (1). A box that
/// slides along a wall in steps of 0.02 / omega ends at 1e-13 after 24 sweeps; with steps of 0.6 /
/// omega, its springs, supports and two contacts agree after 300.
pub const MORE_SWEEPS: [usize; 3] = [1, 4, 16];
/// Stiffness over the largest one below which an axis does not shift the centre (1): its part of
/// `A^-1 b` would be rounding over rounding.
pub const SOFT_AXIS: f64 = 1e-12;
/// Last digits of a velocity in a violation that is none (1): positions and velocities of a contact
/// add up to a few. A load that closes its gap exactly is pushed by no more than such a rounding.
pub const VELOCITY_ROUNDINGS: f64 = 8.0;
/// Share of the friction limit that counts as all of it (1): a rounding in f32.
pub const WHOLE_LIMIT: f64 = 1e-6;
/// Residual of the engine's last forces that have not changed at rest (1): their rounding.
pub const ENGINE_UNCHANGED: f64 = 1e-11;
/// Stiffness of a stiff contact over the load's along it (1): forces keep eight digits.
pub const CONTACT_STIFFNESS: f64 = 1e8;
/// Residual of forces of stiff contacts, in which the load yields by a share of 1e-8 (1).
pub const YIELDING: f64 = 1e-6;
/// Largest number of exchanges of contacts. Three hold a load, so that each of ten contacts comes
/// in and goes out again before it ends.
pub const MOST_EXCHANGES: usize = 20;
