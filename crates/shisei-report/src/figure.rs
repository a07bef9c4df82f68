//! A still figure as SVG: points, lines, error bars and bands over any x, log axes, equal scales, and points of
//! space seen from above and to one side. For what does not go along time; plots that do are in [`crate::plot`].

use std::fmt::Write as _;

use crate::escape::html;
use crate::plot::{Axis, Scale, Tone};

const WIDTH: f64 = 640.0;
const LEFT: f64 = 70.0;
const RIGHT: f64 = 16.0;
const TOP: f64 = 14.0;
const BOTTOM: f64 = 46.0;

/// What a figure shows.
#[derive(Clone, Debug)]
pub enum Item {
    /// Joined points.
    Line {
        /// x and y.
        points: Vec<[f64; 2]>,
        /// Colour.
        tone: Tone,
        /// Dashed.
        dashed: bool,
    },
    /// Dots, with a label each where there is one.
    Dots {
        /// x and y.
        points: Vec<[f64; 2]>,
        /// Colour.
        tone: Tone,
        /// Labels, as many as points or none.
        labels: Vec<String>,
    },
    /// Bars from low to high at x.
    Bars {
        /// x, low, high.
        points: Vec<[f64; 3]>,
        /// Colour.
        tone: Tone,
    },
    /// A shaded band between low and high.
    Band {
        /// x, low, high.
        points: Vec<[f64; 3]>,
        /// Colour.
        tone: Tone,
    },
}

/// A figure.
#[derive(Clone, Debug)]
pub struct Figure {
    /// Name for those who cannot see it.
    pub description: String,
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// The same scale on both axes.
    pub equal: bool,
    /// What is drawn, in this order.
    pub items: Vec<Item>,
    /// Names of the colours used.
    pub legend: Vec<(Tone, String)>,
}

struct Map {
    low: f64,
    high: f64,
    from: f64,
    to: f64,
    log: bool,
}

impl Map {
    fn value(&self, v: f64) -> f64 {
        let t = if self.log { log10(v) } else { v };
        self.from + (t - self.low) / (self.high - self.low) * (self.to - self.from)
    }

    fn ticks(&self) -> Vec<(f64, String)> {
        let span = self.high - self.low;
        if self.log {
            let step = (span / 8.0).ceil().max(1.0);
            let mut k = self.low.ceil();
            let mut ticks = Vec::new();
            while k <= self.high + 1e-9 {
                ticks.push((self.from + (k - self.low) / span * (self.to - self.from), format!("1e{k:.0}")));
                k += step;
            }
            return ticks;
        }
        let rough = span / 6.0;
        let mut unit = 1.0_f64;
        while unit > rough {
            unit /= 10.0;
        }
        while unit * 10.0 <= rough {
            unit *= 10.0;
        }
        let step = [1.0, 2.0, 5.0, 10.0].into_iter().map(|m| m * unit).find(|s| *s >= rough).unwrap_or(unit);
        let mut k = (self.low / step).ceil();
        let mut ticks = Vec::new();
        while k * step <= self.high + 1e-9 * span && ticks.len() < 20 {
            let v = k * step;
            let mut digits = 0;
            let mut s = step;
            while s < 0.999 && digits < 9 {
                s *= 10.0;
                digits += 1;
            }
            ticks.push((self.value(v), format!("{v:.digits$}")));
            k += 1.0;
        }
        ticks
    }
}

fn log10(v: f64) -> f64 {
    shisei_core::math::ln(v) / core::f64::consts::LN_10
}

