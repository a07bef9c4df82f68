//! What Excel would see.

use crate::host::{Xll, show};
use crate::xl::{ARRAY, ERROR, ERROR_NA, ERROR_NUM, ERROR_VALUE, NUMBER, TRUTH, Xloper12};
use shisei_functions::{ExampleArg, Expected, FUNCTIONS, Function, Input, Range, Shape, VERSION, find};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Instant;

type Cells = Vec<Vec<Xloper12>>;

pub fn run() -> i32 {
    let mut arguments = std::env::args().skip(1);
    let path = arguments.next().expect("xll_host.exe shisei.xll [rows]");
    let rows: usize = arguments.next().map_or(1_000_000, |n| n.parse().expect("rows"));
    let xll = Xll::load(&path).expect("load");
    let mut failed = 0;
    let mut check = |name: &str, test: &dyn Fn()| {
        let right = catch_unwind(AssertUnwindSafe(test)).is_ok();
        println!("{}{name}", if right { "ok      " } else { "FAILED  " });
        failed += i32::from(!right);
    };
    check("registrations", &|| registrations(&xll));
    check("every example", &|| FUNCTIONS.iter().for_each(|f| example(&xll, f)));
    check("every example from four threads", &|| threads(&xll));
    check("C names are exported", &|| c_names(&xll));
    check("text and blank cells", &|| text_and_blank(&xll));
    check("wrong shapes", &|| wrong_shapes(&xll));
    check("no rows and one row", &|| few_rows(&xll));
    check("blank rows at the end are dropped", &|| blank_rows(&xll));
    check("zero quaternions", &|| zero_quaternions(&xll));
    check("steps, gravity and thresholds", &|| out_of_domain(&xll));
    check("conditions not met", &|| conditions(&xll));
    check("error cells are passed on", &|| error_cells(&xll));
    check("missing arguments", &|| missing(&xll));
    check("the sentence behind an error, the version", &|| sentences(&xll));
    check("many rows", &|| many_rows(&xll, rows));
    let unloaded = xll.unload();
    println!("{}unload", if unloaded { "ok      " } else { "FAILED  " });
    i32::from(failed > 0 || !unloaded)
}

fn cell(x: f64) -> Xloper12 {
    Xloper12 { value: crate::xl::Value { number: x }, xltype: NUMBER }
}

fn range(cells: Cells) -> Xloper12 {
    let (rows, cols) = (cells.len(), cells.first().map_or(0, Vec::len));
    Xloper12::array(cells.into_iter().flatten().collect(), rows, cols)
}

fn numbers(data: &[f64], cols: usize) -> Cells {
    data.chunks(cols).map(|row| row.iter().map(|&x| cell(x)).collect()).collect()
}

/// The example's arguments, with `replace` in the place of argument i.
fn arguments(f: &Function, i: usize, replace: Option<Xloper12>) -> Vec<Xloper12> {
    let mut given: Vec<Xloper12> = f
        .args
        .iter()
        .enumerate()
        .map(|(k, _)| match f.example.args.get(k) {
            Some(ExampleArg::Number(x)) => cell(*x),
            Some(ExampleArg::Range { data, cols }) => range(numbers(data, *cols)),
            _ => Xloper12::missing(),
        })
        .collect();
    if let Some(replace) = replace {
        given[i] = replace;
    }
    given
}

fn result_of<T>(xll: &Xll, f: &Function, mut given: Vec<Xloper12>, read: impl FnOnce(&Xloper12) -> T) -> T {
    let value = xll.call(f.name, &given.iter().collect::<Vec<_>>(), read);
    given.iter_mut().for_each(|x| unsafe { x.free() });
    value
}

fn error_of(xll: &Xll, f: &Function, given: Vec<Xloper12>) -> Option<i32> {
    result_of(xll, f, given, |r| (r.kind() == ERROR).then(|| unsafe { r.value.error }))
}

