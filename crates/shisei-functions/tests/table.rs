//! Every function of the table: its example, its errors, the limits of the doors that list it.

use shisei_functions::{
    Error, Expected, FUNCTIONS, Function, Input, Kind, Lang, Output, Range, Shape, VERSION,
};

fn inputs(f: &Function) -> Vec<Input<'static>> {
    f.example.args.iter().map(shisei_functions::ExampleArg::input).collect()
}

fn kind_of(f: &Function, inputs: &[Input<'_>]) -> Option<Kind> {
    f.call(inputs).err().and_then(Error::kind)
}

#[test]
fn every_example_holds() {
    let failures: Vec<String> = FUNCTIONS.iter().filter_map(example_fails).collect();
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

fn example_fails(f: &Function) -> Option<String> {
    let got = match f.call(&inputs(f)) {
        Ok(got) => got,
        Err(error) => return Some(format!("{}: {error}", f.name)),
    };
    let right = match (f.example.expected, &got) {
        (
            Expected::Numbers { data, cols, tolerance },
            Output::Numbers { data: mine, cols: my_cols, rows },
        ) => {
            (cols, data.len()) == (*my_cols, rows * cols)
                && data.iter().zip(mine).all(|(a, b)| (a - b).abs() <= tolerance)
        }
        (Expected::Truth(a), Output::Truth(b)) => a == *b,
        (Expected::Sentence, Output::Sentence(s)) => s.is_empty() || s == VERSION,
        _ => false,
    };
    (!right).then(|| format!("{}: expected {:?}\n   got {got:?}", f.name, f.example.expected))
}

#[test]
fn names_and_order_are_the_published_ones() {
    let published = include_str!("published_names.txt");
    let mine: Vec<String> = FUNCTIONS.iter().map(|f| format!("{} {}", f.name, f.export)).collect();
    for (line, mine) in published.lines().zip(&mine) {
        assert_eq!(line, mine);
    }
    assert_eq!(published.lines().count(), 44);
    let mut all: Vec<String> =
        FUNCTIONS.iter().flat_map(|f| [f.name, f.export]).map(str::to_lowercase).collect();
    all.sort();
    all.dedup();
    assert_eq!(all.len(), 2 * FUNCTIONS.len(), "a name twice");
}

#[test]
fn texts_fit_the_doors_that_show_them() {
    for f in &FUNCTIONS {
        for (en, ja) in [(f.doc.en, f.doc.ja), (f.returns.doc.en, f.returns.doc.ja)] {
            assert!(!en.is_empty() && !ja.is_empty(), "{}", f.name);
            assert!(en.encode_utf16().count() <= 250 && ja.encode_utf16().count() <= 250, "{}: {en}", f.name);
        }
        assert!(f.formula.starts_with(&format!("={}(", f.name)), "{}", f.formula);
        let names: usize = f.args.iter().map(|a| a.name.len() + 3).sum();
        assert!(names <= 255 && f.args.len() <= 20, "{}", f.name);
        for a in f.args {
            assert!(!a.doc.ja.is_empty() && !a.label.en.is_empty() && !a.label.ja.is_empty(), "{}", a.name);
            assert!(a.doc.en.encode_utf16().count() <= 200, "{}: {}", f.name, a.name);
        }
        let required = f.required();
        assert!(f.args[..required].iter().all(|a| a.default.is_none()), "{}: optional ones last", f.name);
    }
}

#[test]
fn a_missing_argument_names_itself_in_both_languages() {
    for f in FUNCTIONS.iter().filter(|f| f.required() > 0) {
        let inputs = inputs(f);
        let error = f.call(&inputs[..f.required() - 1]).unwrap_err();
        let name = f.args[f.required() - 1].name;
        assert_eq!(error, Error::Missing { arg: name }, "{}", f.name);
        assert!(error.sentence(Lang::En).contains(name) && error.sentence(Lang::Ja).contains(name));
    }
}

#[test]
fn too_many_arguments_are_refused() {
    for f in &FUNCTIONS {
        let many = vec![Input::Number(1.0); f.args.len() + 1];
        assert_eq!(kind_of(f, &many), Some(Kind::Shape), "{}", f.name);
    }
}

#[test]
fn wrong_shapes_are_shape_errors_and_name_the_argument() {
    let nine = [1.0; 9];
    let square = Input::Range(Range::new(&nine, 3, 3).unwrap());
    let empty = Input::Range(Range::new(&[], 0, 4).unwrap());
    for f in &FUNCTIONS {
        for (i, arg) in f.args.iter().enumerate() {
            for bad in [square, empty] {
                let fits = |s| matches!(s, Shape::Series(3) | Shape::SeriesEither(3, _));
                if bad == square && fits(arg.shape) {
                    continue;
                }
                let mut given = inputs(f);
                given.resize(given.len().max(i + 1), Input::Missing);
                given[i] = bad;
                let error = f.call(&given).unwrap_err();
                assert_eq!(error.kind(), Some(Kind::Shape), "{} {}: {error}", f.name, arg.name);
                assert!(error.sentence(Lang::En).contains(arg.name), "{}: {error}", f.name);
            }
        }
    }
}

#[test]
fn numbers_that_are_not_finite_are_domain_errors_save_where_asked_for() {
    for f in &FUNCTIONS {
        for (i, arg) in f.args.iter().enumerate() {
            let mut data = match f.example.args.get(i) {
                Some(shisei_functions::ExampleArg::Range { data, .. }) => data.to_vec(),
                _ => vec![0.0],
            };
            let cols = match f.example.args.get(i) {
                Some(shisei_functions::ExampleArg::Range { cols, .. }) => *cols,
                _ => 1,
            };
            let last = data.len() - 1;
            for bad in [f64::NAN, f64::INFINITY] {
                data[last] = bad;
                let mut given = inputs(f);
                given.resize(given.len().max(i + 1), Input::Missing);
                given[i] = Input::Range(Range::new(&data, data.len() / cols, cols).unwrap());
                if f.takes_not_finite {
                    assert_eq!(f.call(&given), Ok(Output::Truth(false)), "{}", f.name);
                } else {
                    let error = f.call(&given).unwrap_err();
                    assert_eq!(error.kind(), Some(Kind::Domain), "{} {}", f.name, arg.name);
                    let row = if arg.shape.is_number() { 1 } else { data.len() / cols };
                    assert!(error.sentence(Lang::En).contains(&format!("row {row}")), "{}: {error}", f.name);
                }
            }
        }
    }
}

#[test]
fn zero_quaternions_are_domain_errors_save_where_nothing_is_turned() {
    for f in &FUNCTIONS {
        for (i, arg) in f.args.iter().enumerate() {
            let (Shape::Vector(4) | Shape::Series(4)) = arg.shape else { continue };
            let mut given = inputs(f);
            given[i] = Input::Range(Range::new(&[0.0; 4], 1, 4).unwrap());
            if matches!(f.name, "ConjugateQuat" | "IsFiniteQuat") {
                assert!(f.call(&given).is_ok());
            } else {
                let error = f.call(&given).unwrap_err();
                assert_eq!(error.kind(), Some(Kind::Domain), "{}", f.name);
                assert!(error.sentence(Lang::Ja).contains(arg.name), "{}", f.name);
            }
        }
    }
}

#[test]
fn steps_and_gravity_must_be_positive() {
    for f in &FUNCTIONS {
        for (i, arg) in f.args.iter().enumerate().filter(|(_, a)| matches!(a.name, "dt" | "gravity")) {
            for bad in [0.0, -1.0] {
                let mut given = inputs(f);
                given.resize(given.len().max(i + 1), Input::Missing);
                given[i] = Input::Number(bad);
                assert_eq!(kind_of(f, &given), Some(Kind::Domain), "{} {}", f.name, arg.name);
            }
        }
    }
}

#[test]
fn columns_serve_as_rows_for_one_quaternion_or_vector() {
    for f in &FUNCTIONS {
        let row_wise = f.call(&inputs(f)).unwrap();
        let turned: Vec<Input<'_>> = inputs(f)
            .into_iter()
            .zip(f.args)
            .map(|(input, arg)| match (input, arg.shape) {
                (Input::Range(r), Shape::Vector(_) | Shape::VectorEither(..)) => {
                    Input::Range(Range::new(r.data(), r.cols(), r.rows()).unwrap())
                }
                (other, _) => other,
            })
            .collect();
        assert_eq!(f.call(&turned).unwrap(), row_wise, "{}", f.name);
    }
}

#[test]
fn defaults_are_what_the_signature_says() {
    for f in FUNCTIONS.iter().filter(|f| f.required() < f.args.len()) {
        let required = &inputs(f)[..f.required()];
        let mut spelled = required.to_vec();
        spelled.extend(f.args[f.required()..].iter().filter_map(|a| a.default).map(Input::Number));
        // compared as text, because not available is NaN
        let result = |inputs: &[Input<'_>]| format!("{:?}", f.call(inputs));
        assert_eq!(result(required), result(&spelled), "{}", f.name);
        let mut missing = required.to_vec();
        missing.resize(f.args.len(), Input::Missing);
        assert_eq!(result(required), result(&missing), "{}", f.name);
    }
}

#[test]
fn unequal_lengths_are_shape_errors() {
    for f in FUNCTIONS.iter().filter(|f| f.args.iter().filter(|a| a.shape == Shape::Series(3)).count() == 2) {
        let mut given = inputs(f);
        let i = f.args.iter().position(|a| a.name == "acc").unwrap();
        given[i] = Input::Range(Range::new(&[0.0, 0.0, 9.8], 1, 3).unwrap());
        assert_eq!(kind_of(f, &given), Some(Kind::Shape), "{}", f.name);
    }
}

#[test]
fn conditions_not_met_have_their_own_kind() {
    let f = shisei_functions::find("accs2initialquat").unwrap();
    let mut given = inputs(f);
    given[1] = Input::Number(1e-9);
    assert_eq!(kind_of(f, &given), Some(Kind::Condition));
    for name in ["GetBiasCalib", "GetIMUCalib"] {
        let f = shisei_functions::find(name).unwrap();
        let mut one_face = inputs(f);
        let Input::Range(all) = one_face[0] else { panic!() };
        one_face[0] = Input::Range(Range::new(&all.data()[..6 * 4], 4, 6).unwrap());
        let error = f.call(&one_face).unwrap_err();
        assert_eq!(error.kind(), Some(Kind::Condition), "{error}");
        assert!(error.to_string().contains("-x") || error.to_string().contains("−x"), "{error}");
        let mut narrow = inputs(f);
        narrow[7] = Input::Number(0.999);
        assert_eq!(kind_of(f, &narrow), Some(Kind::Condition));
    }
}
