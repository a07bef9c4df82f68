//! The whole report: size, safety, holes in the data, refusals, and what the picture shows.

use shisei_core::{Lang, Quaternion};
use shisei_report::orientation::{self, OrientationReport, Uncertainty};
use shisei_report::{Error, escape};

fn report<'a>(time_s: &'a [f64], ypr_rad: &'a [[f64; 3]]) -> OrientationReport<'a> {
    OrientationReport {
        lang: Lang::En,
        title: "Test",
        source_names: &[],
        time_s,
        ypr_rad,
        world_from_body: &[],
        acc_m_s2: &[],
        gyro_rad_s: &[],
        rests: &[],
        gaps: &[],
        uncertainty: None,
        summary: &[],
        assumptions: &[],
        warnings: &[],
        degrees: true,
        generator: "test",
    }
}

#[test]
fn five_million_samples_stay_under_ten_megabytes() {
    let n = 5_000_000;
    let time_s: Vec<f64> = (0..n).map(|k| k as f64 * 1e-3).collect();
    let mut state = 1_u64;
    let mut noise = || {
        state = state * 48271 % 2147483647;
        state as f64 / 1073741823.5 - 1.0
    };
    let rows: Vec<[f64; 3]> = (0..n).map(|_| [noise(), noise(), noise()].map(|v| 3.1 * v)).collect();
    let sigma = vec![0.1; n];
    let attitude = vec![Quaternion::IDENTITY; n];
    let many: Vec<(f64, f64)> =
        (0..50_000).map(|k| (f64::from(k) * 0.1, f64::from(k) * 0.1 + 0.01)).collect();
    let warnings: Vec<String> = (0..100_000).map(|k| format!("warning {k} {}", "x".repeat(100))).collect();
    let page = orientation::html(&OrientationReport {
        world_from_body: &attitude,
        acc_m_s2: &rows,
        gyro_rad_s: &rows,
        rests: &many,
        gaps: &many,
        warnings: &warnings,
        uncertainty: Some(Uncertainty { sigma_tilt_rad: &sigma, sigma_heading_rad: &sigma, poor: &many }),
        ..report(&time_s, &rows)
    })
    .expect("a report");
    assert!(page.len() < 10_000_000, "{} bytes", page.len());
    assert!(page.len() > 4_000_000, "the room is used: {} bytes", page.len());
    assert!(page.contains("and 99700 more"));
}

/// Only our own tags may open, whatever the names are.
#[test]
fn hostile_names_stay_text_in_every_place() {
    let attacks = [
        "</script><script>alert(1)</script>",
        "\"><img src=x onerror=alert(1)>",
        "' onmouseover='alert(1)",
        "</title></style><svg onload=alert(1)>",
        "<!--",
        "]]>",
        "&lt;b&gt;",
        "\u{2028}\u{0}\u{202e}",
    ];
    let time_s = [0.0, 1.0];
    let ypr_rad = [[0.0; 3]; 2];
    let count = |page: &str, what: &str| page.matches(what).count();
    for lang in [Lang::En, Lang::Ja] {
        let plain = orientation::html(&hostile(lang, &time_s, &ypr_rad, "plain")).expect("a report");
        for attack in attacks {
            let page = orientation::html(&hostile(lang, &time_s, &ypr_rad, attack)).expect("a report");
            for mark in ["<", ">", "\"", "'"] {
                assert_eq!(count(&page, mark), count(&plain, mark), "{mark} with {attack}");
            }
            assert!(page.contains(&escape::html(attack)));
            assert!(!page.contains('\u{0}') && !page.contains('\u{202e}'));
        }
    }
}

fn hostile<'a>(
    lang: Lang,
    time_s: &'a [f64],
    ypr_rad: &'a [[f64; 3]],
    name: &'a str,
) -> OrientationReport<'a> {
    let leak = |items: Vec<String>| -> &'static [String] { items.leak() };
    OrientationReport {
        lang,
        title: name,
        source_names: leak(vec![name.to_owned()]),
        summary: vec![(name.to_owned(), name.to_owned())].leak(),
        assumptions: leak(vec![name.to_owned()]),
        warnings: leak(vec![name.to_owned()]),
        ..report(time_s, ypr_rad)
    }
}

#[test]
fn nothing_finite_is_still_a_page_and_a_picture() {
    let nan = [[f64::NAN; 3]; 3];
    for time_s in [[0.0, 1.0, 2.0], [f64::NAN; 3], [3.0, 2.0, f64::INFINITY]] {
        let attitude = [Quaternion::new(f64::NAN, 0.0, 0.0, 0.0); 3];
        let report = OrientationReport {
            world_from_body: &attitude,
            acc_m_s2: &nan,
            rests: &[(f64::NAN, 1.0), (2.0, 1.0)],
            gaps: &[(f64::NEG_INFINITY, f64::INFINITY)],
            ..report(&time_s, &nan)
        };
        let page = orientation::html(&report).expect("a page");
        let data = page.split("id=\"data\">").nth(1).and_then(|s| s.split("</script>").next());
        let data = data.expect("the page's data");
        assert!(!data.contains("NaN") && !data.contains("inf"), "{data}");
        assert!(data.contains(r#""attitude":{"t":"","q":""}"#), "{data}");
        assert!(orientation::png(&report, 640, 360).expect("a picture").starts_with(b"\x89PNG"));
    }
}

#[test]
fn what_does_not_fit_together_is_refused_with_a_sentence() {
    assert_eq!(orientation::html(&report(&[], &[])), Err(Error::Empty));
    let wrong = orientation::html(&report(&[0.0, 1.0], &[[0.0; 3]]));
    let expected = Error::LengthMismatch { series: "ypr_rad", expected: 2, found: 1 };
    assert_eq!(wrong, Err(expected.clone()));
    assert!(expected.to_string().contains("ypr_rad has 1 rows"));
    assert!(expected.message(Lang::Ja).contains("1 行"));
    let size = orientation::png(&report(&[0.0], &[[0.0; 3]]), 10, 10);
    assert_eq!(size, Err(Error::ImageSize { width: 10, height: 10 }));
}

#[test]
fn the_picture_shows_three_lines_and_the_rest() {
    let time_s: Vec<f64> = (0..1_000).map(|k| f64::from(k) * 0.01).collect();
    let ypr_rad: Vec<[f64; 3]> = time_s.iter().map(|t| [0.5, 0.1 * t, -0.3]).collect();
    let base = report(&time_s, &ypr_rad);
    let decode = |report: &OrientationReport<'_>| {
        let png = orientation::png(report, 1600, 900).expect("a picture");
        tiny_skia::Pixmap::decode_png(&png).expect("a PNG")
    };
    let picture = decode(&OrientationReport { rests: &[(0.0, 5.0)], title: "骨盤", ..base });
    assert_eq!((picture.width(), picture.height()), (1600, 900));
    let near = |rgb: [u8; 3]| {
        picture
            .pixels()
            .iter()
            .filter(|p| {
                let differs = |a: u8, b: u8| a.abs_diff(b) > 40;
                !differs(p.red(), rgb[0]) && !differs(p.green(), rgb[1]) && !differs(p.blue(), rgb[2])
            })
            .count()
    };
    for tone in [[196, 78, 0], [0, 128, 93], [0, 105, 176]] {
        assert!(near(tone) > 300, "{tone:?}: {}", near(tone));
    }
    // left of the middle the rest is shaded, right of it the paper is white
    let pixel = |x, y| picture.pixel(x, y).expect("inside");
    assert!(pixel(500, 600).red() < 245 && pixel(1290, 590).red() == 255);
    assert_ne!(picture.data(), decode(&base).data());
}