fn registrations(xll: &Xll) {
    assert_eq!(xll.registrations.len(), FUNCTIONS.len());
    let japanese = std::env::var("SHISEI_LANG").is_ok_and(|lang| lang == "ja");
    for (r, f) in xll.registrations.iter().zip(&FUNCTIONS) {
        assert_eq!((&r[1], &r[3]), (&format!("xl_{}", f.name), &f.name.to_string()));
        assert!(
            r[2].starts_with(&"Q".repeat(f.args.len() + 1)) && r[2].len() == f.args.len() + 2,
            "{}",
            r[2]
        );
        assert_eq!(r[4].split(',').filter(|s| !s.is_empty()).count(), f.args.len(), "{}", r[4]);
        assert_eq!((r[5].as_str(), r[6].as_str()), ("1", "shisei"));
        assert_eq!(r[9], if japanese { f.doc.ja } else { f.doc.en });
        assert_eq!(r.len(), 10 + f.args.len());
        for text in r {
            assert!(text.encode_utf16().count() <= 255, "{text}");
        }
    }
}

fn example(xll: &Xll, f: &Function) {
    result_of(xll, f, arguments(f, 0, None), |r| match f.example.expected {
        Expected::Truth(truth) => {
            assert!(r.kind() == TRUTH && unsafe { r.value.truth != 0 } == truth, "{}: {}", f.name, show(r));
        }
        Expected::Sentence => assert!(r.kind() == crate::xl::TEXT, "{}", f.name),
        Expected::Numbers { data, cols, tolerance } => {
            let (cells, rows, got_cols) = unsafe { r.cells() };
            assert_eq!((rows * got_cols, got_cols), (data.len(), cols), "{}: {}", f.name, show(r));
            assert_eq!(r.kind() == ARRAY, data.len() > 1, "{}", f.name);
            for (cell, want) in cells.iter().zip(data) {
                assert_eq!(cell.kind(), NUMBER, "{}: {}", f.name, show(cell));
                let got = unsafe { cell.value.number };
                assert!((got - want).abs() <= tolerance, "{}: {got}, expected {want}", f.name);
            }
        }
    });
}

fn threads(xll: &Xll) {
    std::thread::scope(|scope| {
        let handles: Vec<_> = (0..4)
            .map(|_| scope.spawn(|| (0..100).for_each(|_| FUNCTIONS.iter().for_each(|f| example(xll, f)))))
            .collect();
        handles.into_iter().for_each(|handle| handle.join().expect("a thread failed"));
    });
}

fn c_names(xll: &Xll) {
    for f in FUNCTIONS.iter().filter(|f| !matches!(f.example.expected, Expected::Sentence)) {
        assert!(xll.exports(f.export), "{}", f.export);
    }
    assert!(xll.exports("shisei_last_error") && xll.exports("shisei_version"));
}

fn ranges(f: &Function) -> impl Iterator<Item = (usize, &'static [f64], usize, Shape)> {
    f.args.iter().zip(f.example.args).enumerate().filter_map(|(i, (arg, given))| match given {
        ExampleArg::Range { data, cols } => Some((i, *data, *cols, arg.shape)),
        _ => None,
    })
}

fn text_and_blank(xll: &Xll) {
    for f in &FUNCTIONS {
        for (i, data, cols, _) in ranges(f) {
            for bad in [Xloper12::text("abc"), Xloper12::blank()] {
                let mut cells = numbers(data, cols);
                cells[0][cols - 1] = bad;
                let got = error_of(xll, f, arguments(f, i, Some(range(cells))));
                assert_eq!(got, Some(ERROR_VALUE), "{} {i}", f.name);
            }
        }
        for (i, _) in f.args.iter().enumerate().filter(|(_, a)| a.shape.is_number()) {
            for bad in [Xloper12::text("abc"), Xloper12::blank()] {
                assert_eq!(error_of(xll, f, arguments(f, i, Some(bad))), Some(ERROR_VALUE), "{} {i}", f.name);
            }
        }
    }
}

fn wrong_shapes(xll: &Xll) {
    let square = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
    for f in &FUNCTIONS {
        for (i, arg) in f.args.iter().enumerate() {
            if matches!(arg.shape, Shape::Series(3) | Shape::SeriesEither(3, _)) {
                continue;
            }
            let given = arguments(f, i, Some(range(numbers(&square, 3))));
            assert_eq!(error_of(xll, f, given), Some(ERROR_VALUE), "{} {}", f.name, arg.name);
        }
    }
}

