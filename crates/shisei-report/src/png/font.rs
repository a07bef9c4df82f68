//! The embedded font (a subset of Noto Sans CJK JP, SIL Open Font License): text as outlines.

use std::sync::LazyLock;

use tiny_skia::{Path, PathBuilder};
use ttf_parser::{Face, GlyphId, OutlineBuilder};

static FACE: LazyLock<Option<Face<'static>>> =
    LazyLock::new(|| Face::parse(include_bytes!("../../assets/noto-sans-cjk-jp-subset.otf"), 0).ok());

/// The outline of a text with its base line at y = 0, starting at x = 0.
pub(super) fn path(text: &str, size: f32) -> Option<Path> {
    let face = FACE.as_ref()?;
    let scale = size / f32::from(face.units_per_em());
    let mut pen = Pen { builder: PathBuilder::new(), x: 0.0, scale };
    for c in text.chars() {
        let glyph = glyph_of(face, c);
        face.outline_glyph(glyph, &mut pen);
        pen.x += advance(face, glyph) * scale;
    }
    pen.builder.finish()
}

/// The width of a text.
pub(super) fn width(text: &str, size: f32) -> f32 {
    let Some(face) = FACE.as_ref() else { return 0.0 };
    let scale = size / f32::from(face.units_per_em());
    text.chars().map(|c| advance(face, glyph_of(face, c)) * scale).sum()
}

/// The text, cut with "…" where it is wider than `room`.
pub(super) fn fitted(text: &str, size: f32, room: f32) -> String {
    if width(text, size) <= room {
        return text.to_owned();
    }
    let mut cut = String::new();
    let mut used = width("…", size);
    for c in text.chars() {
        used += width(c.encode_utf8(&mut [0; 4]), size);
        if used > room {
            break;
        }
        cut.push(c);
    }
    cut + "…"
}

fn glyph_of(face: &Face<'_>, c: char) -> GlyphId {
    face.glyph_index(c).unwrap_or(GlyphId(0)) // glyph 0 is the box of a missing character
}

fn advance(face: &Face<'_>, glyph: GlyphId) -> f32 {
    f32::from(face.glyph_hor_advance(glyph).unwrap_or(face.units_per_em() / 2))
}

struct Pen {
    builder: PathBuilder,
    x: f32,
    scale: f32,
}

impl Pen {
    fn place(&self, x: f32, y: f32) -> (f32, f32) {
        (self.x + x * self.scale, -y * self.scale)
    }
}

impl OutlineBuilder for Pen {
    fn move_to(&mut self, x: f32, y: f32) {
        let (x, y) = self.place(x, y);
        self.builder.move_to(x, y);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        let (x, y) = self.place(x, y);
        self.builder.line_to(x, y);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        let ((x1, y1), (x, y)) = (self.place(x1, y1), self.place(x, y));
        self.builder.quad_to(x1, y1, x, y);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        let (x1, y1) = self.place(x1, y1);
        let (x2, y2) = self.place(x2, y2);
        let (x, y) = self.place(x, y);
        self.builder.cubic_to(x1, y1, x2, y2, x, y);
    }

    fn close(&mut self) {
        self.builder.close();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::text::Text;
    use shisei_core::Lang;

    #[test]
    fn the_font_has_every_character_of_the_pictures() {
        let face = FACE.as_ref().expect("the embedded font parses");
        for lang in [Lang::En, Lang::Ja] {
            let t = Text::of(lang);
            let words = [t.yaw, t.pitch, t.roll, t.rest, t.gap, t.poor, t.band, t.orientation, t.angle];
            let more = [t.acceleration, t.angular_rate, t.angular_rate_axis, t.time, t.seconds];
            let all = words.iter().chain(&more).flat_map(|w| w.chars());
            for c in all.chain("0123456789−.…()°/²μ％骨盤姿勢 abcXYZ".chars()) {
                assert!(face.glyph_index(c).is_some(), "{c} is missing");
            }
        }
        assert!(width("姿勢", 10.0) > 15.0);
    }
}
