//! Counting tests: what the runners print, added up.

use std::fmt;

/// Tests that passed, failed, were skipped.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    pub passed: usize,
    pub failed: usize,
    pub skipped: usize,
}

impl Tally {
    pub fn add(&mut self, other: Tally) {
        self.passed += other.passed;
        self.failed += other.failed;
        self.skipped += other.skipped;
    }

    /// Tests that really ran.
    pub fn ran(self) -> usize {
        self.passed + self.failed
    }
}

impl fmt::Display for Tally {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} passed, {} failed, {} skipped", self.passed, self.failed, self.skipped)
    }
}

/// What a line of `cargo test` adds: a result line, or a passing test that says it skipped itself.
pub fn cargo_line(line: &str) -> Option<Tally> {
    if is_skip(line) {
        // libtest counts such a test as passed on its result line, which comes later; see `settle`.
        return Some(Tally { skipped: 1, ..Tally::default() });
    }
    let rest = line.strip_prefix("test result: ")?;
    Some(Tally {
        passed: number_before(rest, " passed")?,
        failed: number_before(rest, " failed")?,
        skipped: number_before(rest, " ignored")?,
    })
}

/// True for the line by which a test says that it did nothing.
pub fn is_skip(line: &str) -> bool {
    line.trim_start().starts_with("skipped: ")
}

/// What the closing line of pytest says: `=== 3 passed, 1 skipped in 0.12s ===`.
pub fn pytest(output: &str) -> Option<Tally> {
    let line = output.lines().rev().find(|line| {
        line.contains(" in ") && [" passed", " failed", " skipped", " error"].iter().any(|w| line.contains(w))
    })?;
    let count = |word: &str| number_before(line, word).unwrap_or(0);
    let failed = count(" failed") + count(" error");
    Some(Tally { passed: count(" passed"), failed, skipped: count(" skipped") })
}

/// What the closing lines of Node's test runner say: `# pass 3` (tap) or `ℹ pass 3` (spec).
pub fn node(output: &str) -> Option<Tally> {
    let count = |word: &str| {
        output.lines().rev().find_map(|line| {
            let rest = line.trim().trim_start_matches(['#', 'ℹ']).trim_start();
            rest.strip_prefix(word)?.trim().parse().ok()
        })
    };
    Some(Tally {
        passed: count("pass ")?,
        failed: count("fail ")? + count("cancelled ").unwrap_or(0),
        skipped: count("skipped ").unwrap_or(0) + count("todo ").unwrap_or(0),
    })
}

/// A closing line of our own scripts: `3 passed, 0 failed`.
pub fn closing_line(output: &str) -> Option<Tally> {
    let line = output.lines().rev().find(|line| line.contains(" passed, "))?;
    let count = |word: &str| number_before(line, word);
    Some(Tally {
        passed: count(" passed")?,
        failed: count(" failed")?,
        skipped: count(" skipped").unwrap_or(0),
    })
}

fn number_before(text: &str, word: &str) -> Option<usize> {
    let before = &text[..text.find(word)?];
    let digits = before.rsplit(|c: char| !c.is_ascii_digit()).next()?;
    digits.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tally(passed: usize, failed: usize, skipped: usize) -> Tally {
        Tally { passed, failed, skipped }
    }

    #[test]
    fn a_cargo_result_line_is_read() {
        let line = "test result: FAILED. 12 passed; 3 failed; 1 ignored; 0 measured; 7 filtered out; finished in 0.1s";
        assert_eq!(cargo_line(line), Some(tally(12, 3, 1)));
        assert_eq!(cargo_line("test quaternion::tests::x ... ok"), None);
        assert_eq!(cargo_line("skipped: no recordings"), Some(tally(0, 0, 1)));
    }

    #[test]
    fn pytest_closing_lines_are_read() {
        assert_eq!(pytest("x\n==== 3 passed, 2 failed, 1 skipped in 0.12s ====\n"), Some(tally(3, 2, 1)));
        assert_eq!(pytest("1 failed, 2 passed, 1 error in 3.00s"), Some(tally(2, 2, 0)));
        assert_eq!(pytest("collected 0 items\n\n==== no tests ran in 0.01s ===="), None);
    }

    #[test]
    fn node_closing_lines_are_read() {
        let spec =
            "✔ digest\nℹ tests 4\nℹ suites 0\nℹ pass 2\nℹ fail 1\nℹ cancelled 0\nℹ skipped 1\nℹ todo 0\n";
        assert_eq!(node(spec), Some(tally(2, 1, 1)));
        assert_eq!(node("# tests 1\n# pass 1\n# fail 0\n# skipped 0\n"), Some(tally(1, 0, 0)));
        assert_eq!(node("nothing"), None);
    }
}
