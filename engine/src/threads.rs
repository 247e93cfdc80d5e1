//! Thread pools for the numerics, with stacks that are large enough for every compiler profile (debug and release), and
//! flags that stop the work.

use rayon::{ThreadPool, ThreadPoolBuildError, ThreadPoolBuilder};
use std::cell::{Cell, RefCell};
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// A flag that stops work. `None` for work that cannot be stopped.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Interrupt<'a>(pub(crate) Option<&'a AtomicBool>);

impl Interrupt<'_> {
    /// Returns true if the work must stop.
    #[inline]
    pub(crate) fn is_raised(self) -> bool {
        match self.0 {
            Some(flag) => flag.load(Ordering::Relaxed),
            None => false,
        }
    }
}

thread_local! {
    /// Flag that stops the work of this thread at its next checkpoint.
    static STOP: RefCell<Option<Arc<AtomicBool>>> = const { RefCell::new(None) };
}

/// Payload of the unwinding that stops work at a checkpoint.
struct Stopped;

/// Runs work on this thread. If the flag is raised, the work stops at its next checkpoint: between stations, steps of a
/// path, or equilibria. If the flag is already raised, the work does not begin. Returns `None` if the work was stopped.
/// Parallel tasks within the work check their own flags.
pub fn stoppable<T>(flag: &Arc<AtomicBool>, work: impl FnOnce() -> T) -> Option<T> {
    if flag.load(Ordering::Relaxed) {
        return None;
    }
    let outer = STOP.replace(Some(flag.clone()));
    let found = catch_unwind(AssertUnwindSafe(work));
    STOP.set(outer);
    match found {
        Ok(found) => Some(found),
        Err(payload) if payload.is::<Stopped>() => None,
        Err(payload) => resume_unwind(payload),
    }
}

/// Stops the work of this thread if its flag is raised ([`stoppable`]).
pub(crate) fn checkpoint() {
    let is_raised = |flag: &Option<Arc<AtomicBool>>| {
        flag.as_ref()
            .is_some_and(|flag| flag.load(Ordering::Relaxed))
    };
    if STOP.with_borrow(is_raised) {
        resume_unwind(Box::new(Stopped));
    }
}

/// Stack size of every thread in bytes. Without optimisation, every temporary takes space in the stack frame. At opt-level
/// 0 a sweep overflows 4 MiB, and a certificate overflows 10 MiB. Threads of rayon have 2 MiB, and a main thread usually
/// has 8 MiB. The engine does not control the compiler profile of a program that embeds it, and a stack overflow ends the
/// process. Unused pages only take address space.
const STACK: usize = 64 << 20;

thread_local! {
    /// True if this thread belongs to a pool from this module.
    static HAS_LARGE_STACK: Cell<bool> = const { Cell::new(false) };
}

/// Makes a pool with this number of threads; 0 selects rayon's default.
///
/// # Errors
/// Returns an error if the system cannot start the threads.
pub fn pool(threads: usize) -> Result<ThreadPool, ThreadPoolBuildError> {
    ThreadPoolBuilder::new()
        .num_threads(threads)
        .stack_size(STACK)
        .start_handler(|_| HAS_LARGE_STACK.set(true))
        .build()
}

/// Runs a task on a large stack, with this number of threads for parallel work. The task runs in a new pool, or on this
/// thread if this thread already belongs to a pool of this module. If the system cannot start a thread, the task runs on this
/// thread, whose stack may suffice.
pub(crate) fn on_large_stacks<T: Send>(threads: usize, run: impl FnOnce() -> T + Send) -> T {
    let own = if HAS_LARGE_STACK.get() {
        None
    } else {
        pool(threads).ok()
    };
    match own {
        Some(pool) => pool.install(run),
        None => run(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Recursive function that uses this number of KiB of stack.
    fn descend(kib: usize) -> usize {
        let frame = std::hint::black_box([1_u8; 1024]);
        match kib {
            0 => 0,
            _ => descend(kib - 1) + usize::from(frame[kib % 1024]),
        }
    }

    /// A stack of 8 MiB, or the 2 MiB of rayon's threads, would overflow in this test and end the process.
    #[test]
    fn stacks_are_larger_than_those_of_a_main_thread() {
        assert_eq!(on_large_stacks(1, || descend(12 << 10)), 12 << 10);
        let all = pool(2).unwrap().broadcast(|_| descend(12 << 10));
        assert_eq!(all, [12 << 10; 2]);
    }

    /// Work stops at the checkpoint after its flag is raised. The flag of inner work does not stop the work around it.
    #[test]
    fn work_ends_at_a_checkpoint() {
        let [outer, inner] = [(); 2].map(|()| Arc::new(AtomicBool::new(false)));
        let mut steps = 0;
        let found = stoppable(&outer, || {
            let found = stoppable(&inner, || {
                for step in 0..10 {
                    checkpoint();
                    steps += 1;
                    inner.store(step == 3, Ordering::Relaxed);
                }
            });
            assert_eq!(found, None);
            checkpoint();
            7
        });
        assert_eq!((found, steps), (Some(7), 4));
        checkpoint();
    }

    #[test]
    fn what_is_on_a_large_stack_stays_on_its_thread() {
        let id = || std::thread::current().id();
        assert_ne!(on_large_stacks(1, id), id());
        let (outer, inner, threads) = on_large_stacks(3, || {
            let (inner, threads) = on_large_stacks(1, || (id(), rayon::current_num_threads()));
            (id(), inner, threads)
        });
        assert_eq!((outer, threads), (inner, 3));
    }
}
