//! Pictures over time as one file.

use std::io::{Seek, Write};
use std::path::Path;
use std::process::{Command, Stdio};

use gif::{Encoder, Frame, Repeat};

use super::drawing::{Drawing, Size};
use crate::sibling::write_whole;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    Png,
    Gif,
    /// Through ffmpeg.
    Mp4,
}

impl Format {
    /// The format that the name of a file asks for.
    pub fn of(path: &Path) -> Option<Self> {
        match path.extension()?.to_str()?.to_ascii_lowercase().as_str() {
            "png" => Some(Format::Png),
            "gif" => Some(Format::Gif),
            "mp4" => Some(Format::Mp4),
            _ => None,
        }
    }
}

#[derive(Debug, thiserror::Error)]
pub enum FilmError {
    #[error("interrupted")]
    Interrupted,
    #[error("{0}")]
    File(#[from] std::io::Error),
    #[error("{0}")]
    Gif(#[from] gif::EncodingError),
    #[error("{0}")]
    Png(#[from] png::EncodingError),
    #[error("an MP4 needs ffmpeg on the path, and it cannot be started: {0}; a .gif needs nothing else")]
    NoFfmpeg(std::io::Error),
    #[error("ffmpeg failed: {0}")]
    Ffmpeg(String),
}

/// Times of the pictures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Film {
    /// First and last time (s).
    pub from: f64,
    pub to: f64,
    /// Pictures in a second of the film (1/s).
    pub rate: f64,
    /// Simulated time over the time of the film (1).
    pub pace: f64,
}

impl Film {
    pub fn n_frames(&self) -> u64 {
        // A number too large for a whole number becomes the largest one.
        (((self.to - self.from) / self.pace * self.rate + 1e-9).floor() as u64).saturating_add(1)
    }

    fn time(&self, frame: u64) -> f64 {
        (self.from + frame as f64 * self.pace / self.rate).min(self.to)
    }

    /// Writes the film to `path`, which is there whole or not at all; a PNG shows the last time.
    /// `watch` receives the share that is done and says whether to go on.
    ///
    /// # Errors
    /// When it is stopped, or a file or ffmpeg fails.
    pub fn write(&self, drawing: &Drawing, path: &Path, format: Format, watch: impl Fn(f64) -> bool) -> Result<(), FilmError> {
        write_whole(path, |out| match format {
            Format::Png => png(&drawing.at(self.to), drawing.size(), out),
            Format::Gif => self.gif(drawing, out, &watch),
            Format::Mp4 => self.mp4(drawing, out, &watch),
        })
    }

    fn each(
        &self,
        drawing: &Drawing,
        watch: &impl Fn(f64) -> bool,
        mut take: impl FnMut(Vec<u8>) -> Result<(), FilmError>,
    ) -> Result<(), FilmError> {
        let n = self.n_frames();
        for frame in 0..n {
            if !watch(frame as f64 / n as f64) {
                return Err(FilmError::Interrupted);
            }
            take(drawing.at(self.time(frame)))?;
        }
        Ok(())
    }

    fn gif(&self, drawing: &Drawing, out: &mut impl Write, watch: &impl Fn(f64) -> bool) -> Result<(), FilmError> {
        let Size { width, height } = drawing.size();
        let (width, height) = (width as u16, height as u16);
        let mut encoder = Encoder::new(out, width, height, &[])?;
        encoder.set_repeat(Repeat::Infinite)?;
        self.each(drawing, watch, |mut pixels| {
            // Ten samples a colour are enough for lines on white.
            let mut frame = Frame::from_rgba_speed(width, height, &mut pixels, 20);
            frame.delay = (100.0 / self.rate).round() as u16;
            Ok(encoder.write_frame(&frame)?)
        })
    }

    /// ffmpeg writes MP4 only to files that it can seek in: a temporary one, which is then copied.
    fn mp4(&self, drawing: &Drawing, out: &mut impl Write, watch: &impl Fn(f64) -> bool) -> Result<(), FilmError> {
        let Size { width, height } = drawing.size();
        let mut file = tempfile::Builder::new().suffix(".mp4").tempfile()?;
        let mut command = Command::new("ffmpeg");
        command.args(["-y", "-loglevel", "error", "-f", "rawvideo", "-pix_fmt", "rgba", "-s", &format!("{width}x{height}")]);
        // Players want whole pairs of pixels and a common colour format.
        command.args(["-r", &self.rate.to_string(), "-i", "-", "-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2:color=white"]);
        command.args(["-c:v", "libx264", "-pix_fmt", "yuv420p", "-movflags", "+faststart"]).arg(file.path());
        let mut child = command.stdin(Stdio::piped()).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().map_err(FilmError::NoFfmpeg)?;
        let mut input = child.stdin.take().expect("it is piped");
        let sent = self.each(drawing, watch, |pixels| Ok(input.write_all(&pixels)?));
        drop(input);
        let output = child.wait_with_output()?;
        if let Err(FilmError::Interrupted) = sent {
            return sent;
        }
        if !output.status.success() {
            return Err(FilmError::Ffmpeg(String::from_utf8_lossy(&output.stderr).trim().to_owned()));
        }
        sent?;
        file.rewind()?;
        std::io::copy(&mut file, out)?;
        Ok(())
    }
}

fn png(pixels: &[u8], Size { width, height }: Size, out: &mut impl Write) -> Result<(), FilmError> {
    let mut encoder = png::Encoder::new(out, width, height);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.write_header()?.write_image_data(pixels)?;
    Ok(())
}
