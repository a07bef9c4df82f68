//! `cargo xtask bench accuracy`: every estimator, and its peers from PyPI, against optical truth.

use std::path::Path;

use shisei_core::Quaternion;

use super::coverage;
use super::estimators::{Estimator, OURS};
use super::metrics::{Errors, judge};
use super::rates;
use super::trial::{self, Absent, Trial};
use crate::needs::Needs;
use crate::project::Project;
use crate::run::must;

/// Written by xtask/py/peers.py.
const PEERS: &[&str] = &["vqf", "vqf-offline", "imufusion"];

/// What the recordings need to be read; nothing where there are none.
pub fn needs(project: &Project) -> Needs {
    let there = project.data().is_some_and(|data| data.join("broad").is_dir());
    Needs { pip: if there { vec!["numpy", "polars"] } else { Vec::new() }, ..Needs::default() }
}

fn peer_needs() -> Needs {
    Needs { pip: vec!["numpy", "polars", "vqf", "imufusion"], ..Needs::default() }
}

/// Prints the tables; `words` may have `--install` and `--no-peers`.
pub fn command(project: &Project, words: &[&str]) -> Result<(), String> {
    let install = words.contains(&"--install");
    let mut peers = !words.contains(&"--no-peers");
    if let Some(unknown) = words.iter().find(|word| !["--install", "--no-peers"].contains(word)) {
        return Err(format!("`{unknown}` is not known; there are --install and --no-peers"));
    }
    if peers && let Err(reason) = peer_needs().ensure(project, "core", install) {
        println!("without peers: {}", reason.replace("test --install core", "bench accuracy --install"));
        peers = false;
    }
    needs(project).ensure(project, "core", install)?;
    let trials = trial::all(project).map_err(|absent| match absent {
        Absent::Data => {
            "the BROAD trials are absent; set SHISEI_DATA to the folder that holds `broad`".to_owned()
        }
        Absent::Reader(reason) => reason,
    })?;
    let mut table = Table { names: OURS.iter().map(|ours| ours.name).collect(), rows: Vec::new() };
    if peers {
        table.names.extend(PEERS);
    }
    for trial in &trials {
        eprintln!("{}", trial.name);
        let mut errors = OURS.iter().map(|ours| errors_of(ours, trial)).collect::<Result<Vec<_>, _>>()?;
        if peers {
            errors.extend(errors_of_peers(project, trial)?);
        }
        table.rows.push((trial.number().to_owned(), errors));
    }
    table.print();
    coverage::print(&trials)?;
    let mut apart = apart(&trials.iter().collect::<Vec<_>>())?;
    if peers {
        apart.extend(worse(&table));
    }
    apart.extend(rates::compare(project, &trials, peers)?);
    if apart.is_empty() { Ok(()) } else { Err(apart.join("\n")) }
}

/// Ours, whom no trial may show it much worse than, and how much.
const RIVALS: &[(&str, &str, f64)] = &[("shisei-online", "vqf", 1.1), ("shisei", "vqf-offline", 1.1)];

/// Trials on which ours has more than so many times the rival's inclination, or more than so many times its heading
/// error and a degree, a line each.
fn worse(table: &Table) -> Vec<String> {
    let mut lines = Vec::new();
    for (ours, rival, times) in RIVALS {
        let place = |name: &str| table.names.iter().position(|other| *other == name);
        let (Some(own), Some(other)) = (place(ours), place(rival)) else { continue };
        for (trial, errors) in &table.rows {
            let (own, other) = (&errors[own], &errors[other]);
            if own.aligned_deg > times * other.aligned_deg {
                let (a, b) = (own.aligned_deg, other.aligned_deg);
                lines.push(format!("trial {trial}: inclination of {ours} {a:.3} degrees, of {rival} {b:.3}"));
            }
            if own.heading_deg > times * other.heading_deg + 1.0 {
                let (a, b) = (own.heading_deg, other.heading_deg);
                lines.push(format!("trial {trial}: heading of {ours} {a:.2} degrees, of {rival} {b:.2}"));
            }
        }
    }
    lines
}

/// What is more than 3 % from the figure that independent code gives on the even trials, a line each.
fn apart(trials: &[&Trial]) -> Result<Vec<String>, String> {
    let even = |trial: &&&Trial| trial.number().parse::<u32>().is_ok_and(|number| number % 2 == 0);
    let even: Vec<&&Trial> = trials.iter().filter(even).collect();
    let mut lines = Vec::new();
    for estimator in OURS {
        let Some(expected_deg) = estimator.expected_deg else { continue };
        let errors = even.iter().map(|trial| errors_of(estimator, trial).map(|errors| errors.raw_deg));
        let found_deg = mean(&errors.collect::<Result<Vec<_>, _>>()?);
        println!("{:18} {found_deg:7.3} on the even trials, expected {expected_deg}", estimator.name);
        if (found_deg / expected_deg - 1.0).abs() > 0.03 {
            lines.push(format!("{}: {found_deg:.3} degrees, expected {expected_deg}", estimator.name));
        }
    }
    Ok(lines)
}

fn errors_of(estimator: &Estimator, trial: &Trial) -> Result<Errors, String> {
    let estimate =
        (estimator.run)(trial).map_err(|error| format!("{} on {}: {error}", estimator.name, trial.name))?;
    Ok(judge(trial, &estimate))
}

