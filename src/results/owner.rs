//! Owner of a lock. Other processes that wait for the lock can show the name of the owner.

use serde::{Deserialize, Serialize};
use std::fmt;

/// Process that writes to a directory.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Owner {
    /// Process number.
    pub process: u32,
    /// Name of the machine.
    pub host: String,
    /// Command of the owner, usually with the name of the study, as in `hardpoint sweep front`.
    pub command: String,
}

impl Owner {
    /// Describes this process.
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
        // The text of a file reaches a terminal, so control characters are replaced.
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

/// Name of this machine. The standard library cannot read it.
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
