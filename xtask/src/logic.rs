//! The node's logic on an emulated Cortex-M4F: the bits of its packets, and what a sample costs.

use std::time::Duration;

use crate::cross::CORTEX_M4F;
use crate::project::Project;
use crate::run::{Run, must, output_of, output_within};
use crate::virtual_bluetooth;

/// The emulated board, up to the program.
pub const QEMU: [&str; 6] =
    ["-M", "mps2-an386", "-nographic", "-semihosting-config", "enable=on,target=native", "-kernel"];

/// Of a filter, instructions a sample: 10 % and 50 % of 64 MHz at 120 Hz.
const MEAN_MAX: u64 = 53_000;
const WORST_MAX: u64 = 260_000;

/// Compares packets bit by bit (as a hash), and prints instructions a sample.
pub fn compare(run: &mut Run<'_>) {
    let both = host(run.project).and_then(|ours| emulated(run.project).map(|theirs| (ours, theirs)));
    let (ours, theirs) = match both {
        Ok(both) => both,
        Err(reason) => return run.fail("the node's logic", &reason),
    };
    if ours.lines().count() == 0 || ours.lines().count() != theirs.lines().count() {
        return run.fail("the node's logic", &format!("{theirs}\non the host\n{ours}"));
    }
    for (own, other) in ours.lines().zip(theirs.lines()) {
        let name = own.split_whitespace().next().unwrap_or_default();
        // The host's line begins with name, bits and samples; the board's goes on with instructions.
        let same = other.strip_prefix(own).ok_or(format!("{other}, on the host {own}"));
        run.check(&format!("packets with filter {name}"), same.map(|_| own.to_owned()));
        run.check(&format!("instructions with filter {name}"), judge(other));
    }
}

fn judge(line: &str) -> Result<String, String> {
    let number = |word: &str| -> Option<u64> {
        let mut words = line.split_whitespace().skip_while(|found| *found != word);
        words.nth(1)?.parse().ok()
    };
    let (Some(mean), Some(worst), Some(whole)) = (number("mean"), number("worst"), number("whole")) else {
        return Err(format!("no counts in {line}"));
    };
    let text = format!("mean {mean}, worst {worst} a sample; with integration and packets {whole}");
    if mean <= MEAN_MAX && worst <= WORST_MAX {
        Ok(text)
    } else {
        Err(format!("{text}; the limits are {MEAN_MAX} and {WORST_MAX}"))
    }
}

fn host(project: &Project) -> Result<String, String> {
    output_of(&mut virtual_bluetooth::program(project, "logic")?)
}

/// Builds what [`compare`] runs on the board.
pub fn build(project: &Project) -> Result<(), String> {
    must(CORTEX_M4F.cargo_build(project).arg("--locked").current_dir(project.root.join("firmware/logic")))
}

fn emulated(project: &Project) -> Result<String, String> {
    build(project)?;
    let mut qemu = project.command("qemu-system-arm");
    qemu.args(["-icount", "shift=0"]).args(QEMU).arg(CORTEX_M4F.products(project).join("logic-firmware"));
    output_within(&mut qemu, Duration::from_secs(300))
}

#[cfg(test)]
mod tests {
    use super::judge;

    #[test]
    fn limits_are_held() {
        assert!(judge("f 00 9 samples, filter mean 52999 worst 260000 whole 90000").is_ok());
        assert!(judge("f 00 9 samples, filter mean 53001 worst 9 whole 90000").is_err());
        assert!(judge("f 00 9 samples, filter mean 9 worst 260001 whole 90000").is_err());
        assert!(judge("f 00 9 samples").is_err());
    }
}
