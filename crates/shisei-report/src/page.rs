//! A page: one HTML file with everything in it, that asks nothing of the network.
//!
//! Made of blocks; a report says which. All text given to it is data and is escaped here and nowhere else.

use std::fmt::Write as _;

use shisei_core::Lang;

use crate::attitude::{self, AttitudeView};
use crate::escape::{html, json_string};
use crate::plot::Plot;
use crate::text::Text;

/// What the numbers of a page may take together, bytes; text and scripts add about 0.1 MB.
const DATA_BUDGET_BYTES: usize = 8_000_000;
/// Rows that no plot needs more than.
const MAX_ROWS: usize = 60_000;
/// Longest list of warnings or assumptions that is written out.
const MAX_ITEMS: usize = 300;
/// Longest text that is written out, characters.
const MAX_TEXT_CHARS: usize = 4_000;

/// One HTML file.
#[derive(Clone, Debug)]
pub struct Page<'a> {
    /// Language of the page's own words.
    pub lang: Lang,
    /// Title, also of the browser's window.
    pub title: String,
    /// Lines under the title: where the data come from.
    pub sources: Vec<String>,
    /// What matters most, as name and value, shown first.
    pub facts: Vec<(String, String)>,
    /// What the reader has to know before believing the rest.
    pub warnings: Vec<String>,
    /// Plots over one x that zoom together, with a cursor they share.
    pub plots: Vec<Plot<'a>>,
    /// The attitude that follows the cursor, if there is one.
    pub attitude: Option<AttitudeView<'a>>,
    /// What follows the plots.
    pub blocks: Vec<Block>,
    /// What made the page: name and version.
    pub generator: String,
}

/// A part of a page below the plots.
#[derive(Clone, Debug)]
pub enum Block {
    /// A table with a head.
    Table {
        /// Heading.
        heading: String,
        /// Names of the columns.
        head: Vec<String>,
        /// Cells; the first of a row names it.
        rows: Vec<Vec<String>>,
    },
    /// A still figure.
    Figure {
        /// Heading.
        heading: String,
        /// What it shows.
        figure: crate::figure::Figure,
    },
    /// A list of sentences.
    List {
        /// Heading.
        heading: String,
        /// Sentences.
        items: Vec<String>,
    },
}

