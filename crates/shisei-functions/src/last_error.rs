//! The sentence behind the latest error.
//!
//! A cell error cannot say why. Doors record each refusal here: a C caller asks for its own thread's latest,
//! a sheet, which calculates on several threads, for the latest of all.

use crate::error::Error;
use shisei_core::Lang;
use std::cell::Cell;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

/// A refusal and the function that refused.
#[derive(Clone, Copy, Debug)]
struct Refusal {
    function: &'static str,
    error: Error,
}

thread_local! {
    static OF_THREAD: Cell<Option<Refusal>> = const { Cell::new(None) };
}
static OF_ALL: Mutex<Option<Refusal>> = Mutex::new(None);
static JAPANESE: AtomicBool = AtomicBool::new(false);

/// Keeps a refusal of the function with this worksheet name.
pub fn record(function: &'static str, error: Error) {
    let refusal = Some(Refusal { function, error });
    OF_THREAD.set(refusal);
    *OF_ALL.lock().unwrap_or_else(PoisonError::into_inner) = refusal;
}

/// The calling thread's latest sentence, empty when there was no error.
pub fn of_thread(lang: Lang) -> String {
    sentence(OF_THREAD.get(), lang)
}

/// The latest sentence of all threads, empty when there was no error.
pub fn of_all(lang: Lang) -> String {
    sentence(*OF_ALL.lock().unwrap_or_else(PoisonError::into_inner), lang)
}

/// The language of a user who cannot choose one in the call.
pub fn user_lang() -> Lang {
    if JAPANESE.load(Ordering::Relaxed) { Lang::Ja } else { Lang::En }
}

/// Sets the language of [`user_lang`]; a door does so when it starts.
pub fn set_user_lang(lang: Lang) {
    JAPANESE.store(lang == Lang::Ja, Ordering::Relaxed);
}

fn sentence(refusal: Option<Refusal>, lang: Lang) -> String {
    refusal.map_or_else(String::new, |r| format!("{}: {}", r.function, r.error.sentence(lang)))
}
