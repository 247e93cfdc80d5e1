//! Owner of a lock, named to others that want it.

use serde::{Deserialize, Serialize};
use std::fmt;

/// A process that writes somewhere.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Owner {
    /// Number.
    pub process: u32,
    /// The machine it runs on.
    pub host: String,
    /// Command line of the owner, as in `hardpoint sweep front`.
    pub command: String,
}

impl Owner {
    /// This process.
    pub fn here(command: &str) -> Self {
        Owner {
            process: std::process::id(),
            host: host(),
            command: command.to_owned(),
        }
    }
}

impl fmt::Display for Owner {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // What a file says reaches a terminal: no control characters.
        let plain = |text: &str| -> String {
            let visible = text.chars().map(|c| if c.is_control() { '?' } else { c });
            visible.take(200).collect()
        };
        write!(
            f,
            "`{}`, process {} on {}",
            plain(&self.command),
            self.process,
            plain(&self.host)
        )
    }
}

/// The name of this machine; the standard library does not know it.
fn host() -> String {
    let from_kernel = std::fs::read_to_string("/proc/sys/kernel/hostname").ok();
    let from_shell = || {
        let names = ["HOSTNAME", "COMPUTERNAME"];
        names.iter().find_map(|name| std::env::var(name).ok())
    };
    let name = from_kernel.or_else(from_shell).unwrap_or_default();
    match name.trim() {
        "" => "this machine".to_owned(),
        name => name.to_owned(),
    }
}