impl Page<'_> {
    /// The file's text. Under 10 MB whatever the length of the recording.
    pub fn to_html(&self) -> String {
        let text = Text::of(self.lang);
        let mut out = String::with_capacity(1 << 20);
        let (lang, title) = (text.html_lang, html(&limited(&self.title)));
        let css = [include_str!("../assets/uPlot.min.css"), include_str!("../assets/page.css")].join("\n");
        let _ = writeln!(
            out,
            "<!doctype html>\n<html lang=\"{lang}\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src \
             'unsafe-inline'; script-src 'unsafe-inline'; img-src data:; base-uri 'none'; form-action 'none'\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
             <meta name=\"color-scheme\" content=\"light dark\">\n\
             <meta name=\"generator\" content=\"{}\">\n<link rel=\"icon\" href=\"data:,\">\n\
             <title>{title}</title>\n<style>{css}</style>\n</head>\n<body>",
            html(&limited(&self.generator)),
        );
        self.write_header(&mut out, &text);
        self.write_plots(&mut out, &text);
        for block in &self.blocks {
            write_block(&mut out, block, &text);
        }
        let _ = writeln!(
            out,
            "<footer>{} · {}</footer>",
            html(&limited(&self.generator)),
            html(text.offline_note)
        );
        self.write_scripts(&mut out, &text);
        out.push_str("</body>\n</html>\n");
        out
    }

    fn write_header(&self, out: &mut String, text: &Text) {
        let _ = writeln!(out, "<header>\n<h1>{}</h1>", html(&limited(&self.title)));
        if !self.sources.is_empty() {
            let sources: Vec<String> = shortened(&self.sources, text).iter().map(|s| html(s)).collect();
            let _ = writeln!(out, "<p class=\"sources\">{}</p>", sources.join("<br>"));
        }
        out.push_str("</header>\n");
        if !self.warnings.is_empty() {
            let _ = writeln!(
                out,
                "<section class=\"warnings\" aria-labelledby=\"w\">\n<h2 id=\"w\"><span aria-hidden=\"true\">⚠ </span>{}</h2>\n<ul>",
                html(text.warnings)
            );
            write_items(out, &self.warnings, text);
            out.push_str("</ul>\n</section>\n");
        }
        if !self.facts.is_empty() {
            let _ = writeln!(
                out,
                "<section aria-labelledby=\"f\">\n<h2 id=\"f\" class=\"quiet\">{}</h2>\n<dl class=\"facts\">",
                html(text.summary)
            );
            for (name, value) in self.facts.iter().take(MAX_ITEMS) {
                let _ = writeln!(
                    out,
                    "<div><dt>{}</dt><dd>{}</dd></div>",
                    html(&limited(name)),
                    html(&limited(value))
                );
            }
            out.push_str("</dl>\n</section>\n");
        }
    }

    fn write_plots(&self, out: &mut String, text: &Text) {
        if self.plots.is_empty() && self.attitude.is_none() {
            return;
        }
        let _ = writeln!(
            out,
            "<noscript><p class=\"warnings\">{}</p></noscript>\n<main class=\"board{}\">\n<div class=\"plots\">",
            html(text.no_script),
            if self.attitude.is_some() { " with-attitude" } else { "" }
        );
        let button = |id: &str, label: &str, name: &str| {
            format!(
                "<button type=\"button\" id=\"{id}\" title=\"{0}\" aria-label=\"{0}\">{1}</button>",
                html(name),
                html(label)
            )
        };
        let _ = writeln!(
            out,
            "<div class=\"tools\" role=\"toolbar\" aria-label=\"{}\">{}{}{}{}{}<span class=\"key\" id=\"key\"></span></div>",
            html(text.zoom),
            button("zoom-in", "+", text.zoom_in),
            button("zoom-out", "−", text.zoom_out),
            button("pan-left", "←", text.earlier),
            button("pan-right", "→", text.later),
            button("zoom-all", text.whole, text.whole),
        );
        for (k, plot) in self.plots.iter().enumerate() {
            let _ = writeln!(
                out,
                "<section class=\"plot\" aria-labelledby=\"p{k}\">\n<h2 id=\"p{k}\">{}</h2>\n\
                 <div class=\"legend\" id=\"legend{k}\"></div>\n\
                 <div class=\"canvas\" id=\"plot{k}\" role=\"img\" aria-label=\"{}\"></div>\n</section>",
                html(&limited(&plot.heading)),
                html(&limited(&plot.description)),
            );
        }
        let _ = writeln!(out, "<p class=\"hint\" id=\"hint\">{}</p>\n</div>", html(text.hint));
        if self.attitude.is_some() {
            let mut speeds = String::new();
            for speed in ["0.25", "0.5", "1", "2", "5", "10"] {
                let chosen = if speed == "1" { " selected" } else { "" };
                let _ = write!(speeds, "<option value=\"{speed}\"{chosen}>{speed}×</option>");
            }
            let _ = writeln!(
                out,
                "<aside class=\"attitude\" aria-labelledby=\"a\">\n<h2 id=\"a\">{}</h2>\n\
                 <canvas id=\"attitude\" tabindex=\"0\" role=\"img\" aria-label=\"{}\"></canvas>\n\
                 <div class=\"transport\"><button type=\"button\" id=\"play\" class=\"primary\" aria-pressed=\"false\">▶ {}</button>\
                 <label>{} <select id=\"speed\">{speeds}</select></label></div>\n\
                 <label class=\"time\" for=\"time\"><span>{}</span> <output id=\"now\" for=\"time\"></output></label>\n\
                 <input type=\"range\" id=\"time\" min=\"0\" max=\"1\" step=\"any\" value=\"0\">\n\
                 <p class=\"hint\">{}</p>\n</aside>",
                html(text.attitude),
                html(text.attitude_description),
                html(text.play),
                html(text.speed),
                html(text.time),
                html(text.attitude_hint),
            );
        }
        out.push_str("</main>\n");
    }

    fn write_scripts(&self, out: &mut String, text: &Text) {
        if self.plots.is_empty() && self.attitude.is_none() {
            return;
        }
        let mut bytes_per_row: usize = self.plots.iter().map(Plot::bytes_per_row).sum();
        if self.attitude.is_some() {
            bytes_per_row += attitude::BYTES_PER_ROW;
        }
        let max_rows = (DATA_BUDGET_BYTES / bytes_per_row.max(1)).min(MAX_ROWS);
        let plots: Vec<String> = self.plots.iter().map(|p| p.to_json(max_rows)).collect();
        let attitude = self.attitude.as_ref().map_or("null".to_owned(), |a| a.to_json(max_rows));
        let _ = writeln!(
            out,
            "<script type=\"application/json\" id=\"data\">{{\"text\":{},\"plots\":[{}],\"attitude\":{attitude}}}</script>",
            script_text(text),
            plots.join(","),
        );
        let _ = writeln!(
            out,
            "<script>\n/* uPlot:\n{}*/\n{}\n</script>",
            include_str!("../assets/uPlot.LICENSE"),
            include_str!("../assets/uPlot.iife.min.js")
        );
        for script in [
            include_str!("../assets/data.js"),
            include_str!("../assets/plot.js"),
            include_str!("../assets/attitude.js"),
            include_str!("../assets/page.js"),
        ] {
            let _ = writeln!(out, "<script>\n{script}\n</script>");
        }
    }
}

