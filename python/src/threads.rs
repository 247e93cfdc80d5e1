//! Thread pools of our own.
//!
//! They are kept by process and by number of threads: the threads of a pool do not survive a fork, so a forked
//! child that used its parent's pool would wait for ever.

use crate::errors::failure;
use pyo3::PyResult;
use rayon::ThreadPool;
use std::collections::HashMap;
use std::sync::{Arc, Mutex, OnceLock};

type Pools = Mutex<HashMap<(u32, usize), Arc<ThreadPool>>>;

/// Refuses a number of threads that is none.
pub(crate) fn checked(threads: Option<usize>) -> PyResult<()> {
    match threads {
        Some(0) => Err(failure(
            "threads is 0; expected at least 1, or None for all",
        )),
        _ => Ok(()),
    }
}

/// Runs something in a pool of so many threads; `None` is one for each processor.
pub(crate) fn on_threads<T: Send>(
    threads: Option<usize>,
    run: impl FnOnce() -> T + Send,
) -> PyResult<T> {
    static POOLS: OnceLock<Pools> = OnceLock::new();
    checked(threads)?;
    let cores = || std::thread::available_parallelism().map_or(1, usize::from);
    let threads = threads.unwrap_or_else(cores);
    let key = (std::process::id(), threads);
    let mut pools = POOLS
        .get_or_init(Pools::default)
        .lock()
        .unwrap_or_else(std::sync::PoisonError::into_inner);
    let pool = match pools.get(&key) {
        Some(pool) => pool.clone(),
        None => {
            let pool = hardpoint::threads::pool(threads);
            let pool = Arc::new(pool.map_err(|e| failure(format!("no threads: {e}")))?);
            pools.insert(key, pool.clone());
            pool
        }
    };
    drop(pools);
    Ok(pool.install(run))
}
