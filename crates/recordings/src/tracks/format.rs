//! The formats of tracks, and how a file is known to be of one.

use serde::{Deserialize, Serialize};

use super::points::LengthUnit;

/// Program that has written a file of tracks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TrackFormat {
    /// Any table with one header row.
    Table,
    /// DeepLabCut, its CSV files of one or several animals.
    #[serde(rename = "deeplabcut")]
    DeepLabCut,
    /// SLEAP, its analysis CSV.
    Sleap,
    /// idtracker.ai, `trajectories.csv` and `trajectories_tidy.csv`.
    #[serde(rename = "idtracker")]
    IdTracker,
    /// TRex, one CSV for each individual.
    #[serde(rename = "trex")]
    TRex,
    /// tracktor.
    Tracktor,
    /// SwisTrack, one table for each track.
    #[serde(rename = "swistrack")]
    SwisTrack,
}

impl TrackFormat {
    /// All formats, in the order of the documentation.
    pub const ALL: [Self; 7] = [Self::Table, Self::DeepLabCut, Self::Sleap, Self::IdTracker, Self::TRex, Self::Tracktor, Self::SwisTrack];

    /// Name for people.
    pub fn title(self) -> &'static str {
        match self {
            Self::Table => "table",
            Self::DeepLabCut => "DeepLabCut",
            Self::Sleap => "SLEAP",
            Self::IdTracker => "idtracker.ai",
            Self::TRex => "TRex",
            Self::Tracktor => "tracktor",
            Self::SwisTrack => "SwisTrack",
        }
    }

    /// The format of a file, from its first lines.
    ///
    /// # Errors
    /// What the file is, and how to export it, if it is one that is not read.
    pub fn of(bytes: &[u8]) -> Result<Self, String> {
        const BINARIES: [(&[u8], &str); 4] = [
            (
                b"\x89HDF",
                "an HDF5 file: export CSV, as with `sio export FILE -o analysis.csv` of SLEAP or `idtrackerai_format SESSION --formats csv`",
            ),
            (b"\x93NUMPY", "a NumPy file: export CSV, as with `idtrackerai_format SESSION --formats csv`"),
            (b"PK\x03\x04", "a compressed archive: of TRex export CSV, with `-output_format csv`"),
            (b"PAR1", "a Parquet file: export CSV"),
        ];
        if let Some((_, found)) = BINARIES.iter().find(|(magic, _)| bytes.starts_with(magic)) {
            return Err((*found).to_owned());
        }
        let text = String::from_utf8_lossy(&bytes[..bytes.len().min(1 << 16)]).to_lowercase();
        let text = text.trim_start_matches('\u{feff}');
        let first = text.lines().find(|line| !line.trim().is_empty() && !line.starts_with('#')).unwrap_or_default();
        let names: Vec<&str> = first.split([',', ';', '\t']).map(|name| name.trim().trim_matches('"')).collect();
        let has = |name: &str| names.contains(&name);
        Ok(match names[..] {
            ["scorer", ..] => Self::DeepLabCut,
            _ if first.starts_with("%frame number") => Self::SwisTrack,
            _ if has("frame_idx") && names.iter().any(|name| name.ends_with(".x")) => Self::Sleap,
            _ if names.iter().any(|name| name.starts_with("x#wcentroid") || name.starts_with("x#pcentroid")) => Self::TRex,
            ["time" | "seconds", "x1", "y1", ..] | ["frame", "time", "individual", "x", "y", ..] => Self::IdTracker,
            _ if has("frame") && has("pos_x") && has("pos_y") => Self::Tracktor,
            _ => Self::Table,
        })
    }

    /// Whether places are those of an image, whose y axis points down.
    pub fn is_of_images(self) -> bool {
        self != Self::Table
    }

    /// Unit of lengths in files of this format that do not state it.
    pub fn length(self) -> LengthUnit {
        match self {
            Self::Table => LengthUnit::Unknown,
            // TRex multiplies by its setting `cm_per_pixel` before it writes.
            Self::TRex => LengthUnit::Metres(1e-2),
            _ => LengthUnit::Pixels,
        }
    }
}
