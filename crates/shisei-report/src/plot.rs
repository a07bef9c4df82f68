//! A plot as data: axes, series, shaded spans. HTML and PNG draw the same [`Drawn`] form of it.

use crate::column::Column;
use crate::decimate;
use crate::encode;
use crate::escape::{json_number, json_string};

/// Most spans of one kind that are drawn; more are joined with their nearest neighbours.
pub const MAX_SPANS: usize = 1_000;

/// What an axis shows.
#[derive(Clone, Debug)]
pub struct Axis {
    /// What it is: "Time", "Acceleration".
    pub label: String,
    /// Unit, may be empty.
    pub unit: String,
    /// Linear, or decades.
    pub scale: Scale,
}

impl Axis {
    /// A linear axis.
    pub fn linear(label: &str, unit: &str) -> Self {
        Axis { label: label.to_owned(), unit: unit.to_owned(), scale: Scale::Linear }
    }

    /// "label (unit)".
    pub fn caption(&self) -> String {
        if self.unit.is_empty() { self.label.clone() } else { format!("{} ({})", self.label, self.unit) }
    }
}

/// Spacing of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// Equal steps.
    Linear,
    /// Equal ratios; values that are not above zero are not drawn.
    Log,
}

/// Colour of a series: an axis keeps its colour in every plot and in the 3-D view. The three are apart
/// for every kind of colour vision (Okabe and Ito's set).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tone {
    /// x, and roll about it: vermilion.
    X,
    /// y, and pitch about it: bluish green.
    Y,
    /// z, and yaw about it: blue.
    Z,
    /// Anything else: the text's own colour.
    Plain,
}

impl Tone {
    /// Name in the page's data and style sheet.
    pub(crate) fn key(self) -> &'static str {
        match self {
            Tone::X => "x",
            Tone::Y => "y",
            Tone::Z => "z",
            Tone::Plain => "plain",
        }
    }
}

/// How a series is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mark {
    /// A line.
    Line,
    /// Points only.
    Points,
}

/// One line or cloud of points.
#[derive(Clone, Debug)]
pub struct Series<'a> {
    /// Name in the legend.
    pub name: String,
    /// Colour.
    pub tone: Tone,
    /// Line or points.
    pub mark: Mark,
    /// Values, one a row of the plot's x.
    pub y: Column<'a>,
    /// Half width of the band around the values, 1 sigma; in the unit of `y`.
    pub sigma: Option<Column<'a>>,
    /// What values and sigmas are multiplied with before they are shown (180/π for degrees).
    pub factor: f64,
    /// Shown values that wrap (360 for degrees) are not joined across the wrap.
    pub period: Option<f64>,
}

/// Why a span of x is shaded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SpanKind {
    /// At rest.
    Rest,
    /// No samples.
    Gap,
    /// The estimator does not trust its own result.
    Poor,
}

impl SpanKind {
    pub(crate) fn key(self) -> &'static str {
        match self {
            SpanKind::Rest => "rest",
            SpanKind::Gap => "gap",
            SpanKind::Poor => "poor",
        }
    }
}

/// A shaded span of x.
#[derive(Clone, Copy, Debug)]
pub struct Span {
    /// Start, in the unit of x.
    pub from: f64,
    /// End.
    pub to: f64,
    /// Why.
    pub kind: SpanKind,
}

/// Shaded spans of one kind, joined where there are more than [`MAX_SPANS`].
pub fn spans(intervals: &[(f64, f64)], kind: SpanKind) -> Vec<Span> {
    decimate::merge_spans(intervals, MAX_SPANS)
        .into_iter()
        .map(|(from, to)| Span { from, to, kind })
        .collect()
}

/// A plot with one x column and any number of series over it.
#[derive(Clone, Debug)]
pub struct Plot<'a> {
    /// Heading over the plot.
    pub heading: String,
    /// Name of the picture for those who cannot see it.
    pub description: String,
    /// Horizontal axis.
    pub x_axis: Axis,
    /// Vertical axis.
    pub y_axis: Axis,
    /// x of every row, not decreasing.
    pub x: Column<'a>,
    /// What is drawn.
    pub series: Vec<Series<'a>>,
    /// What is shaded behind it.
    pub spans: Vec<Span>,
}

/// The rows of a plot that are drawn, scaled and with the places where a line breaks.
#[derive(Clone, Debug)]
pub struct Drawn {
    /// x of each row.
    pub x: Vec<f64>,
    /// One a series.
    pub series: Vec<DrawnSeries>,
    /// Rows of the plot before any were left out.
    pub rows_before: usize,
}

/// The drawn rows of a series.
#[derive(Clone, Debug)]
pub struct DrawnSeries {
    /// Shown values; NaN where there is nothing to draw.
    pub y: Vec<f32>,
    /// Half width of the band.
    pub sigma: Option<Vec<f32>>,
    /// Rows that are not joined to the row before: after a gap or a wrap.
    pub breaks: Vec<u32>,
}

