//! Plots as a PNG: one above another, with title, axes, legend and shaded spans.

mod canvas;
mod font;
mod ticks;

use shisei_core::Lang;

use crate::error::{Error, Result};
use crate::plot::{DrawnSeries, Mark, Plot, Scale, SpanKind, Tone};
use crate::text::Text;
use canvas::{Anchor, Canvas, Frame, Rgba};

const WHITE: Rgba = [255, 255, 255, 255];
const INK: Rgba = [27, 35, 48, 255];
const QUIET: Rgba = [89, 98, 115, 255];
const GRID: Rgba = [226, 229, 234, 255];

/// A PNG of plots one above another. Sizes are pixels, 320×200 to 16000×16000; lines and letters grow with
/// the picture. Characters that the font has not (it knows Latin, Greek, kana and the common kanji) show as
/// a box.
pub fn render(title: &str, plots: &[&Plot<'_>], lang: Lang, width: u32, height: u32) -> Result<Vec<u8>> {
    if !(320..=16_000).contains(&width) || !(200..=16_000).contains(&height) {
        return Err(Error::ImageSize { width, height });
    }
    let mut canvas = Canvas::new(width, height, WHITE).ok_or(Error::ImageSize { width, height })?;
    let text = Text::of(lang);
    let (w, h) = (width as f32, height as f32);
    let em = (w / 75.0).min(h / 34.0).max(9.0);
    let title_size = 1.45 * em;
    let title = font::fitted(title, title_size, w - 3.0 * em);
    canvas.text(&title, [1.5 * em, 0.7 * em + title_size], title_size, INK, Anchor::Left);
    let top = title_size + 1.5 * em;
    let each = (h - top) / plots.len().max(1) as f32;
    for (k, plot) in plots.iter().enumerate() {
        let area = Frame { left: 0.0, top: top + k as f32 * each, width: w, height: each };
        Panel { plot, text, em, area }.draw(&mut canvas);
    }
    canvas.into_png()
}

struct Panel<'p, 'a> {
    plot: &'p Plot<'a>,
    text: Text,
    em: f32,
    area: Frame,
}

impl Panel<'_, '_> {
    fn draw(&self, canvas: &mut Canvas) {
        let em = self.em;
        let frame = Frame {
            left: self.area.left + 5.6 * em,
            top: self.area.top + 2.2 * em,
            width: (self.area.width - 7.4 * em).max(1.0),
            height: (self.area.height - 6.4 * em).max(1.0),
        };
        // a few rows a pixel are all one can see
        let drawn = self.plot.drawn((frame.width as usize * 8).max(2_000));
        let x_log = self.plot.x_axis.scale == Scale::Log;
        let y_log = self.plot.y_axis.scale == Scale::Log;
        let xs = || drawn.x.iter().copied();
        let ys = || drawn.series.iter().flat_map(|s| s.y.iter().map(|&y| f64::from(y)));
        let x = ticks::Range::of(xs(), x_log, 0.0);
        let y = ticks::Range::of(ys(), y_log, 0.05).in_degrees(self.plot.y_axis.unit == "°");
        let to_x = |v: f64| frame.left + frame.width * x.share(v) as f32;
        let to_y = |v: f64| frame.top + frame.height * (1.0 - y.share(v)) as f32;

        self.draw_spans(canvas, frame, &to_x);
        let size = 0.95 * em;
        for tick in x.ticks((frame.width / (6.0 * em)) as usize) {
            let at = to_x(tick.value);
            canvas.line(&[[at, frame.top], [at, frame.bottom()]], 1.0, GRID);
            canvas.text(&tick.label, [at, frame.bottom() + 1.35 * em], size, QUIET, Anchor::Middle);
        }
        for tick in y.ticks((frame.height / (2.6 * em)) as usize) {
            let at = to_y(tick.value);
            canvas.line(&[[frame.left, at], [frame.right(), at]], 1.0, GRID);
            let place = [frame.left - 0.6 * em, at + 0.35 * size];
            canvas.text(&tick.label, place, size, QUIET, Anchor::Right);
        }
        canvas.outline(frame, 1.0, QUIET);
        let x_name = self.plot.x_axis.caption();
        let below = [frame.left + 0.5 * frame.width, frame.bottom() + 3.0 * em];
        canvas.text(&x_name, below, em, INK, Anchor::Middle);
        let beside = [self.area.left + 1.6 * em, frame.top + 0.5 * frame.height];
        canvas.text_upwards(&self.plot.y_axis.caption(), beside, em, INK);

        let to_pixel = |k: usize, value: f64| {
            drawn.x.get(k).map(|&t| [to_x(t), to_y(value)]).filter(|p| p[0].is_finite() && p[1].is_finite())
        };
        for (series, drawn_series) in self.plot.series.iter().zip(&drawn.series) {
            draw_band(canvas, frame, drawn_series, &to_pixel, tone(series.tone, 45));
        }
        for (series, drawn_series) in self.plot.series.iter().zip(&drawn.series) {
            let colour = tone(series.tone, 255);
            match series.mark {
                Mark::Points => {
                    for (k, &value) in drawn_series.y.iter().enumerate() {
                        if let Some(at) = to_pixel(k, f64::from(value)) {
                            canvas.dot(at, 0.22 * em, colour);
                        }
                    }
                }
                Mark::Line => {
                    for run in runs(drawn_series, |k| to_pixel(k, f64::from(drawn_series.y[k]))) {
                        canvas.clipped_line(frame, &run, (0.13 * em).max(1.6), colour);
                    }
                }
            }
        }
        self.draw_legend(canvas, frame);
    }

    fn draw_spans(&self, canvas: &mut Canvas, frame: Frame, to_x: &dyn Fn(f64) -> f32) {
        for span in &self.plot.spans {
            let left = to_x(span.from).clamp(frame.left, frame.right());
            let right = to_x(span.to).clamp(frame.left, frame.right());
            if right < left || left.is_nan() || right.is_nan() {
                continue;
            }
            let shade = Frame { left, top: frame.top, width: (right - left).max(1.0), height: frame.height };
            canvas.fill(shade, span_colour(span.kind));
            if span.kind == SpanKind::Rest {
                canvas.fill(Frame { height: 0.28 * self.em, ..shade }, [138, 150, 170, 255]);
            }
        }
    }

    fn draw_legend(&self, canvas: &mut Canvas, frame: Frame) {
        let em = self.em;
        let base = frame.top - 0.75 * em;
        let mut at = frame.left;
        for series in &self.plot.series {
            let colour = tone(series.tone, 255);
            canvas.line(&[[at, base - 0.33 * em], [at + 1.6 * em, base - 0.33 * em]], 0.22 * em, colour);
            at += 2.0 * em;
            at += canvas.text(&series.name, [at, base], em, INK, Anchor::Left) + 1.6 * em;
        }
        let kinds = [
            (SpanKind::Rest, self.text.rest),
            (SpanKind::Gap, self.text.gap),
            (SpanKind::Poor, self.text.poor),
        ];
        for (kind, name) in kinds {
            if self.plot.spans.iter().any(|s| s.kind == kind) {
                let swatch = Frame { left: at, top: base - 0.8 * em, width: 1.6 * em, height: 0.9 * em };
                canvas.fill(swatch, span_colour(kind));
                canvas.outline(swatch, 1.0, GRID);
                at += 2.0 * em;
                at += canvas.text(name, [at, base], em, INK, Anchor::Left) + 1.6 * em;
            }
        }
        if self.plot.series.iter().any(|s| s.sigma.is_some()) {
            let swatch = Frame { left: at, top: base - 0.8 * em, width: 1.6 * em, height: 0.9 * em };
            canvas.fill(swatch, tone(Tone::Z, 70));
            canvas.text(self.text.band, [at + 2.0 * em, base], em, INK, Anchor::Left);
        }
    }
}

/// Unbroken stretches of a series, as what `pick` makes of each row.
fn runs<T>(series: &DrawnSeries, pick: impl Fn(usize) -> Option<T>) -> Vec<Vec<T>> {
    let mut breaks = series.breaks.iter().map(|&k| k as usize).peekable();
    let mut out = Vec::new();
    let mut run = Vec::new();
    for k in 0..series.y.len() {
        let broken = breaks.next_if_eq(&k).is_some();
        let point = pick(k);
        if (broken || point.is_none()) && !run.is_empty() {
            out.push(std::mem::take(&mut run));
        }
        run.extend(point);
    }
    if !run.is_empty() {
        out.push(run);
    }
    out
}

fn draw_band(
    canvas: &mut Canvas,
    frame: Frame,
    series: &DrawnSeries,
    to_pixel: &dyn Fn(usize, f64) -> Option<[f32; 2]>,
    colour: Rgba,
) {
    let Some(sigma) = &series.sigma else { return };
    let edges = |k: usize| {
        let (y, s) = (f64::from(*series.y.get(k)?), f64::from(*sigma.get(k)?));
        Some((to_pixel(k, y + s)?, to_pixel(k, y - s)?))
    };
    for run in runs(series, edges) {
        let upper = run.iter().map(|(high, _)| *high);
        let lower = run.iter().rev().map(|(_, low)| *low);
        let clamp = |[x, y]: [f32; 2]| [x, y.clamp(frame.top, frame.bottom())];
        let polygon: Vec<[f32; 2]> = upper.chain(lower).map(clamp).collect();
        canvas.polygon(&polygon, colour);
    }
}

fn tone(tone: Tone, alpha: u8) -> Rgba {
    let [r, g, b] = match tone {
        Tone::X => [196, 78, 0],
        Tone::Y => [0, 128, 93],
        Tone::Z => [0, 105, 176],
        Tone::Plain => [27, 35, 48],
    };
    [r, g, b, alpha]
}

fn span_colour(kind: SpanKind) -> Rgba {
    match kind {
        SpanKind::Rest => [90, 105, 130, 34],
        SpanKind::Gap => [90, 90, 90, 80],
        SpanKind::Poor => [230, 159, 0, 60],
    }
}