fn script_text(text: &Text) -> String {
    let words = [
        ("play", text.play),
        ("pause", text.pause),
        ("rest", text.rest),
        ("gap", text.gap),
        ("poor", text.poor),
        ("band", text.band),
        ("thinned", text.thinned),
        ("hide", text.hide),
        ("show", text.show),
    ];
    let fields: Vec<String> =
        words.iter().map(|(name, word)| format!("\"{name}\":{}", json_string(word))).collect();
    format!("{{{}}}", fields.join(","))
}

fn write_block(out: &mut String, block: &Block, text: &Text) {
    match block {
        Block::Table { heading, head, rows } => {
            let _ = write!(
                out,
                "<section class=\"block\">\n<h2>{}</h2>\n<div class=\"scroll\"><table>\n<thead><tr>",
                html(&limited(heading))
            );
            for name in head {
                let _ = write!(out, "<th scope=\"col\">{}</th>", html(&limited(name)));
            }
            out.push_str("</tr></thead>\n<tbody>\n");
            for row in rows.iter().take(MAX_ITEMS) {
                out.push_str("<tr>");
                for (k, cell) in row.iter().enumerate() {
                    let cell = html(&limited(cell));
                    if k == 0 {
                        let _ = write!(out, "<th scope=\"row\">{cell}</th>");
                    } else {
                        let _ = write!(out, "<td>{cell}</td>");
                    }
                }
                out.push_str("</tr>\n");
            }
            out.push_str("</tbody></table></div>\n</section>\n");
        }
        Block::Figure { heading, figure } => {
            let _ = writeln!(
                out,
                "<section>\n<h2>{}</h2>\n{}\n</section>",
                html(&limited(heading)),
                figure.to_svg()
            );
        }
        Block::List { heading, items } => {
            let _ = writeln!(out, "<section class=\"block\">\n<h2>{}</h2>\n<ul>", html(&limited(heading)));
            write_items(out, items, text);
            out.push_str("</ul>\n</section>\n");
        }
    }
}

fn write_items(out: &mut String, items: &[String], text: &Text) {
    for item in shortened(items, text) {
        let _ = writeln!(out, "<li>{}</li>", html(&item));
    }
}

/// The first items, and how many more there are.
fn shortened(items: &[String], text: &Text) -> Vec<String> {
    let mut out: Vec<String> = items.iter().take(MAX_ITEMS).map(|s| limited(s)).collect();
    if items.len() > MAX_ITEMS {
        out.push(text.and_more.replace("{n}", &(items.len() - MAX_ITEMS).to_string()));
    }
    out
}

fn limited(text: &str) -> String {
    if text.chars().nth(MAX_TEXT_CHARS).is_none() {
        return text.to_owned();
    }
    text.chars().take(MAX_TEXT_CHARS).chain(['…']).collect()
}
