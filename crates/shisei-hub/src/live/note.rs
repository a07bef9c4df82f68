//! What happened, in a sentence of each language: for clients, for the recording, and for the door.

use std::collections::VecDeque;
use std::sync::Arc;

use serde_json::json;
use shisei_core::Lang;

use super::hub::Hub;
use super::input::unix_ns;
use super::recorder::Record;

/// Notes that wait for the door at most; then the oldest are forgotten.
const WAITING_MAX: usize = 64;

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

/// Notes that wait for the door.
#[derive(Debug, Default)]
pub(super) struct ForDoor(VecDeque<Note>);

impl ForDoor {
    fn push(&mut self, note: Note) {
        if self.0.len() >= WAITING_MAX {
            self.0.pop_front();
        }
        self.0.push_back(note);
    }
}

impl Hub {
    /// Tells clients, the recording and the door something.
    pub(super) fn note(&mut self, note: Note) {
        let message =
            json!({"type": "note", "level": note.level.name(), "en": note.en, "ja": note.ja}).to_string();
        // without clients nobody hears it
        let _ = self.board.notes.send(Arc::from(message));
        if let Some(recorder) = &self.recorder {
            recorder.give(Record::Note(note.en.clone(), unix_ns()));
        }
        self.for_door.push(note);
    }

    /// The oldest note that the door has not heard.
    pub fn told(&mut self) -> Option<Note> {
        self.for_door.0.pop_front()
    }
}
