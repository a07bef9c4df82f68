//! Prints what a file holds: `cargo run -p shisei-record --example look FILE…`.
use shisei_record::{Input, Lang, Options, inspect};

fn main() {
    let names: Vec<String> = std::env::args().skip(1).collect();
    let files: Vec<Vec<u8>> = names.iter().map(|n| std::fs::read(n).unwrap_or_default()).collect();
    let inputs: Vec<Input<'_>> =
        names.iter().zip(&files).map(|(name, bytes)| Input { name, bytes }).collect();
    let seen = match inspect(&inputs, &Options::default()) {
        Ok(seen) => seen,
        Err(error) => return println!("{}\n{}", error.sentence(Lang::En), error.sentence(Lang::Ja)),
    };
    println!("{} ({}); {}", seen.dialect, seen.dialect_name, seen.layout);
    for c in &seen.channels {
        println!(
            "  {:>2} {:40} {:10} {}{}",
            c.number,
            c.name,
            c.unit,
            c.role,
            if c.used { " *" } else { "" }
        );
    }
    if let Some(error) = seen.refusal {
        println!("refused: {}", error.sentence(Lang::En));
    }
    if let Some(r) = seen.recording {
        for note in r.assumptions.iter().chain(&r.warnings) {
            println!("- [{}] {}", note.code, note.sentence(Lang::En));
        }
        let mut findings = r.findings.clone();
        findings.gaps.truncate(2);
        println!("{findings:?}");
        println!("{:?} {:?} {:?}", &r.time_s[..3], r.acc_m_s2[0], r.gyro_rad_s[0]);
    }
}
