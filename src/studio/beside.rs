//! Two parts of an answer, computed at the same time.

use super::turns::{STOPPED, Stop};
use crate::threads::stoppable;
use std::panic::resume_unwind;
use std::thread::{Builder, scope};

/// Runs one task on a new thread and another task on this thread. Returns an error if the flag `stop` has stopped
/// one of the tasks.
pub(super) fn beside<A: Send, B>(
    stop: &Stop,
    aside: impl Fn() -> A + Sync,
    here: impl FnOnce() -> B,
) -> Result<(A, B), String> {
    let aside = || stoppable(stop, &aside);
    let (first, second) = scope(|scope| {
        let begun = Builder::new().spawn_scoped(scope, aside);
        let second = stoppable(stop, here);
        let first = match begun {
            Ok(thread) => thread.join().unwrap_or_else(|panic| resume_unwind(panic)),
            // If no thread can be started, this thread runs both tasks.
            Err(_) => aside(),
        };
        (first, second)
    });
    first.zip(second).ok_or_else(|| STOPPED.to_owned())
}
