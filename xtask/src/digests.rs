//! The digest of the core on another target, held against the host's, a topic a check.

use shisei_digest::TOPICS;

use crate::run::Run;

/// Compares the lines `topic digest` that another target printed, in the order of the topics, `all digest` last.
pub fn compare(run: &mut Run<'_>, target: &str, printed: Result<String, String>) {
    let printed = match printed {
        Ok(text) => text,
        Err(reason) => return run.fail(&format!("digest on {target}"), &reason),
    };
    let theirs: Vec<&str> = printed.lines().filter_map(|line| line.split_whitespace().nth(1)).collect();
    let ours = TOPICS.iter().map(|topic| (topic.name, topic.digest()));
    let ours: Vec<(&str, u64)> = ours.chain([("all", shisei_digest::digest())]).collect();
    if theirs.len() != ours.len() {
        let reason = format!("{} digests where there are {}:\n{printed}", theirs.len(), ours.len());
        return run.fail(&format!("digest on {target}"), &reason);
    }
    for ((name, own), other) in ours.into_iter().zip(theirs) {
        run.check(&format!("digest of {name} on {target}"), same(own, other));
    }
}

fn same(own: u64, other: &str) -> Result<String, String> {
    let own = format!("{own:016x}");
    if own == other { Ok(own) } else { Err(format!("{other}, on the host {own}")) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::project::Project;

    fn printed(change: impl Fn(u64) -> u64) -> String {
        let mut lines: Vec<String> =
            TOPICS.iter().map(|topic| format!("{} {:016x}", topic.name, change(topic.digest()))).collect();
        lines.push(format!("all {:016x}", shisei_digest::digest()));
        lines.join("\n")
    }

    #[test]
    fn equal_digests_pass_and_one_that_differs_is_counted() {
        let project = Project::here();
        let mut run = Run::new(&project);
        compare(&mut run, "here", Ok(printed(|digest| digest)));
        assert_eq!((run.tally.passed, run.tally.failed), (TOPICS.len() + 1, 0));
        let first = TOPICS[0].digest();
        let mut run = Run::new(&project);
        compare(&mut run, "here", Ok(printed(|digest| if digest == first { digest ^ 1 } else { digest })));
        assert_eq!((run.tally.passed, run.tally.failed), (TOPICS.len(), 1));
    }

    #[test]
    fn a_target_that_stopped_early_fails() {
        let project = Project::here();
        let mut run = Run::new(&project);
        compare(&mut run, "here", Ok("math 0123".into()));
        assert_eq!((run.tally.passed, run.tally.failed), (0, 1));
    }
}
