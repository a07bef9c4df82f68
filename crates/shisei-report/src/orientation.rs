//! The report of `orient`: yaw, pitch, roll and the attitude over time, the raw signals, what was assumed.

use shisei_core::{Lang, Quaternion};

use crate::attitude::AttitudeView;
use crate::column::Column;
use crate::error::{Error, Result};
use crate::page::{Block, Page};
use crate::plot::{self, Axis, Mark, Plot, Series, Span, SpanKind, Tone};
use crate::png;
use crate::text::Text;

const DEG_PER_RAD: f64 = 180.0 / core::f64::consts::PI;

/// What an orientation report shows. Every series has one row a time stamp; the optional ones may be
/// empty. Times are not decreasing; rows that break this are left out of the plots.
#[derive(Clone, Copy, Debug)]
pub struct OrientationReport<'a> {
    /// Language of the report's own words.
    pub lang: Lang,
    /// Title.
    pub title: &'a str,
    /// Files the recording came from.
    pub source_names: &'a [String],
    /// Time of each row, s.
    pub time_s: &'a [f64],
    /// Yaw, pitch, roll of each row, rad, as written to the result file (relative or not).
    pub ypr_rad: &'a [[f64; 3]],
    /// Attitude of each row, for the 3-D view; may be empty.
    pub world_from_body: &'a [Quaternion],
    /// Accelerometer, body axes, m/s²; may be empty.
    pub acc_m_s2: &'a [[f64; 3]],
    /// Gyroscope, body axes, rad/s; may be empty.
    pub gyro_rad_s: &'a [[f64; 3]],
    /// Intervals at rest, from … to, s.
    pub rests: &'a [(f64, f64)],
    /// Intervals without samples, s.
    pub gaps: &'a [(f64, f64)],
    /// Uncertainty of the estimate and where it is poor, if the estimator tells.
    pub uncertainty: Option<Uncertainty<'a>>,
    /// Rate, duration, filter and settings, bias removed …, as name and value in the report's language.
    /// The report adds the range of the angles itself.
    pub summary: &'a [(String, String)],
    /// What was assumed, one sentence each.
    pub assumptions: &'a [String],
    /// Warnings, one sentence each.
    pub warnings: &'a [String],
    /// True for degrees and °/s in plots and tables, false for radians.
    pub degrees: bool,
    /// What made the report: name and version.
    pub generator: &'a str,
}

/// How well the estimator knows its result.
#[derive(Clone, Copy, Debug)]
pub struct Uncertainty<'a> {
    /// 1 sigma of the tilt, rad, one a row: drawn about pitch and roll.
    pub sigma_tilt_rad: &'a [f64],
    /// 1 sigma of the heading, rad, one a row: drawn about yaw.
    pub sigma_heading_rad: &'a [f64],
    /// Intervals that the estimator calls poor, s.
    pub poor: &'a [(f64, f64)],
}

/// One HTML file that works offline, under 10 MB.
pub fn html(report: &OrientationReport<'_>) -> Result<String> {
    report.check()?;
    let text = Text::of(report.lang);
    let mut plots = vec![report.angle_plot(&text)];
    if !report.acc_m_s2.is_empty() {
        plots.push(report.acceleration_plot(&text));
    }
    if !report.gyro_rad_s.is_empty() {
        plots.push(report.gyro_plot(&text));
    }
    let attitude = (!report.world_from_body.is_empty())
        .then_some(AttitudeView { time_s: report.time_s, world_from_body: report.world_from_body });
    let mut blocks = vec![report.range_table(&text)];
    if !report.assumptions.is_empty() {
        blocks.push(Block::List { heading: text.assumptions.to_owned(), items: report.assumptions.to_vec() });
    }
    let page = Page {
        lang: report.lang,
        title: report.title.to_owned(),
        sources: report.source_names.to_vec(),
        facts: report.summary.to_vec(),
        warnings: report.warnings.to_vec(),
        plots,
        attitude,
        blocks,
        generator: report.generator.to_owned(),
    };
    Ok(page.to_html())
}

/// A PNG of yaw, pitch and roll over time.
pub fn png(report: &OrientationReport<'_>, width: u32, height: u32) -> Result<Vec<u8>> {
    report.check()?;
    let text = Text::of(report.lang);
    png::render(report.title, &[&report.angle_plot(&text)], report.lang, width, height)
}

