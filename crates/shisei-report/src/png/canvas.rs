//! Lines, areas and letters on a raster; pixels from the top left corner.

use tiny_skia::{
    FillRule, LineCap, LineJoin, Mask, Paint, Path, PathBuilder, Pixmap, Rect, Stroke, Transform,
};

use super::font;
use crate::error::{Error, Result};

/// Red, green, blue, opacity.
pub(super) type Rgba = [u8; 4];

/// A rectangle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    pub left: f32,
    pub top: f32,
    pub width: f32,
    pub height: f32,
}

impl Frame {
    pub fn right(self) -> f32 {
        self.left + self.width
    }

    pub fn bottom(self) -> f32 {
        self.top + self.height
    }

    fn path(self) -> Option<Path> {
        Rect::from_xywh(self.left, self.top, self.width, self.height).map(PathBuilder::from_rect)
    }
}

/// Which point of a text is given.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Anchor {
    Left,
    Middle,
    Right,
}

/// In each picture's `Software` text: how `shisei` knows its own pictures.
const SOFTWARE: &str = concat!("shisei ", env!("CARGO_PKG_VERSION"));

pub(super) struct Canvas {
    pixmap: Pixmap,
}

impl Canvas {
    pub fn new(width: u32, height: u32, back: Rgba) -> Option<Self> {
        let mut pixmap = Pixmap::new(width, height)?;
        let [r, g, b, a] = back;
        pixmap.fill(tiny_skia::Color::from_rgba8(r, g, b, a));
        Some(Canvas { pixmap })
    }

    pub fn into_png(self) -> Result<Vec<u8>> {
        let (width, height) = (self.pixmap.width(), self.pixmap.height());
        let encode = |error: png::EncodingError| Error::Encode(error.to_string());
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, width, height);
        encoder.set_color(png::ColorType::Rgba);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.add_text_chunk("Software".to_owned(), SOFTWARE.to_owned()).map_err(encode)?;
        let mut writer = encoder.write_header().map_err(encode)?;
        // The canvas is opaque, so that premultiplied and straight colours are the same.
        writer.write_image_data(self.pixmap.data()).map_err(encode)?;
        writer.finish().map_err(encode)?;
        Ok(bytes)
    }

    pub fn fill(&mut self, frame: Frame, colour: Rgba) {
        if let Some(path) = frame.path() {
            self.fill_path(&path, colour, Transform::identity());
        }
    }

    pub fn outline(&mut self, frame: Frame, width: f32, colour: Rgba) {
        if let Some(path) = frame.path() {
            self.stroke(&path, width, colour, None);
        }
    }

    pub fn line(&mut self, points: &[[f32; 2]], width: f32, colour: Rgba) {
        if let Some(path) = path_through(points, false) {
            self.stroke(&path, width, colour, None);
        }
    }

    /// A line of which only the part inside the frame shows; a single point shows as a dot.
    pub fn clipped_line(&mut self, frame: Frame, points: &[[f32; 2]], width: f32, colour: Rgba) {
        if let [only] = points {
            self.dot(*only, width, colour);
            return;
        }
        let mask = Mask::new(self.pixmap.width(), self.pixmap.height()).and_then(|mut mask| {
            mask.fill_path(&frame.path()?, FillRule::Winding, true, Transform::identity());
            Some(mask)
        });
        if let Some(path) = path_through(points, false) {
            self.stroke(&path, width, colour, mask.as_ref());
        }
    }

    pub fn polygon(&mut self, points: &[[f32; 2]], colour: Rgba) {
        if let Some(path) = path_through(points, true) {
            self.fill_path(&path, colour, Transform::identity());
        }
    }

    pub fn dot(&mut self, at: [f32; 2], radius: f32, colour: Rgba) {
        if let Some(path) = PathBuilder::from_circle(at[0], at[1], radius) {
            self.fill_path(&path, colour, Transform::identity());
        }
    }

    /// Draws a text on its base line and tells its width.
    pub fn text(&mut self, text: &str, at: [f32; 2], size: f32, colour: Rgba, anchor: Anchor) -> f32 {
        let width = font::width(text, size);
        let left = match anchor {
            Anchor::Left => at[0],
            Anchor::Middle => at[0] - 0.5 * width,
            Anchor::Right => at[0] - width,
        };
        if let Some(path) = font::path(text, size) {
            self.fill_path(&path, colour, Transform::from_translate(left, at[1]));
        }
        width
    }

    /// A text that reads from bottom to top, its middle at a point.
    pub fn text_upwards(&mut self, text: &str, at: [f32; 2], size: f32, colour: Rgba) {
        let half = 0.5 * font::width(text, size);
        if let Some(path) = font::path(text, size) {
            let turn = Transform::from_row(0.0, -1.0, 1.0, 0.0, at[0], at[1] + half);
            self.fill_path(&path, colour, turn);
        }
    }

    fn fill_path(&mut self, path: &Path, colour: Rgba, place: Transform) {
        self.pixmap.fill_path(path, &paint(colour), FillRule::Winding, place, None);
    }

    fn stroke(&mut self, path: &Path, width: f32, colour: Rgba, mask: Option<&Mask>) {
        let stroke =
            Stroke { width, line_cap: LineCap::Butt, line_join: LineJoin::Bevel, ..Stroke::default() };
        self.pixmap.stroke_path(path, &paint(colour), &stroke, Transform::identity(), mask);
    }
}

fn paint(colour: Rgba) -> Paint<'static> {
    let mut paint = Paint::default();
    let [r, g, b, a] = colour;
    paint.set_color_rgba8(r, g, b, a);
    paint.anti_alias = true;
    paint
}

fn path_through(points: &[[f32; 2]], closed: bool) -> Option<Path> {
    let mut builder = PathBuilder::new();
    let (first, rest) = points.split_first()?;
    builder.move_to(first[0], first[1]);
    for [x, y] in rest {
        builder.line_to(*x, *y);
    }
    if closed {
        builder.close();
    }
    builder.finish()
}
