//! Geometry of outlines: areas and moments, decomposition into convex pieces, overlap, lines of
//! sight and closest points. It is the only part of the model that uses parry2d.
//!
//! ```text
//! barrier.rs   outlines as barriers to discs that walk
//! barriers.rs  many of them, in a tree
//! moments.rs   area, centroid and second moment in closed form
//! polygon.rs   crossings and orientation of a polygon
//! pieces.rs    convex pieces, also as shapes of parry2d
//! queries.rs   overlap, line of sight, closest point
//! ```
//!
//! Lengths are in metres. Distances of parry2d between polygons are iterative, with an error of up
//! to about 5e-9 of the size; those of moments and crossings are rounding.

mod barrier;
mod barriers;
mod moments;
mod pieces;
mod polygon;
mod queries;

pub use barrier::{Barrier, FirstContact, Gap, Piece, PlacedBarrier};
pub use barriers::{Among, Barriers};
pub use moments::{AreaMoments, area_moments, moments_of_polygon};
pub use pieces::{ConvexPiece, convex_pieces};
pub use polygon::{first_crossing, turned_counter_clockwise, without_straight_corners, without_straight_points};
pub use queries::{Closest, closest_point, first_hit, gap, overlap_depth, overlap_of_parts, way_out};
