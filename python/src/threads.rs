//! Work on a pool of CPU threads, while the calling thread handles Ctrl-C, progress and callbacks of Python.
//!
//! Each process has its own pool, because the threads of a pool do not survive a fork. A forked child that used its parent's pool
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

/// The latest pool of CPU threads, with the id of its process and its number of threads.
static LAST: Mutex<Option<(u32, usize, Arc<ThreadPool>)>> = Mutex::new(None);

/// Refuses a number of CPU threads below 1.
pub(crate) fn checked(threads: Option<usize>) -> PyResult<()> {
    match threads {
        Some(0) => Err(failure(
            "threads is 0; expected at least 1, or None for all",
        )),
        _ => Ok(()),
    }
}

/// Returns a pool with this number of CPU threads, at most one per core. `None` means one per core. If the number changes, the
/// threads of the last pool end after their work.
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
        // After a fork, the threads of the former pool exist only in the parent process, so this process cannot end
        // them.
        std::mem::forget(former);
    }
    Ok(pool)
}

/// Runs work that ends early if its flag is raised. Ctrl-C and an error of `listen` raise the flag. `listen` is called on this
/// thread about every 50 ms and once at the end. The function returns after the work has ended, so no thread keeps running.
pub(crate) fn interruptible<T: Send>(
    py: Python<'_>,
    threads: Option<usize>,
    work: impl FnOnce(&AtomicBool) -> T + Send,
    mut listen: impl FnMut(Python<'_>, &AtomicBool) -> PyResult<()>,
) -> PyResult<T> {
    let pool = pool(threads)?;
    let flag = AtomicBool::new(false);
    // Only an exception raises the second flag, `stop`. A callback that ends a tuning raises only the first flag, `flag`, so that
    // the tuning keeps its present result.
    let stop = Arc::new(AtomicBool::new(false));
    let (sender, mut ended) = channel();
    let mut found = None;
    let heard = pool.in_place_scope(|scope| {
        let (flag, stop, found) = (&flag, &stop, &mut found);
        scope.spawn(move |_| {
            let work = || stoppable(stop, || work(flag));
            *found = Some(catch_unwind(AssertUnwindSafe(work)));
            // The receiver wakes on this message or when the sender is dropped.
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
            "internal error: a thread panicked; see standard error. Please report it with the \
             study",
        )),
    }
}

/// Runs work like [`interruptible`], but without progress.
pub(crate) fn on_threads<T: Send>(
    py: Python<'_>,
    threads: Option<usize>,
    work: impl FnOnce(&AtomicBool) -> T + Send,
) -> PyResult<T> {
    interruptible(py, threads, work, |_, _| Ok(()))
}

/// Runs a command of the program on a separate thread. Ctrl-C stops the command. The function then returns the exception, after
/// the command has ended.
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
    found.map_err(|_| failure("internal error: the command panicked; see standard error"))
}