fn is_series(shape: Shape) -> bool {
    matches!(shape, Shape::Series(_) | Shape::SeriesEither(..))
}

fn few_rows(xll: &Xll) {
    for f in &FUNCTIONS {
        let series: Vec<_> = ranges(f).filter(|(_, _, _, shape)| is_series(*shape)).collect();
        for &(i, _, cols, _) in &series {
            let blank = (0..2).map(|_| (0..cols).map(|_| Xloper12::blank()).collect()).collect();
            assert_eq!(
                error_of(xll, f, arguments(f, i, Some(range(blank)))),
                Some(ERROR_VALUE),
                "{}",
                f.name
            );
        }
        if series.is_empty() {
            continue;
        }
        let mut one = arguments(f, 0, None);
        for (i, data, cols, _) in series {
            unsafe { one[i].free() };
            one[i] = range(numbers(&data[..cols], cols));
        }
        // one row has no six faces, no sphere and no deviation; every other function takes it
        let needs_more =
            matches!(f.name, "GetBiasCalib" | "GetIMUCalib" | "FitSphere" | "AllanDev" | "EarthRate");
        assert_eq!(error_of(xll, f, one), needs_more.then_some(ERROR_NA), "{}", f.name);
    }
}

fn blank_rows(xll: &Xll) {
    let f = find("Vec3Mean").expect("in the table");
    let (_, data, cols, _) = ranges(f).next().expect("a range");
    let mut cells = numbers(data, cols);
    cells.extend((0..3).map(|_| (0..cols).map(|_| Xloper12::blank()).collect()));
    let expected =
        f.call(&[Input::Range(Range::new(data, data.len() / cols, cols).expect("fits"))]).expect("runs");
    result_of(xll, f, vec![range(cells)], |r| {
        let (cells, ..) = unsafe { r.cells() };
        let got: Vec<f64> = cells.iter().map(|c| unsafe { c.value.number }).collect();
        assert_eq!(got, expected.numbers().expect("numbers"));
    });
}

fn zero_quaternions(xll: &Xll) {
    for f in &FUNCTIONS {
        for (i, _, _, shape) in ranges(f) {
            if !matches!(shape, Shape::Vector(4) | Shape::Series(4)) {
                continue;
            }
            let got = error_of(xll, f, arguments(f, i, Some(range(numbers(&[0.0; 4], 4)))));
            let free = matches!(f.name, "ConjugateQuat" | "IsFiniteQuat");
            assert_eq!(got, (!free).then_some(ERROR_NUM), "{}", f.name);
        }
    }
}

fn out_of_domain(xll: &Xll) {
    for f in &FUNCTIONS {
        for (i, arg) in f.args.iter().enumerate() {
            let bad: &[f64] = match arg.name {
                "dt" => &[0.0, -0.01],
                "gravity" | "windowSec" => &[0.0],
                "varThreshold" | "kp" | "ki" => &[-1.0],
                "kpMin" | "accelUpperStart" => &[99.0],
                _ => &[],
            };
            for &value in bad {
                let got = error_of(xll, f, arguments(f, i, Some(cell(value))));
                assert_eq!(got, Some(ERROR_NUM), "{} {} = {value}", f.name, arg.name);
            }
        }
    }
}

fn conditions(xll: &Xll) {
    let f = find("Accs2InitialQuat").expect("in the table");
    assert_eq!(error_of(xll, f, arguments(f, 1, Some(cell(1e-9)))), Some(ERROR_NA));
    for name in ["GetBiasCalib", "GetIMUCalib"] {
        let f = find(name).expect("in the table");
        let (_, data, cols, _) = ranges(f).next().expect("a range");
        let one_face = range(numbers(&data[..4 * cols], cols));
        assert_eq!(error_of(xll, f, arguments(f, 0, Some(one_face))), Some(ERROR_NA));
        assert_eq!(error_of(xll, f, arguments(f, 7, Some(cell(0.999)))), Some(ERROR_NA));
    }
}

