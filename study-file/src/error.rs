//! Errors in a study, each with its position in the file and a remedy.

use crate::parse::KeyPlaces;
use crate::source::advice;
use annotate_snippets::{AnnotationKind, Level, Renderer, Snippet};
use std::fmt;
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

/// A text that was read, with its name for messages.
#[derive(Debug, PartialEq)]
pub struct Source {
    /// Path of the file as the user wrote it.
    pub name: String,
    /// Content of the file.
    pub text: String,
}

/// One error in a study.
#[derive(Clone, Debug)]
pub struct StudyError {
    source: Arc<Source>,
    span: Option<Range<usize>>,
    key: Option<String>,
    message: String,
    help: Option<String>,
    related: Vec<(Range<usize>, String)>,
}

impl StudyError {
    /// Makes an error about the file as a whole.
    pub fn of_file(name: impl Into<String>, message: impl Into<String>) -> Self {
        let source = Source {
            name: name.into(),
            text: String::new(),
        };
        Self::new(Arc::new(source), None, message)
    }

    /// Makes an error at a position in the source, or about the source as a whole.
    pub fn new(
        source: Arc<Source>,
        span: Option<Range<usize>>,
        message: impl Into<String>,
    ) -> Self {
        StudyError {
            span: span.map(|s| within_line(&source.text, s)),
            source,
            key: None,
            message: message.into(),
            help: None,
            related: Vec::new(),
        }
    }

    /// Error of a study file that cannot be read. For a directory, the remedy names the studies in it.
    pub fn unread(path: &Path, reason: &str) -> Self {
        let mut error = StudyError::of_file(
            path.display().to_string(),
            format!("cannot be read: {reason}"),
        );
        let studies = ["optimised.toml", "study.toml"].map(|name| path.join(name));
        let studies = studies.iter().filter(|study| study.is_file());
        let studies: Vec<String> = studies.map(|study| study.display().to_string()).collect();
        if !studies.is_empty() {
            error.help(format!("give a study in it: {}", studies.join(" or ")));
        } else if let Some(advice) = advice(&error.source.name) {
            error.help(advice);
        }
        error
    }

    /// Sets the key that contains the error.
    pub fn key_named(&mut self, key: Option<String>) -> &mut Self {
        self.key = key;
        self
    }

    /// Adds a remedy.
    pub fn help(&mut self, help: impl Into<String>) -> &mut Self {
        self.help = Some(help.into());
        self
    }

    /// Adds another position that is related to the error.
    pub fn related(&mut self, span: Range<usize>, label: impl Into<String>) -> &mut Self {
        let span = within_line(&self.source.text, span);
        self.related.push((span, label.into()));
        self
    }

    /// Name of the file, as the user wrote it.
    pub fn file(&self) -> &str {
        &self.source.name
    }

    /// Line and column. Both count from 1; the column counts characters. `None` if the error concerns the file as a whole.
    pub fn position(&self) -> Option<(usize, usize)> {
        let before = self.source.text.get(..self.span.as_ref()?.start)?;
        let line_start = before.rfind('\n').map_or(0, |at| at + 1);
        Some((
            before.matches('\n').count() + 1,
            before[line_start..].chars().count() + 1,
        ))
    }

    /// Path of the key that contains the error, such as `optimise.variables[0].range`. `None` if no single key contains it.
    pub fn path(&self) -> Option<&str> {
        self.key.as_deref()
    }

    /// Text of the error, with the expected value.
    pub fn message(&self) -> &str {
        &self.message
    }

    /// Remedy for the error, if there is one.
    pub fn suggestion(&self) -> Option<&str> {
        self.help.as_deref()
    }

