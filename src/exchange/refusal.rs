//! Reasons why a file is not imported: an error, or an open question that a flag answers.

use std::fmt;

/// Reason why a file is not imported.
#[derive(Clone, Debug, PartialEq)]
pub enum Refusal {
    /// An error in the file or the options.
    Wrong(String),
    /// A question that the file leaves open.
    Open(Question),
}

/// A question that the file leaves open, with the flags that answer it.
#[derive(Clone, Debug, PartialEq)]
pub struct Question {
    /// Text of the question, with its cause.
    pub reason: String,
    /// Possible answers: flags with their values.
    pub choices: Vec<(&'static str, String)>,
    /// Flag whose value the user can choose freely, and an example of its value. `None` if the answers in `choices` are the only
    /// ones.
    pub free: Option<(&'static str, &'static str)>,
}

impl Question {
    /// Question with these values of one flag as possible answers.
    pub(super) fn of(reason: String, flag: &'static str, values: &[&str]) -> Refusal {
        Refusal::Open(Question {
            reason,
            choices: values.iter().map(|v| (flag, (*v).to_owned())).collect(),
            free: None,
        })
    }
}

impl From<String> for Refusal {
    fn from(reason: String) -> Self {
        Refusal::Wrong(reason)
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let question = match self {
            Refusal::Wrong(reason) => return f.write_str(reason),
            Refusal::Open(question) => question,
        };
        let choices = question.choices.iter();
        let mut answers: Vec<String> = choices
            .map(|(flag, value)| format!("{flag} {}", for_shell(value)))
            .collect();
        answers.extend(
            question
                .free
                .map(|(flag, example)| format!("{flag} {example}")),
        );
        write!(f, "{}: give {}", question.reason, answers.join(" or "))
    }
}

/// Quotes a value for a shell if necessary.
pub fn for_shell(value: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "_-.,+/:=@%".contains(c);
    if !value.is_empty() && !value.starts_with('-') && value.chars().all(is_plain) {
        return value.to_owned();
    }
    format!("'{}'", value.replace('\'', "'\\''"))
}