fn error_cells(xll: &Xll) {
    const DIVISION_BY_ZERO: i32 = 7;
    for f in &FUNCTIONS {
        for (i, data, cols, _) in ranges(f) {
            let mut cells = numbers(data, cols);
            cells[0][0] = Xloper12::error(DIVISION_BY_ZERO);
            let given = arguments(f, i, Some(range(cells)));
            if f.takes_not_finite {
                result_of(xll, f, given, |r| assert!(r.kind() == TRUTH && unsafe { r.value.truth } == 0));
            } else {
                assert_eq!(error_of(xll, f, given), Some(DIVISION_BY_ZERO), "{}", f.name);
            }
        }
    }
}

fn missing(xll: &Xll) {
    for f in FUNCTIONS.iter().filter(|f| f.required() > 0) {
        let given = arguments(f, f.required() - 1, Some(Xloper12::missing()));
        assert_eq!(error_of(xll, f, given), Some(ERROR_VALUE), "{}", f.name);
    }
}

fn sentences(xll: &Xll) {
    let normalize = find("NormalizeQuat").expect("in the table");
    error_of(xll, normalize, vec![range(numbers(&[0.0; 4], 4))]);
    let text = xll.call("ShiseiLastError", &[], show);
    let word = if std::env::var("SHISEI_LANG").is_ok_and(|lang| lang == "ja") { "ゼロ" } else { "zero" };
    assert!(text.starts_with("NormalizeQuat: ") && text.contains(word), "{text}");
    assert_eq!(xll.call("ShiseiVersion", &[], show), VERSION);
}

/// The same bits through the door, and what it costs beside the mathematics alone, same process, best of three.
fn many_rows(xll: &Xll, rows: usize) {
    let f = find("UpdateQuatsByMahony").expect("in the table");
    let wave = |i: usize, k: f64| 0.1 * f64::from((i % 200) as u32) / 200.0 * k;
    let gyro: Vec<f64> = (0..rows).flat_map(|i| [wave(i, 1.0), wave(i, -2.0), 0.01]).collect();
    let acc: Vec<f64> = (0..rows).flat_map(|i| [wave(i, 0.3), 0.02, 9.8]).collect();
    let start = [1.0, 0.0, 0.0, 0.0];
    let plain = [
        Input::Range(Range::new(&start, 1, 4).expect("fits")),
        Input::Range(Range::new(&gyro, rows, 3).expect("fits")),
        Input::Range(Range::new(&acc, rows, 3).expect("fits")),
        Input::Number(0.01),
        Input::Number(2.0),
        Input::Number(0.0),
    ];
    let flat = |data: &[f64], cols| {
        Xloper12::array(data.iter().map(|&x| cell(x)).collect(), data.len() / cols, cols)
    };
    let given = [
        flat(&start, 4),
        flat(&gyro, 3),
        flat(&acc, 3),
        cell(0.01),
        cell(2.0),
        cell(0.0),
        Xloper12::missing(),
    ];
    let borrowed: Vec<&Xloper12> = given.iter().collect();
    let best = |run: &dyn Fn()| {
        (0..3)
            .map(|_| {
                let started = Instant::now();
                run();
                started.elapsed().as_secs_f64()
            })
            .fold(f64::INFINITY, f64::min)
    };
    let maths = best(&|| drop(f.call(&plain).expect("runs")));
    let door = best(&|| xll.call(f.name, &borrowed, |r| assert_eq!(r.kind(), ARRAY)));
    let expected = f.call(&plain).expect("runs");
    let last = xll.call(f.name, &borrowed, |r| {
        let (cells, ..) = unsafe { r.cells() };
        cells.iter().map(|c| unsafe { c.value.number }).collect::<Vec<f64>>()
    });
    assert_eq!(last, expected.numbers().expect("numbers"), "same bits through the door");
    let extra = (door - maths) / maths;
    println!(
        "XLL, {rows} rows: maths {:.1} ms, through the door {:.1} ms; the door costs {extra:.2} × the maths",
        maths * 1e3,
        door * 1e3
    );
}