fn errors_of_peers(project: &Project, trial: &Trial) -> Result<Vec<Errors>, String> {
    let folder = project.target().join("broad").join("peers").join(&trial.name);
    std::fs::create_dir_all(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let mut python = project.command(project.venv_python());
    must(python.arg("xtask/py/peers.py").arg(&trial.file).arg(&folder))?;
    PEERS
        .iter()
        .map(|name| Ok(judge(trial, &quaternions(&folder.join(name).with_extension("q64"))?)))
        .collect()
}

pub(super) fn quaternions(file: &Path) -> Result<Vec<Quaternion>, String> {
    let bytes = std::fs::read(file).map_err(|error| format!("{}: {error}", file.display()))?;
    let numbers = trial::numbers(&bytes);
    Ok(numbers.chunks_exact(4).map(|q| Quaternion::new(q[0], q[1], q[2], q[3])).collect())
}

/// Errors of every estimator (columns) on every trial (rows).
struct Table {
    names: Vec<&'static str>,
    rows: Vec<(String, Vec<Errors>)>,
}

/// A column of [`Errors`] and what it is called.
type Measure = (&'static str, fn(&Errors) -> f64);

const MEASURES: &[Measure] = &[
    ("inclination RMSE, degrees, as estimated", |errors| errors.raw_deg),
    ("inclination RMSE, degrees, with the optics' 2.5 ms", |errors| errors.aligned_deg),
    ("heading RMSE against the movement's first second, degrees", |errors| errors.heading_deg),
    ("heading drift, degrees a minute", |errors| errors.drift_deg_min),
];

impl Table {
    fn print(&self) {
        for (title, pick) in MEASURES {
            println!("\n{title}");
            print!("{:6}", "trial");
            self.names.iter().for_each(|name| print!(" {:>width$}", name, width = width(name)));
            println!();
            for (trial, errors) in &self.rows {
                self.print_row(trial, errors.iter().map(pick));
            }
            self.print_row("mean", self.columns(*pick).iter().map(|column| mean(column)));
            self.print_row("median", self.columns(*pick).into_iter().map(median));
        }
    }

    fn columns(&self, pick: fn(&Errors) -> f64) -> Vec<Vec<f64>> {
        let column = |i: usize| self.rows.iter().map(|(_, errors)| pick(&errors[i])).collect();
        (0..self.names.len()).map(column).collect()
    }

    fn print_row(&self, first: &str, values: impl Iterator<Item = f64>) {
        print!("{first:6}");
        self.names
            .iter()
            .zip(values)
            .for_each(|(name, value)| print!(" {value:>width$.3}", width = width(name)));
        println!();
    }
}

fn width(name: &str) -> usize {
    name.len().max(7)
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let half = values.len() / 2;
    if values.len().is_multiple_of(2) { 0.5 * (values[half - 1] + values[half]) } else { values[half] }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_classic_filters_have_their_published_errors_on_the_even_trials() {
        let project = Project::here();
        let trials = match trial::all(&project) {
            Ok(trials) => trials,
            Err(Absent::Data) => {
                eprintln!("skipped: accuracy on BROAD: the recordings are absent (SHISEI_DATA)");
                return;
            }
            Err(Absent::Reader(reason)) if !project.ci => {
                eprintln!("skipped: accuracy on BROAD: {reason}");
                return;
            }
            Err(Absent::Reader(reason)) => panic!("{reason}"),
        };
        assert_eq!(trials.len(), 16, "trials are missing");
        let trials: Vec<&Trial> = trials.iter().collect();
        assert_eq!(apart(&trials).expect("the trials are sound"), Vec::<String>::new());
    }

    #[test]
    fn the_estimator_meets_its_targets_on_the_even_trials() {
        let Ok(trials) = trial::all(&Project::here()) else {
            eprintln!("skipped: the estimator on BROAD: the recordings or what reads them are absent");
            return;
        };
        // names, and the most of: inclination raw, aligned, drift
        for (name, raw, aligned, drift) in [
            ("shisei-online", 0.56, 0.37, 1.6),
            ("shisei", 0.56, 0.28, 1.1),
            ("shisei-light", 0.75, 0.56, 5.0),
        ] {
            let estimator = OURS.iter().find(|ours| ours.name == name).expect("it is listed");
            let errors: Vec<Errors> =
                trials.iter().map(|trial| errors_of(estimator, trial).expect("it runs")).collect();
            let of = |pick: fn(&Errors) -> f64| mean(&errors.iter().map(pick).collect::<Vec<_>>());
            let found = [of(|e| e.raw_deg), of(|e| e.aligned_deg), of(|e| e.drift_deg_min)];
            assert!(found[0] <= raw && found[1] <= aligned && found[2] <= drift, "{name}: {found:?}");
        }
        for (name, [tilt, heading]) in coverage::of(&trials).expect("it runs") {
            assert!(
                (0.5..=0.9).contains(&tilt) && (0.5..=0.9).contains(&heading),
                "{name}: {tilt} {heading}"
            );
        }
    }

    #[test]
    fn a_trial_that_is_worse_is_named() {
        let errors = |deg: f64, heading_deg: f64| Errors {
            raw_deg: deg,
            aligned_deg: deg,
            heading_deg,
            drift_deg_min: 0.0,
        };
        let row = |ours: Errors| ("16".to_owned(), vec![ours, errors(0.3, 4.0)]);
        let table = |ours: Errors| Table { names: vec!["shisei-online", "vqf"], rows: vec![row(ours)] };
        assert_eq!(worse(&table(errors(0.32, 5.3))), Vec::<String>::new());
        assert_eq!(worse(&table(errors(0.34, 5.3))).len(), 1);
        assert_eq!(worse(&table(errors(0.34, 5.5))).len(), 2);
    }

    #[test]
    fn the_median_is_the_middle() {
        assert_eq!(median(vec![3.0, 1.0, 2.0]), 2.0);
        assert_eq!(median(vec![4.0, 1.0, 2.0, 3.0]), 2.5);
    }
}
