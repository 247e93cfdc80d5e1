//! Errors in a study, each with its position in the file and a remedy.

use crate::parse::KeyPlaces;
use crate::source::{absent_study, advice};
use crate::value::Number;
use annotate_snippets::{AnnotationKind, Level, Renderer, Snippet};
use std::fmt;
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;
use toml::Spanned;

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

    /// Error of a study file that cannot be read. For a directory, the remedy names the studies in it. For a file that does not
    /// exist, it names a study with a similar name.
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
        } else if let Some(help) = absent_study(path) {
            error.help(help);
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
        self.rendered(colour, &mut LastLine::default())
    }

    fn rendered(&self, colour: bool, last: &mut LastLine) -> String {
        let title = match &self.key {
            Some(key) => format!("{key}: {}", self.message),
            None => self.message.clone(),
        };
        let mut group = match &self.span {
            Some(span) => {
                let text = self.source.text.as_str();
                let excerpt = self.excerpt(span);
                let first = excerpt.start;
                let within = |span: &Range<usize>| span.start - first..span.end - first;
                let related = self.related.iter().map(|(span, label)| {
                    AnnotationKind::Context
                        .span(within(span))
                        .label(label.as_str())
                });
                Level::ERROR.primary_title(title).element(
                    Snippet::source(&text[excerpt])
                        .line_start(last.number(&self.source, first))
                        .path(self.source.name.as_str())
                        .annotation(AnnotationKind::Primary.span(within(span)))
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

    /// Lines with the error and its related positions. The renderer reads its whole source, so it gets only these lines.
    fn excerpt(&self, span: &Range<usize>) -> Range<usize> {
        let text = &self.source.text;
        let spans = || self.related.iter().map(|(span, _)| span).chain([span]);
        let first = spans().map(|span| span.start).min().unwrap_or(span.start);
        let last = spans().map(|span| span.end).max().unwrap_or(span.end);
        // The renderer shows an error after the last line end in the last line.
        let inside = text[..first].trim_end_matches(['\r', '\n']).len();
        let first = if first == text.len() { inside } else { first };
        let begin = text[..first].rfind('\n').map_or(0, |at| at + 1);
        let end = text[last..]
            .find('\n')
            .map_or(text.len(), |at| last + at + 1);
        begin..end
    }
}

/// Line of the position that was counted last. If the positions increase, all of them are counted in one pass over the text.
#[derive(Default)]
struct LastLine(Option<(Arc<Source>, usize, usize)>);

impl LastLine {
    /// Number of the line with this position, from 1.
    fn number(&mut self, source: &Arc<Source>, at: usize) -> usize {
        let known = self.0.as_ref();
        let known = known.filter(|(own, place, _)| Arc::ptr_eq(own, source) && *place <= at);
        let (place, line) = known.map_or((0, 1), |(_, place, line)| (*place, *line));
        let line = line + source.text[place..at].matches('\n').count();
        self.0 = Some((source.clone(), at, line));
        line
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
        let mut last = LastLine::default();
        let rendered = self.0.iter().map(|e| e.rendered(colour, &mut last));
        let rendered: Vec<String> = rendered.collect();
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

    /// Records an error about a list with a wrong number of values. Returns `None` as the missing value. If decimal commas explain
    /// the number of values, the help says so. `expected` is the correct number of values.
    pub fn refuse_count<T>(
        &mut self,
        list: &Spanned<Vec<Number>>,
        expected: usize,
        message: impl Into<String>,
    ) -> Option<T> {
        let values = list.get_ref();
        let are_whole = values.iter().all(|number| number.value.fract() == 0.0);
        let error = self.add(list.span(), message);
        if let [whole, fraction, ..] = &values[..]
            && values.len() == 2 * expected
            && are_whole
        {
            let [whole, fraction] = [whole.value, fraction.value];
            error.help(format!(
                "are these decimal commas? Write {whole}.{fraction} instead of {whole},{fraction}"
            ));
        }
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

#[cfg(test)]
mod tests {
    use super::*;

    /// The excerpt has the same lines, numbers and marks as the whole text.
    #[test]
    fn an_excerpt_shows_the_same_as_the_whole_text() {
        for text in ["a = 1\nbé = 2\r\n\nc = [1,\n  2]\n", "a = 1\r\n\r\n", "a"] {
            let source = Arc::new(Source {
                name: "study.toml".to_owned(),
                text: text.to_owned(),
            });
            let mut last = LastLine::default();
            let places = || (0..=text.len()).filter(|at| text.is_char_boundary(*at));
            for at in places() {
                for other in places() {
                    let mut error = StudyError::new(source.clone(), Some(at..at + 1), "wrong");
                    error.related(other..other + 1, "here");
                    let [own, related] = [error.span.clone().unwrap(), error.related[0].0.clone()];
                    let whole = Snippet::source(text)
                        .path("study.toml")
                        .annotation(AnnotationKind::Primary.span(own))
                        .annotation(AnnotationKind::Context.span(related).label("here"));
                    let whole = Level::ERROR.primary_title("wrong").element(whole);
                    let whole = Renderer::plain().render(&[whole]);
                    assert_eq!(
                        error.rendered(false, &mut last),
                        whole,
                        "{text:?} {at} {other}"
                    );
                }
            }
        }
    }
}