impl Plot<'_> {
    /// Bytes that one row takes in the page.
    pub(crate) fn bytes_per_row(&self) -> usize {
        let columns: usize = self.series.iter().map(|s| 2 + usize::from(s.sigma.is_some())).sum::<usize>();
        (8 + 4 * columns) * 4 / 3 + 1
    }

    /// The plot with at most about `max_rows` rows.
    pub fn drawn(&self, max_rows: usize) -> Drawn {
        let mut columns: Vec<&Column<'_>> = self.series.iter().map(|s| &s.y).collect();
        columns.extend(self.series.iter().filter_map(|s| s.sigma.as_ref()));
        let rows = decimate::keep_rows(&self.x, &columns, max_rows);
        let x: Vec<f64> = rows.iter().map(|&r| self.x.get(r)).collect();
        let gap_breaks = self.gap_breaks(&x);
        let series = self.series.iter().map(|s| s.drawn(&rows, &gap_breaks)).collect();
        Drawn { x, series, rows_before: self.x.len() }
    }

    /// Rows whose step from the row before crosses a gap.
    fn gap_breaks(&self, x: &[f64]) -> Vec<bool> {
        let gaps: Vec<&Span> = self.spans.iter().filter(|s| s.kind == SpanKind::Gap).collect();
        let mut next = 0;
        let mut breaks = vec![false; x.len()];
        for (k, step) in x.windows(2).enumerate() {
            let (from, to) = (step[0], step[1]);
            while gaps.get(next).is_some_and(|gap| gap.to < from) {
                next += 1;
            }
            if let Some(gap) = gaps.get(next) {
                let middle = 0.5 * (gap.from + gap.to);
                breaks[k + 1] = from <= middle && middle <= to;
            }
        }
        breaks
    }
}

impl Series<'_> {
    fn drawn(&self, rows: &[usize], gap_breaks: &[bool]) -> DrawnSeries {
        let shown = |column: &Column<'_>| -> Vec<f32> {
            rows.iter().map(|&r| (column.get(r) * self.factor) as f32).collect()
        };
        let y = shown(&self.y);
        let wraps = |k: usize| match (self.period, k.checked_sub(1).and_then(|j| y.get(j)), y.get(k)) {
            (Some(period), Some(&a), Some(&b)) => f64::from((b - a).abs()) > 0.5 * period,
            _ => false,
        };
        let breaks = (0..rows.len())
            .filter(|&k| gap_breaks.get(k).copied().unwrap_or(false) || wraps(k))
            .map(|k| k as u32)
            .collect();
        DrawnSeries { sigma: self.sigma.as_ref().map(shown), y, breaks }
    }
}

impl Plot<'_> {
    /// The plot as a JSON object for the page's script.
    pub(crate) fn to_json(&self, max_rows: usize) -> String {
        let drawn = self.drawn(max_rows);
        let series: Vec<String> = self
            .series
            .iter()
            .zip(&drawn.series)
            .map(|(series, drawn)| {
                let sigma = drawn
                    .sigma
                    .as_ref()
                    .map_or("null".to_owned(), |s| format!("\"{}\"", encode::f32s(s.iter().copied())));
                format!(
                    r#"{{"name":{},"tone":"{}","points":{},"y":"{}","sigma":{sigma},"breaks":"{}"}}"#,
                    json_string(&series.name),
                    series.tone.key(),
                    series.mark == Mark::Points,
                    encode::f32s(drawn.y.iter().copied()),
                    encode::u32s(drawn.breaks.iter().copied()),
                )
            })
            .collect();
        let spans: Vec<String> = self
            .spans
            .iter()
            .map(|s| {
                let (from, to) = (json_number(s.from), json_number(s.to));
                format!(r#"[{from},{to},"{}"]"#, s.kind.key())
            })
            .collect();
        let axis = |a: &Axis| {
            format!(
                r#"{{"label":{},"unit":{},"log":{}}}"#,
                json_string(&a.label),
                json_string(&a.unit),
                a.scale == Scale::Log
            )
        };
        format!(
            r#"{{"xAxis":{},"yAxis":{},"x":"{}","rowsBefore":{},"series":[{}],"spans":[{}]}}"#,
            axis(&self.x_axis),
            axis(&self.y_axis),
            encode::f64s(drawn.x.iter().copied()),
            drawn.rows_before,
            series.join(","),
            spans.join(",")
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plot<'a>(x: &'a [f64], y: &'a [f64], spans: Vec<Span>) -> Plot<'a> {
        Plot {
            heading: "h".into(),
            description: "d".into(),
            x_axis: Axis::linear("Time", "s"),
            y_axis: Axis::linear("Yaw", "°"),
            x: Column::Slice(x),
            series: vec![Series {
                name: "yaw".into(),
                tone: Tone::Z,
                mark: Mark::Line,
                y: Column::Slice(y),
                sigma: None,
                factor: 2.0,
                period: Some(360.0),
            }],
            spans,
        }
    }

    #[test]
    fn lines_break_at_wraps_and_gaps_only() {
        let x = [0.0, 1.0, 2.0, 3.0, 10.0, 11.0];
        let y = [80.0, 89.0, -89.0, -80.0, -70.0, f64::NAN];
        let gaps = spans(&[(3.0, 10.0)], SpanKind::Gap);
        let drawn = plot(&x, &y, gaps).drawn(100);
        assert_eq!(drawn.series[0].breaks, [2, 4]);
        assert_eq!(drawn.series[0].y[..5], [160.0, 178.0, -178.0, -160.0, -140.0]);
        assert!(drawn.series[0].y[5].is_nan());
        assert!(plot(&x, &y, Vec::new()).drawn(100).series[0].breaks == [2]);
    }

    #[test]
    fn json_names_what_is_not_finite_null() {
        let span = Span { from: f64::NAN, to: 1.0, kind: SpanKind::Poor };
        let json = plot(&[0.0], &[0.0], vec![span]).to_json(10);
        assert!(json.contains(r#""spans":[[null,1,"poor"]]"#), "{json}");
    }
}