impl Figure {
    fn extremes(&self) -> ([f64; 2], [f64; 2]) {
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        let log = [self.x.scale == Scale::Log, self.y.scale == Scale::Log];
        let mut take = |axis: usize, v: f64| {
            let v = if log[axis] { log10(v) } else { v };
            if v.is_finite() {
                low[axis] = low[axis].min(v);
                high[axis] = high[axis].max(v);
            }
        };
        for item in &self.items {
            match item {
                Item::Line { points, .. } | Item::Dots { points, .. } => {
                    for p in points {
                        take(0, p[0]);
                        take(1, p[1]);
                    }
                }
                Item::Bars { points, .. } | Item::Band { points, .. } => {
                    for p in points {
                        take(0, p[0]);
                        take(1, p[1]);
                        take(1, p[2]);
                    }
                }
            }
        }
        for axis in 0..2 {
            if !(low[axis].is_finite() && high[axis].is_finite()) {
                (low[axis], high[axis]) = (0.0, 1.0);
            }
            let pad = (0.05 * (high[axis] - low[axis])).max(1e-12 * high[axis].abs()).max(1e-300);
            low[axis] -= pad;
            high[axis] += pad;
        }
        (low, high)
    }

    /// The figure as an SVG element.
    pub fn to_svg(&self) -> String {
        let (mut low, mut high) = self.extremes();
        let inner = WIDTH - LEFT - RIGHT;
        let height = if self.equal { inner } else { 300.0 };
        if self.equal {
            let span = (high[0] - low[0]).max(high[1] - low[1]);
            for axis in 0..2 {
                let middle = 0.5 * (low[axis] + high[axis]);
                low[axis] = middle - 0.5 * span;
                high[axis] = middle + 0.5 * span;
            }
        }
        let mx =
            Map { low: low[0], high: high[0], from: LEFT, to: LEFT + inner, log: self.x.scale == Scale::Log };
        let my =
            Map { low: low[1], high: high[1], from: TOP + height, to: TOP, log: self.y.scale == Scale::Log };
        let total = TOP + height + BOTTOM;
        let mut out = format!(
            "<svg class=\"figure\" role=\"img\" aria-label=\"{}\" viewBox=\"0 0 {WIDTH} {total}\" \
             style=\"max-width:{WIDTH}px;width:100%;font:12px sans-serif\">",
            html(&self.description)
        );
        let bottom = TOP + height;
        for (x, text) in mx.ticks() {
            let _ = write!(
                out,
                "<path d=\"M{x:.1} {TOP}V{bottom:.1}\" stroke=\"currentColor\" stroke-opacity=\".15\"/>\
                 <text x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"middle\" fill=\"currentColor\">{text}</text>",
                bottom + 16.0
            );
        }
        for (y, text) in my.ticks() {
            let _ = write!(
                out,
                "<path d=\"M{LEFT} {y:.1}H{:.1}\" stroke=\"currentColor\" stroke-opacity=\".15\"/>\
                 <text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\" fill=\"currentColor\">{text}</text>",
                LEFT + inner,
                LEFT - 6.0,
                y + 4.0
            );
        }
        let _ = write!(
            out,
            "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\" fill=\"currentColor\">{}</text>\
             <text transform=\"translate(14 {:.1}) rotate(-90)\" text-anchor=\"middle\" fill=\"currentColor\">{}</text>",
            LEFT + 0.5 * inner,
            total - 10.0,
            html(&self.x.caption()),
            TOP + 0.5 * height,
            html(&self.y.caption())
        );
        for item in &self.items {
            draw(&mut out, item, &mx, &my);
        }
        for (i, (tone, name)) in self.legend.iter().enumerate() {
            let y = TOP + 14.0 + 16.0 * i as f64;
            let _ = write!(
                out,
                "<rect x=\"{:.1}\" y=\"{:.1}\" width=\"10\" height=\"10\" fill=\"{}\"/>\
                 <text x=\"{:.1}\" y=\"{:.1}\" fill=\"currentColor\">{}</text>",
                LEFT + 8.0,
                y - 9.0,
                colour(*tone),
                LEFT + 24.0,
                y,
                html(name)
            );
        }
        out.push_str("</svg>");
        out
    }
}

fn colour(tone: Tone) -> &'static str {
    match tone {
        Tone::X => "#d55e00",
        Tone::Y => "#009e73",
        Tone::Z => "#0072b2",
        Tone::Plain => "currentColor",
    }
}

