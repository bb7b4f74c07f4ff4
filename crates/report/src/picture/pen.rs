//! Lines, areas, arrows and letters on pixels.

use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster, get_raster_width};
use tiny_skia::{Color, FillRule, LineCap, LineJoin, Paint, PathBuilder, Pixmap, PixmapPaint, Rect, Stroke, StrokeDash, Transform};

use cohaul::math::Vec2;

/// Height of letters.
const HEIGHT: RasterHeight = RasterHeight::Size16;

/// Red, green, blue and opacity, each from 0 to 255.
pub type Rgba = [u8; 4];

/// How a line is drawn: its width (px), and the lengths of dash and gap (px), if it is dashed.
#[derive(Clone, Copy, Debug)]
pub struct Line {
    pub color: Rgba,
    pub width: f64,
    pub dash: Option<[f64; 2]>,
}

impl Line {
    pub fn new(color: Rgba, width: f64) -> Self {
        Self { color, width, dash: None }
    }

    pub fn dashed(self, dash: f64, gap: f64) -> Self {
        Self { dash: Some([dash, gap]), ..self }
    }
}

/// An opaque picture that is being drawn. Places are in px, with y downwards.
pub struct Pen {
    pixels: Pixmap,
}

/// Parts of a shape: closed polygons, open lines and discs.
#[derive(Default)]
pub struct Shape {
    path: PathBuilder,
}

impl Shape {
    pub fn line(points: impl IntoIterator<Item = Vec2>) -> Self {
        let mut shape = Self::default();
        shape.add_line(points);
        shape
    }

    pub fn disc(centre: Vec2, radius: f64) -> Self {
        let mut shape = Self::default();
        shape.add_disc(centre, radius);
        shape
    }

    pub fn add_line(&mut self, points: impl IntoIterator<Item = Vec2>) {
        for (at, point) in points.into_iter().enumerate() {
            let (x, y) = (point.x as f32, point.y as f32);
            if at == 0 { self.path.move_to(x, y) } else { self.path.line_to(x, y) }
        }
    }

    pub fn add_polygon(&mut self, points: impl IntoIterator<Item = Vec2>) {
        self.add_line(points);
        self.path.close();
    }

    pub fn add_disc(&mut self, centre: Vec2, radius: f64) {
        self.path.push_circle(centre.x as f32, centre.y as f32, radius as f32);
    }
}

fn paint<'a>([r, g, b, a]: Rgba) -> Paint<'a> {
    let mut paint = Paint { anti_alias: true, ..Paint::default() };
    paint.set_color_rgba8(r, g, b, a);
    paint
}

impl Pen {
    /// A white picture of this size (px).
    ///
    /// # Panics
    /// When a side is zero or above what fits in memory.
    pub fn new(width: u32, height: u32) -> Self {
        let mut pixels = Pixmap::new(width, height).expect("the size was checked");
        pixels.fill(Color::WHITE);
        Self { pixels }
    }

    /// Rows of pixels, four bytes each.
    pub fn into_rgba(self) -> Vec<u8> {
        // Opaque colours are the same with and without premultiplication.
        self.pixels.take()
    }

    /// Puts another picture with its upper left corner at a place.
    pub fn put(&mut self, other: &Pen, x: u32, y: u32) {
        self.pixels.draw_pixmap(x as i32, y as i32, other.pixels.as_ref(), &PixmapPaint::default(), Transform::identity(), None);
    }

    pub fn fill(&mut self, shape: &Shape, color: Rgba) {
        if let Some(path) = shape.path.clone().finish() {
            self.pixels.fill_path(&path, &paint(color), FillRule::Winding, Transform::identity(), None);
        }
    }

    pub fn stroke(&mut self, shape: &Shape, line: Line) {
        let Some(path) = shape.path.clone().finish() else { return };
        let dash = line.dash.and_then(|[dash, gap]| StrokeDash::new(vec![dash as f32, gap as f32], 0.0));
        let stroke = Stroke { width: line.width as f32, line_cap: LineCap::Round, line_join: LineJoin::Round, dash, ..Stroke::default() };
        self.pixels.stroke_path(&path, &paint(line.color), &stroke, Transform::identity(), None);
    }

    pub fn square(&mut self, centre: Vec2, half: f64, color: Rgba) {
        let (x, y, side) = ((centre.x - half) as f32, (centre.y - half) as f32, 2.0 * half as f32);
        if let Some(rect) = Rect::from_xywh(x, y, side, side) {
            self.pixels.fill_rect(rect, &paint(color), Transform::identity(), None);
        }
    }

    /// An arrow from a place by a vector (px).
    pub fn arrow(&mut self, from: Vec2, by: Vec2, color: Rgba, width: f64) {
        let length = by.norm();
        if length < 2.0 {
            return;
        }
        let (along, tip) = (by / length, from + by);
        let across = Vec2::new(-along.y, along.x);
        let head = (0.5 * length).min(4.0 * width);
        self.stroke(&Shape::line([from, tip - head * along]), Line::new(color, width));
        let mut shape = Shape::default();
        shape.add_polygon([tip, tip - head * along + 0.5 * head * across, tip - head * along - 0.5 * head * across]);
        self.fill(&shape, color);
    }

    /// Text that begins at a place, whose height is that of its baseline.
    pub fn text(&mut self, text: &str, x: f64, baseline: f64, color: Rgba) {
        let (width, stride) = (self.pixels.width() as i64, self.pixels.width() as usize * 4);
        let (mut left, top) = (x as i64, baseline as i64 - HEIGHT.val() as i64 + 3);
        for letter in text.chars() {
            // A letter that the font has not is a question mark.
            let Some(raster) = get_raster(letter, FontWeight::Regular, HEIGHT).or_else(|| get_raster('?', FontWeight::Regular, HEIGHT))
            else {
                continue;
            };
            for (row, line) in raster.rows().enumerate() {
                for (column, strength) in line.iter().enumerate() {
                    let (px, py) = (left + column as i64, top + row as i64);
                    if *strength > 0 && px >= 0 && px < width && py >= 0 && py < i64::from(self.pixels.height()) {
                        let at = py as usize * stride + px as usize * 4;
                        blend(&mut self.pixels.data_mut()[at..at + 4], color, *strength);
                    }
                }
            }
            left += raster.width() as i64;
        }
    }

    /// Width of a text (px).
    pub fn width_of(text: &str) -> f64 {
        (text.chars().count() * get_raster_width(FontWeight::Regular, HEIGHT)) as f64
    }
}

/// Lays a colour over an opaque pixel.
fn blend(pixel: &mut [u8], color: Rgba, strength: u8) {
    let share = u32::from(strength) * u32::from(color[3]) / 255;
    for (below, above) in pixel.iter_mut().zip(&color[..3]) {
        *below = ((u32::from(*below) * (255 - share) + u32::from(*above) * share) / 255) as u8;
    }
}
