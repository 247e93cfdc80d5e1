//! Owner of a lock: the process that holds it. Other processes that wait for the lock can show its command and machine.

use serde::{Deserialize, Serialize};
use std::fmt;

/// Process that writes to a directory.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Owner {
    /// Number of the process in the operating system.
    pub process: u32,
    /// Name of the machine.
    pub host: String,
    /// Command of the owner, usually with the name of the study, as in `hardpoint sweep front`.
    pub command: String,
}

impl Owner {
    /// Describes this process, which runs `command`.
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
        // The texts come from a lock file and reach a terminal, so control characters are replaced.
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

/// Name of this machine, from the kernel or the environment, because the standard library cannot read it. `this machine` without
/// a name.
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
