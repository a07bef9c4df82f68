//! The committed recordings are what the generator writes, and what their users rely on.

use std::path::{Path, PathBuf};

use shisei_core::vector::{norm, sub};
use shisei_twin::{movements, recordings};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples")
}

#[test]
fn committed_files_are_what_the_generator_writes() {
    for file in recordings::files() {
        let committed = std::fs::read_to_string(folder().join(file.name)).unwrap_or_default();
        assert!(
            committed.replace("\r\n", "\n") == file.text,
            "examples/{} is stale; run: cargo run -p shisei-twin --example make_examples",
            file.name
        );
    }
}

/// The rows of a file's numbers from a column on.
fn columns(name: &str, first: usize) -> Vec<Vec<f64>> {
    let file = recordings::files().into_iter().find(|file| file.name == name).expect(name);
    let number = |cell: &str| cell.parse().expect("a number");
    file.text.lines().skip(1).map(|line| line.split(',').skip(first).map(number).collect()).collect()
}

fn mean(rows: &[Vec<f64>]) -> Vec<f64> {
    let columns = rows[0].len();
    (0..columns).map(|c| rows.iter().map(|row| row[c]).sum::<f64>() / rows.len() as f64).collect()
}

/// The manual's formulas use rows 2 to 301 as rest, 302 to 1672 as data: still through row 302.
#[test]
fn pelvis_suits_the_formulas_of_the_manual() {
    let text = &recordings::files()[0].text;
    assert!(text.starts_with("Time,Ax[m/s2],Ay[m/s2],Az[m/s2],Gx[rad/s],Gy[rad/s],Gz[rad/s],Temp\n31:27.8,"));
    assert!(text.lines().skip(1).all(|line| line.ends_with(",4095") && line.split(',').count() == 8));
    // The stamps of the manual's rows 301, 306 and 307.
    for (row, stamp) in [(301, "31:30.8"), (306, "31:30.8"), (307, "31:30.9")] {
        assert!(text.lines().nth(row - 1).is_some_and(|line| line.starts_with(stamp)), "row {row}");
    }
    let rows = columns("pelvis.csv", 1);
    assert!(rows.len() >= 1671);
    let rest = mean(&rows[..301]);
    assert!(norm(sub([rest[0], rest[1], rest[2]], movements::PELVIS_REST_M_S2)) < 0.05, "{rest:?}");
    for axis in 0..3 {
        let variance =
            rows[..300].iter().map(|row| (row[axis] - rest[axis]) * (row[axis] - rest[axis])).sum::<f64>()
                / 300.0;
        assert!(variance < 0.002, "{variance}");
    }
    let truth = columns("pelvis.truth.csv", 1);
    assert_eq!(truth.len(), rows.len());
    assert!(truth[..301].iter().all(|row| row == &truth[0]), "still through row 302");
    assert!(truth[1600..].iter().all(|row| row[4..] == [0.0; 3]), "still at the end");
}

#[test]
fn one_angle_of_the_pelvis_moves_at_a_time() {
    let truth = columns("pelvis.truth.csv", 1);
    let extent = |column: usize| {
        let values = truth.iter().map(|row| row[column].to_degrees());
        values.fold((0.0_f64, 0.0_f64), |(low, high), x| (low.min(x), high.max(x)))
    };
    for (column, low, high) in [(4, -36.0, 38.0), (5, -14.0, 42.0), (6, -19.0, 21.0)] {
        let (l, h) = extent(column);
        assert!((l - low).abs() < 0.05 && (h - high).abs() < 0.05, "{column}: {l} {h}");
    }
    for row in &truth {
        assert!(row[4..].iter().filter(|angle| angle.abs() > 1e-6).count() <= 1, "{row:?}");
    }
}

#[test]
fn six_face_rests_on_every_face() {
    let rows = columns("six-face.csv", 1);
    assert!(rows.len() >= 9240);
    let g = 9.80665;
    let faces = [[0., 0., g], [0., g, 0.], [0., 0., -g], [0., -g, 0.], [-g, 0., 0.], [g, 0., 0.]];
    for (k, face) in faces.into_iter().enumerate() {
        let rest = mean(&rows[1580 * k..1580 * k + 1300]);
        let off_by = norm(sub([rest[0], rest[1], rest[2]], face));
        // Tilted by 1° to 4°, and biased by 0.1 m/s².
        assert!(off_by > 0.1 && off_by < 0.8, "{face:?}: {rest:?}");
    }
}

#[test]
fn eight_directions_are_finite_and_eight() {
    let rows = columns("eight-directions.csv", 0);
    assert_eq!(rows.len(), 8);
    assert!(rows.iter().all(|row| row.len() == 3 && row.iter().all(|x| x.abs() < 1.1e-4)));
}
