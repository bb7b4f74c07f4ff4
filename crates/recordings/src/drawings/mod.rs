//! Outlines from drawings: SVG, DXF, GeoJSON, the footprint of an OBJ mesh, the planar part of an
//! MJCF model, and outlines of scenarios that break a rule.
//!
//! ```text
//! part.rs     what all readers give: rings and discs in the units of the file
//! flatten.rs  curves as straight lines within a tolerance
//! svg.rs, dxf.rs, geojson.rs, obj.rs, mjcf.rs, entry.rs: the readers
//! outline.rs  parts as one outline: union, holes, centroid
//! ```

mod dxf;
mod entry;
mod flatten;
mod geojson;
mod mjcf;
mod obj;
mod outline;
mod part;
mod read;
mod svg;

pub use outline::Outlined;
pub use read::{DrawingFormat, DrawingOptions, into_scenario, repaired};