fn draw(out: &mut String, item: &Item, mx: &Map, my: &Map) {
    let at = |x: f64, y: f64| {
        let p = [mx.value(x), my.value(y)];
        (p[0].is_finite() && p[1].is_finite()).then_some(p)
    };
    match item {
        Item::Line { points, tone, dashed } => {
            let mut d = String::new();
            let mut joined = false;
            for p in points {
                if let Some([x, y]) = at(p[0], p[1]) {
                    let _ = write!(d, "{}{x:.1} {y:.1}", if joined { 'L' } else { 'M' });
                    joined = true;
                } else {
                    joined = false;
                }
            }
            let dash = if *dashed { " stroke-dasharray=\"5 4\"" } else { "" };
            let _ = write!(
                out,
                "<path d=\"{d}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.5\"{dash}/>",
                colour(*tone)
            );
        }
        Item::Dots { points, tone, labels } => {
            for (i, p) in points.iter().enumerate() {
                let Some([x, y]) = at(p[0], p[1]) else { continue };
                let _ =
                    write!(out, "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3\" fill=\"{}\"/>", colour(*tone));
                if let Some(label) = labels.get(i) {
                    let _ = write!(
                        out,
                        "<text x=\"{:.1}\" y=\"{:.1}\" fill=\"currentColor\">{}</text>",
                        x + 5.0,
                        y - 5.0,
                        html(label)
                    );
                }
            }
        }
        Item::Bars { points, tone } => {
            for p in points {
                if let (Some([x, a]), Some([_, b])) = (at(p[0], p[1]), at(p[0], p[2])) {
                    let _ = write!(
                        out,
                        "<path d=\"M{x:.1} {a:.1}V{b:.1}M{:.1} {a:.1}h6M{:.1} {b:.1}h6\" stroke=\"{}\" fill=\"none\"/>",
                        x - 3.0,
                        x - 3.0,
                        colour(*tone)
                    );
                }
            }
        }
        Item::Band { points, tone } => {
            let low = points.iter().filter_map(|p| at(p[0], p[1]));
            let high = points.iter().rev().filter_map(|p| at(p[0], p[2]));
            let d: Vec<String> = low.chain(high).map(|p| format!("{:.1} {:.1}", p[0], p[1])).collect();
            if d.len() > 2 {
                let _ = write!(
                    out,
                    "<path d=\"M{}Z\" fill=\"{}\" fill-opacity=\".2\" stroke=\"none\"/>",
                    d.join("L"),
                    colour(*tone)
                );
            }
        }
    }
}

/// A point of space on the paper, seen from in front at 30° above and 30° to the left.
pub fn project(p: [f64; 3]) -> [f64; 2] {
    const COS: f64 = 0.866_025_403_784_438_6;
    let (x, y) = (COS * p[0] - 0.5 * p[1], 0.5 * p[0] + COS * p[1]);
    [x, COS * p[2] + 0.5 * y]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn figure(scale: Scale, points: Vec<[f64; 2]>) -> String {
        let axis = |label: &str| Axis { label: label.to_owned(), unit: "s".to_owned(), scale };
        Figure {
            description: "a <b>".to_owned(),
            x: axis("x"),
            y: axis("y"),
            equal: false,
            items: vec![Item::Line { points, tone: Tone::X, dashed: false }],
            legend: vec![(Tone::X, "x & y".to_owned())],
        }
        .to_svg()
    }

    #[test]
    fn text_is_escaped_and_numbers_are_finite() {
        let svg = figure(Scale::Linear, vec![[0.0, 1.0], [f64::NAN, 2.0], [3.0, 4.0]]);
        assert!(svg.contains("a &lt;b&gt;") && svg.contains("x &amp; y"));
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
        // the hole breaks the line
        assert!(svg.matches('M').count() > 4);
    }

    #[test]
    fn log_axes_leave_out_what_they_cannot_show() {
        let svg = figure(Scale::Log, vec![[0.0, 1.0], [0.01, 1e-5], [100.0, 1e-3]]);
        assert!(svg.contains("1e-2") && svg.contains("1e2") && !svg.contains("NaN"));
        assert!(!figure(Scale::Linear, vec![]).contains("NaN"));
        assert!(!figure(Scale::Linear, vec![[5.0, 5.0]]).contains("NaN"));
    }
}