    /// Message with the file, the line number, the line itself, and a mark under the faulty text. If `colour` is true, the
    /// message has colours for a terminal.
    pub fn render(&self, colour: bool) -> String {
        let title = match &self.key {
            Some(key) => format!("{key}: {}", self.message),
            None => self.message.clone(),
        };
        let mut group = match &self.span {
            Some(span) => {
                let related = self.related.iter().map(|(span, label)| {
                    AnnotationKind::Context
                        .span(span.clone())
                        .label(label.as_str())
                });
                Level::ERROR.primary_title(title).element(
                    Snippet::source(self.source.text.as_str())
                        .path(self.source.name.as_str())
                        .annotation(AnnotationKind::Primary.span(span.clone()))
                        .annotations(related),
                )
            }
            None => {
                let title = format!("{}: {title}", self.source.name);
                annotate_snippets::Group::with_title(Level::ERROR.primary_title(title))
            }
        };
        if let Some(help) = &self.help {
            group = group.element(Level::HELP.message(help.as_str()));
        }
        let renderer = if colour {
            Renderer::styled()
        } else {
            Renderer::plain()
        };
        renderer.render(&[group])
    }
}

/// Returns the part of a span that lies in its first line, cut at character boundaries. Keeps excerpts short.
fn within_line(text: &str, span: Range<usize>) -> Range<usize> {
    let boundary = |mut at: usize| {
        at = at.min(text.len());
        while !text.is_char_boundary(at) {
            at -= 1;
        }
        at
    };
    let start = boundary(span.start);
    let line_end = text[start..]
        .find(['\r', '\n'])
        .map_or(text.len(), |n| start + n);
    start..boundary(span.end).clamp(start, line_end)
}

/// All errors of a study, at least one, in the order of their positions.
#[derive(Clone, Debug, thiserror::Error)]
#[error("{}", self.render(false))]
pub struct StudyErrors(Vec<StudyError>);

impl StudyErrors {
    /// All errors of the study.
    pub fn all(&self) -> &[StudyError] {
        &self.0
    }

    /// Text of all errors; see [`StudyError::render`].
    pub fn render(&self, colour: bool) -> String {
        let rendered: Vec<String> = self.0.iter().map(|e| e.render(colour)).collect();
        rendered.join("\n\n")
    }
}

impl From<StudyError> for StudyErrors {
    fn from(error: StudyError) -> Self {
        StudyErrors(vec![error])
    }
}

impl fmt::Display for StudyError {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(&self.render(false))
    }
}

impl std::error::Error for StudyError {}

/// Errors found so far in one study.
pub struct Problems {
    source: Arc<Source>,
    errors: Vec<StudyError>,
    /// Keys and values of the source, with their positions. They are read at the first error.
    keys: Option<KeyPlaces>,
}

impl Problems {
    /// Makes an empty list of errors.
    pub fn new(source: Arc<Source>) -> Self {
        Problems {
            source,
            errors: Vec::new(),
            keys: None,
        }
    }

    /// Records an error at a position in the study file.
    pub fn add(&mut self, span: Range<usize>, message: impl Into<String>) -> &mut StudyError {
        let source = &self.source;
        let keys = self.keys.get_or_insert_with(|| KeyPlaces::of(&source.text));
        let key = keys.key_at(span.start);
        let mut error = StudyError::new(self.source.clone(), Some(span), message);
        error.key_named(key);
        self.errors.push(error);
        self.errors.last_mut().expect("just pushed")
    }

    /// Records an error at a position in the study file. Returns `None` as the missing value.
    pub fn refuse<T>(&mut self, span: Range<usize>, message: impl Into<String>) -> Option<T> {
        self.add(span, message);
        None
    }

    /// Records errors found in another file.
    pub fn append(&mut self, errors: StudyErrors) {
        self.errors.extend(errors.0);
    }

    /// Returns the result if there is no error. Sorts the errors by their positions. Errors without a position come first.
    pub fn finish<T>(mut self, result: Option<T>) -> Result<T, StudyErrors> {
        match result {
            Some(result) if self.errors.is_empty() => Ok(result),
            _ => {
                self.errors
                    .sort_by_key(|e| e.span.as_ref().map_or(0, |span| span.start));
                Err(StudyErrors(self.errors))
            }
        }
    }
}
