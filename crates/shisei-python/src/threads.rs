//! Two pieces of work side by side, and one thing for several threads.

use std::sync::{Mutex, MutexGuard, PoisonError};

use pyo3::prelude::*;
use pyo3::sync::MutexExt;
use shisei_core::estimator::Pair;

/// This thread's turn; while it waits, others may hold the GIL.
pub fn turn<'a, T>(of: &'a Mutex<T>, py: Python<'_>) -> MutexGuard<'a, T> {
    of.lock_py_attached(py).unwrap_or_else(PoisonError::into_inner)
}

/// The same where the GIL is not held.
pub fn turn_without_gil<T>(of: &Mutex<T>) -> MutexGuard<'_, T> {
    of.lock().unwrap_or_else(PoisonError::into_inner)
}

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