impl<'a> OrientationReport<'a> {
    fn check(&self) -> Result<()> {
        let expected = self.time_s.len();
        if expected == 0 {
            return Err(Error::Empty);
        }
        let sigma = |pick: fn(&Uncertainty<'a>) -> usize| self.uncertainty.as_ref().map_or(0, pick);
        let lengths = [
            ("ypr_rad", self.ypr_rad.len(), false),
            ("world_from_body", self.world_from_body.len(), true),
            ("acc_m_s2", self.acc_m_s2.len(), true),
            ("gyro_rad_s", self.gyro_rad_s.len(), true),
            ("sigma_tilt_rad", sigma(|u| u.sigma_tilt_rad.len()), true),
            ("sigma_heading_rad", sigma(|u| u.sigma_heading_rad.len()), true),
        ];
        for (series, found, may_be_empty) in lengths {
            if found != expected && !(may_be_empty && found == 0) {
                return Err(Error::LengthMismatch { series, expected, found });
            }
        }
        Ok(())
    }

    fn angle_factor(&self) -> f64 {
        if self.degrees { DEG_PER_RAD } else { 1.0 }
    }

    fn spans(&self) -> Vec<Span> {
        let mut spans = plot::spans(self.rests, SpanKind::Rest);
        if let Some(uncertainty) = &self.uncertainty {
            spans.extend(plot::spans(uncertainty.poor, SpanKind::Poor));
        }
        spans.extend(plot::spans(self.gaps, SpanKind::Gap));
        spans
    }

    fn plot(&self, heading: &str, y_axis: Axis, series: Vec<Series<'a>>, text: &Text) -> Plot<'a> {
        let finite = || self.time_s.iter().copied().filter(|t| t.is_finite());
        let (from, to) = (finite().next().unwrap_or(0.0), finite().next_back().unwrap_or(0.0));
        let description = text
            .plot_of
            .replace("{from}", &format!("{from:.2}"))
            .replace("{to}", &format!("{to:.2}"))
            .replace("{what}", heading);
        Plot {
            heading: heading.to_owned(),
            description,
            x_axis: Axis::linear(text.time, text.seconds),
            y_axis,
            x: Column::Slice(self.time_s),
            series,
            spans: self.spans(),
        }
    }

    fn angle_plot(&self, text: &Text) -> Plot<'a> {
        let sigma = |yaw: bool| -> Option<Column<'a>> {
            let uncertainty = self.uncertainty.as_ref()?;
            let rows = if yaw { uncertainty.sigma_heading_rad } else { uncertainty.sigma_tilt_rad };
            (!rows.is_empty()).then_some(Column::Slice(rows))
        };
        let factor = self.angle_factor();
        let names = [(text.yaw, Tone::Z), (text.pitch, Tone::Y), (text.roll, Tone::X)];
        let series = names
            .iter()
            .enumerate()
            .map(|(k, (name, tone))| Series {
                name: (*name).to_owned(),
                tone: *tone,
                mark: Mark::Line,
                y: Column::Component(self.ypr_rad, k),
                sigma: sigma(k == 0),
                factor,
                period: (k != 1).then_some(2.0 * core::f64::consts::PI * factor),
            })
            .collect();
        let unit = if self.degrees { "°" } else { "rad" };
        self.plot(text.orientation, Axis::linear(text.angle, unit), series, text)
    }

    fn acceleration_plot(&self, text: &Text) -> Plot<'a> {
        let series = xyz(self.acc_m_s2, 1.0);
        self.plot(text.acceleration, Axis::linear(text.acceleration, "m/s²"), series, text)
    }

    fn gyro_plot(&self, text: &Text) -> Plot<'a> {
        let unit = if self.degrees { "°/s" } else { "rad/s" };
        let series = xyz(self.gyro_rad_s, self.angle_factor());
        self.plot(text.angular_rate, Axis::linear(text.angular_rate_axis, unit), series, text)
    }

    fn range_table(&self, text: &Text) -> Block {
        let factor = self.angle_factor();
        let shown = |v: f64| {
            let number = if self.degrees { format!("{:.2}°", v * factor) } else { format!("{v:.4} rad") };
            number.replace('-', "−")
        };
        let at = |row: Option<usize>, k: usize| match row {
            Some(r) => text
                .at_time
                .replace("{value}", &shown(self.ypr_rad.get(r).map_or(f64::NAN, |a| a[k])))
                .replace("{time}", &format!("{:.2}", self.time_s.get(r).copied().unwrap_or(f64::NAN))),
            None => "–".to_owned(),
        };
        let rows = [text.yaw, text.pitch, text.roll]
            .iter()
            .enumerate()
            .map(|(k, name)| {
                let mut found = [None, None, None]; // rows of the least, the greatest, the last
                let (mut least, mut greatest) = (f64::INFINITY, f64::NEG_INFINITY);
                for (row, angles) in self.ypr_rad.iter().enumerate() {
                    let value = angles[k];
                    if value.is_finite() {
                        if value < least {
                            (least, found[0]) = (value, Some(row));
                        }
                        if value > greatest {
                            (greatest, found[1]) = (value, Some(row));
                        }
                        found[2] = Some(row);
                    }
                }
                let mut cells = vec![(*name).to_owned()];
                cells.extend(found.iter().map(|row| at(*row, k)));
                cells
            })
            .collect();
        let head = ["", text.smallest, text.largest, text.at_end].map(str::to_owned).to_vec();
        Block::Table { heading: text.ranges.to_owned(), head, rows }
    }
}

fn xyz(rows: &[[f64; 3]], factor: f64) -> Vec<Series<'_>> {
    [("x", Tone::X), ("y", Tone::Y), ("z", Tone::Z)]
        .iter()
        .enumerate()
        .map(|(k, (name, tone))| Series {
            name: (*name).to_owned(),
            tone: *tone,
            mark: Mark::Line,
            y: Column::Component(rows, k),
            sigma: None,
            factor,
            period: None,
        })
        .collect()
}
