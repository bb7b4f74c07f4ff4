//! Pictures and films of runs, for slides, papers and messages.
//!
//! ```text
//! drawing.rs  runs at one time -> a picture
//! pen.rs      lines, areas, arrows and letters on pixels; the only file that knows the rasteriser
//! film.rs     pictures over time -> GIF, PNG or, through ffmpeg, MP4
//! ```

mod drawing;
mod film;
mod pen;

pub use drawing::{Drawing, Size};
pub use film::{Film, FilmError, Format};
