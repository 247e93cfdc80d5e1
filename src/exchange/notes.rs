//! Notes of an import: values that were read or assumed, and warnings.

/// A note of an import.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Note {
    text: String,
    /// True for a warning: the study may be wrong.
    is_doubt: bool,
}

/// Notes of an import, in the order in which the importer makes them.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Notes(Vec<Note>);

impl Notes {
    /// Adds a note about a value that was read or assumed.
    pub fn push(&mut self, text: String) {
        self.0.push(Note {
            text,
            is_doubt: false,
        });
    }

    /// Adds notes about values that were read or assumed.
    pub(super) fn extend(&mut self, texts: impl IntoIterator<Item = String>) {
        texts.into_iter().for_each(|text| self.push(text));
    }

    /// Adds a warning: because of the described problem, the study may be wrong.
    pub(super) fn doubt(&mut self, text: String) {
        self.0.push(Note {
            text,
            is_doubt: true,
        });
    }

    /// Adds those notes that are not in this list yet.
    pub fn add(&mut self, others: &Notes) {
        for note in &others.0 {
            if !self.0.contains(note) {
                self.0.push(note.clone());
            }
        }
    }

    /// The same notes, each after the name of its subject.
    pub(super) fn about(&self, subject: &str) -> Notes {
        let notes = self.0.iter().map(|note| Note {
            text: format!("{subject}: {}", note.text),
            ..*note
        });
        Notes(notes.collect())
    }

    /// Texts of all notes.
    pub fn texts(&self) -> impl Iterator<Item = &str> {
        self.0.iter().map(|note| note.text.as_str())
    }

    /// Texts of the warnings, which state why the study may be wrong.
    pub fn doubts(&self) -> impl Iterator<Item = &str> {
        self.of_kind(true)
    }

    /// Texts of the notes about values that were read or assumed.
    pub fn facts(&self) -> impl Iterator<Item = &str> {
        self.of_kind(false)
    }

    fn of_kind(&self, is_doubt: bool) -> impl Iterator<Item = &str> {
        let own = self.0.iter().filter(move |note| note.is_doubt == is_doubt);
        own.map(|note| note.text.as_str())
    }
}
