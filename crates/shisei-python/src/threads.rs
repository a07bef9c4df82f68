//! Two pieces of work side by side.

use shisei_core::estimator::Pair;

/// The one on a thread of its own, the other on the caller's.
#[derive(Clone, Copy, Debug)]
pub struct SideBySide;

impl Pair for SideBySide {
    fn both<A: Send>(&self, other: impl FnOnce() -> A + Send, own: impl FnOnce()) -> A {
        std::thread::scope(|scope| {
            let other = scope.spawn(other);
            own();
            other.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
        })
    }
}
