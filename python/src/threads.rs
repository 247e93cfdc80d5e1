//! Work on a pool of threads while the calling thread listens to Python: Ctrl-C, progress, callbacks.
//!
//! Pools are kept by process: the threads of a pool do not survive a fork, so a forked child that used its parent's pool
//! would wait forever.

use crate::errors::failure;
use hardpoint::threads::stoppable;
use pyo3::prelude::*;
use rayon::ThreadPool;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// Longest time between two checks for Ctrl-C.
pub(crate) const LISTEN: Duration = Duration::from_millis(50);

/// The pool that was used last, with its process and its number of threads.
static LAST: Mutex<Option<(u32, usize, Arc<ThreadPool>)>> = Mutex::new(None);

/// Refuses a number of threads below 1.
pub(crate) fn checked(threads: Option<usize>) -> PyResult<()> {
    match threads {
        Some(0) => Err(failure(
            "threads is 0; expected at least 1, or None for all",
        )),
        _ => Ok(()),
    }
}

/// A pool of this number of threads, at most one for each core; `None` is one for each core. A new number ends the threads of
/// the last pool when their work is done.
fn pool(threads: Option<usize>) -> PyResult<Arc<ThreadPool>> {
    checked(threads)?;
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let threads = threads.unwrap_or(cores).min(cores);
    let process = std::process::id();
    let mut last = LAST.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((of, count, pool)) = &*last
        && (*of, *count) == (process, threads)
    {
        return Ok(pool.clone());
    }
    let pool = hardpoint::threads::pool(threads);
    let pool = Arc::new(pool.map_err(|e| failure(format!("cannot start {threads} threads: {e}")))?);
    if let Some((of, _, former)) = last.replace((process, threads, pool.clone()))
        && of != process
    {
        // The threads of a parent process are not here and cannot be told to end.
        std::mem::forget(former);
    }
    Ok(pool)
}

/// Runs work that ends early when its flag is raised. The flag is raised by Ctrl-C and by an error of `listen`, which is called
/// on this thread about every 50 ms and once at the end. Returns when the work has ended: nothing is left running.
pub(crate) fn interruptible<T: Send>(
    py: Python<'_>,
    threads: Option<usize>,
    work: impl FnOnce(&AtomicBool) -> T + Send,
    mut listen: impl FnMut(Python<'_>, &AtomicBool) -> PyResult<()>,
) -> PyResult<T> {
    let pool = pool(threads)?;
    let flag = AtomicBool::new(false);
    // Raised by an exception alone: a callback that ends a tuning keeps what it has.
    let stop = Arc::new(AtomicBool::new(false));
    let (sender, mut ended) = channel();
    let mut found = None;
    let heard = pool.in_place_scope(|scope| {
        let (flag, stop, found) = (&flag, &stop, &mut found);
        scope.spawn(move |_| {
            let work = || stoppable(stop, || work(flag));
            *found = Some(catch_unwind(AssertUnwindSafe(work)));
            // The receiver waits for this or for the end of the sender.
            let _ = sender.send(());
        });
        let mut heard = Ok(());
        loop {
            let ended = &mut ended;
            let waited = py.detach(move || ended.recv_timeout(LISTEN));
            if heard.is_ok() {
                heard = py.check_signals().and_then(|()| listen(py, flag));
                if heard.is_err() {
                    flag.store(true, Ordering::Relaxed);
                    stop.store(true, Ordering::Relaxed);
                }
            }
            if waited != Err(RecvTimeoutError::Timeout) {
                break heard;
            }
        }
    });
    heard?;
    match found {
        Some(Ok(Some(found))) => Ok(found),
        Some(Ok(None)) => Err(failure("interrupted")),
        _ => Err(failure(
            "internal error: a thread panicked; standard error says where. Please report it with the study",
        )),
    }
}

/// As [`interruptible`], without progress.
pub(crate) fn on_threads<T: Send>(
    py: Python<'_>,
    threads: Option<usize>,
    work: impl FnOnce(&AtomicBool) -> T + Send,
) -> PyResult<T> {
    interruptible(py, threads, work, |_, _| Ok(()))
}

/// Runs a command of the program on a thread of its own. Ctrl-C stops the command, and its exception is returned.
pub(crate) fn command<T: Send>(py: Python<'_>, work: impl FnOnce() -> T + Send) -> PyResult<T> {
    let (sender, mut ended) = channel();
    let (heard, found) = std::thread::scope(|scope| {
        let running = scope.spawn(move || {
            let found = work();
            let _ = sender.send(());
            found
        });
        let mut heard = Ok(());
        loop {
            let ended = &mut ended;
            let waited = py.detach(move || ended.recv_timeout(LISTEN));
            if heard.is_ok() {
                heard = py.check_signals();
                if heard.is_err() {
                    hardpoint::cli::interrupt_embedded();
                }
            }
            if waited != Err(RecvTimeoutError::Timeout) {
                break (heard, running.join());
            }
        }
    });
    hardpoint::cli::forget_interrupt();
    heard?;
    found.map_err(|_| failure("internal error: the command panicked; standard error says where"))
}
