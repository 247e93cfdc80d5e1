//! Mistakes in a study, with their place and remedy.

use annotate_snippets::{AnnotationKind, Level, Renderer, Snippet};
use std::fmt;
use std::ops::Range;
use std::sync::Arc;

/// A text that was read, by the name it goes by in messages.
#[derive(Debug, PartialEq)]
pub struct Source {
    /// The file's path as the user wrote it.
    pub name: String,
    /// Content of the file.
    pub text: String,
}

/// One mistake in a study.
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
    /// A mistake in the file as a whole.
    pub fn of_file(name: impl Into<String>, message: impl Into<String>) -> Self {
        let source = Source {
            name: name.into(),
            text: String::new(),
        };
        Self::new(Arc::new(source), None, message)
    }

    /// A mistake at a place, or in the source as a whole.
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

    /// Names the key the mistake is in.
    pub fn key_named(&mut self, key: Option<String>) -> &mut Self {
        self.key = key;
        self
    }

    /// Adds a remedy.
    pub fn help(&mut self, help: impl Into<String>) -> &mut Self {
        self.help = Some(help.into());
        self
    }

    /// Shows another place that has to do with it.
    pub fn related(&mut self, span: Range<usize>, label: impl Into<String>) -> &mut Self {
        let span = within_line(&self.source.text, span);
        self.related.push((span, label.into()));
        self
    }

    /// The file it is in, as the user wrote its name.
    pub fn file(&self) -> &str {
        &self.source.name
    }

    /// Line and column, both from 1, the column in characters; `None` if the mistake concerns the file as a whole.
    pub fn position(&self) -> Option<(usize, usize)> {
        let before = self.source.text.get(..self.span.as_ref()?.start)?;
        let line_start = before.rfind('\n').map_or(0, |at| at + 1);
        Some((
            before.matches('\n').count() + 1,
            before[line_start..].chars().count() + 1,
        ))
    }

    /// The key it is in, like `optimise.variables[0].range`.
    pub fn path(&self) -> Option<&str> {
        self.key.as_deref()
    }

    /// The mistake and the expected value.
    pub fn message(&self) -> &str {
        &self.message
    }

    /// The remedy.
    pub fn suggestion(&self) -> Option<&str> {
        self.help.as_deref()
    }

    /// The message with file, line, the line itself and the faulty part underlined; in colour for a terminal.
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

/// The part of a span that is on its first line, on character boundaries: excerpts stay short.
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

/// Everything that is wrong with a study; at least one mistake, in the order of the file.
#[derive(Clone, Debug, thiserror::Error)]
#[error("{}", self.render(false))]
pub struct StudyErrors(Vec<StudyError>);

impl StudyErrors {
    /// The mistakes.
    pub fn all(&self) -> &[StudyError] {
        &self.0
    }

    /// All of them, rendered; see [`StudyError::render`].
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

/// The mistakes found so far in one study.
pub struct Problems {
    source: Arc<Source>,
    errors: Vec<StudyError>,
}

impl Problems {
    /// An empty list of mistakes.
    pub fn new(source: Arc<Source>) -> Self {
        Problems {
            source,
            errors: Vec::new(),
        }
    }

    /// Records a mistake at a place of the study file.
    pub fn add(&mut self, span: Range<usize>, message: impl Into<String>) -> &mut StudyError {
        let key = crate::parse::key_at(&self.source.text, span.start);
        let mut error = StudyError::new(self.source.clone(), Some(span), message);
        error.key_named(key);
        self.errors.push(error);
        self.errors.last_mut().expect("just pushed")
    }

    /// Records a mistake at a place of the study file and returns no value.
    pub fn refuse<T>(&mut self, span: Range<usize>, message: impl Into<String>) -> Option<T> {
        self.add(span, message);
        None
    }

    /// Records mistakes found in another file.
    pub fn append(&mut self, errors: StudyErrors) {
        self.errors.extend(errors.0);
    }

    /// Returns the result if there is no mistake.
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
