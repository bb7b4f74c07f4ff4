//! Tracks in SI units.

use cohaul::math::Vec2;

/// Name of the track that is the pose of the load.
pub const LOAD: &str = "load";

/// Place of one thing in one frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Time since the start of the scenario (s).
    pub time: f64,
    /// Position (m, world axes).
    pub position: Vec2,
    /// Heading (rad), if the recording has it.
    pub heading: Option<f64>,
    /// Confidence of the tracker (1), if the recording has it.
    pub confidence: Option<f64>,
}

/// Places of one thing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Track {
    /// Name of the thing in the recording.
    pub id: String,
    /// Places in the order of time, one for each frame in which the thing was seen.
    pub samples: Vec<Sample>,
    /// Places at which a tip was let go, as the recording states; in the order of time.
    pub releases: Vec<Sample>,
}

/// All tracks of a recording.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tracks {
    /// Tracks in the order of their names, with numbers in the order of their size.
    pub tracks: Vec<Track>,
    /// Pose of the load, if the recording has it in columns of its own.
    pub load: Option<Track>,
    /// Times of all frames (s), in order, also of those in which nothing was seen.
    pub frames: Vec<f64>,
    /// Whether names of tracks are indices of springs.
    pub are_springs: bool,
}

impl Tracks {
    /// Median time from one frame to the next (s); zero for a single frame.
    pub fn frame_interval(&self) -> f64 {
        let mut steps: Vec<f64> = self.frames.windows(2).map(|pair| pair[1] - pair[0]).collect();
        steps.sort_by(f64::total_cmp);
        steps.get(steps.len() / 2).copied().unwrap_or(0.0)
    }

    /// Time of the last frame (s).
    pub fn end(&self) -> f64 {
        self.frames.last().copied().unwrap_or(0.0)
    }

    /// Names of all tracks.
    pub fn ids(&self) -> Vec<&str> {
        self.tracks.iter().map(|track| track.id.as_str()).collect()
    }
}
