//! What happened, in a sentence of each language: for clients, for the recording, and for the door.

use std::collections::VecDeque;
use std::sync::Arc;
use std::time::{Duration, Instant};

use serde_json::json;
use shisei_core::Lang;

use super::hub::Hub;
use super::input::unix_ns;
use super::recorder::Record;

/// Notes that wait for the door at most; then the oldest are forgotten.
const WAITING_MAX: usize = 64;
/// The same is told again after this time at the earliest: a device that stammers is heard once a second.
const AGAIN: Duration = Duration::from_secs(1);

/// How bad it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Level {
    /// As it should be.
    Info,
    /// Something to know.
    Warning,
    /// Something that was asked for is not done.
    Error,
}

impl Level {
    /// `info`, `warning`, `error`.
    pub fn name(self) -> &'static str {
        match self {
            Level::Info => "info",
            Level::Warning => "warning",
            Level::Error => "error",
        }
    }
}

/// What happened.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Note {
    /// How bad it is.
    pub level: Level,
    /// In English.
    pub en: String,
    /// In Japanese.
    pub ja: String,
}

impl Note {
    /// A note.
    pub fn new(level: Level, en: impl Into<String>, ja: impl Into<String>) -> Self {
        Note { level, en: en.into(), ja: ja.into() }
    }

    /// The sentence of a language.
    pub fn sentence(&self, lang: Lang) -> &str {
        match lang {
            Lang::En => &self.en,
            Lang::Ja => &self.ja,
        }
    }
}

/// Notes that wait for the door, and the newest with its time.
#[derive(Debug, Default)]
pub(super) struct Notes {
    waiting: VecDeque<Note>,
    newest: Option<(Note, Instant)>,
}

impl Notes {
    /// Takes a note; false where it has just been told.
    fn push(&mut self, note: &Note, now: Instant) -> bool {
        let again = |(told, at): &(Note, Instant)| told == note && now.saturating_duration_since(*at) < AGAIN;
        if self.newest.as_ref().is_some_and(again) {
            return false;
        }
        self.newest = Some((note.clone(), now));
        if self.waiting.len() >= WAITING_MAX {
            self.waiting.pop_front();
        }
        self.waiting.push_back(note.clone());
        true
    }
}

impl Hub {
    /// Tells clients, the recording and the door something.
    pub(super) fn note(&mut self, note: Note) {
        if !self.notes.push(&note, Instant::now()) {
            return;
        }
        let message =
            json!({"type": "note", "level": note.level.name(), "en": note.en, "ja": note.ja}).to_string();
        // without clients nobody hears it
        let _ = self.board.notes.send(Arc::from(message));
        if let Some(recorder) = &self.recorder {
            recorder.give(Record::Note(note.en, unix_ns()));
        }
    }

    /// The oldest note that the door has not heard.
    pub fn told(&mut self) -> Option<Note> {
        self.notes.waiting.pop_front()
    }
}
