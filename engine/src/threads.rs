//! Pools of threads for the numerics, with stacks that are large enough for every profile, and the flags that end their
//! work.

use rayon::{ThreadPool, ThreadPoolBuildError, ThreadPoolBuilder};
use std::cell::{Cell, RefCell};
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// A flag that ends work early; `None` if nothing can end it.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Interrupt<'a>(pub(crate) Option<&'a AtomicBool>);

impl Interrupt<'_> {
    /// Returns true if the work is to end.
    #[inline]
    pub(crate) fn is_raised(self) -> bool {
        match self.0 {
            Some(flag) => flag.load(Ordering::Relaxed),
            None => false,
        }
    }
}

thread_local! {
    /// Flag that ends the work of this thread at its next checkpoint.
    static STOP: RefCell<Option<Arc<AtomicBool>>> = const { RefCell::new(None) };
}

/// Payload of the unwinding that ends work at a checkpoint.
struct Stopped;

/// Runs work on this thread that ends at its next checkpoint when the flag is raised: between stations, steps of a path, and
/// equilibria. Returns `None` if it ended so. Parallel parts of the work ask their own flags.
pub fn stoppable<T>(flag: &Arc<AtomicBool>, work: impl FnOnce() -> T) -> Option<T> {
    let outer = STOP.replace(Some(flag.clone()));
    let found = catch_unwind(AssertUnwindSafe(work));
    STOP.set(outer);
    match found {
        Ok(found) => Some(found),
        Err(payload) if payload.is::<Stopped>() => None,
        Err(payload) => resume_unwind(payload),
    }
}

/// Ends the work of this thread if it is to stop ([`stoppable`]).
pub(crate) fn checkpoint() {
    let is_raised = |flag: &Option<Arc<AtomicBool>>| {
        flag.as_ref()
            .is_some_and(|flag| flag.load(Ordering::Relaxed))
    };
    if STOP.with_borrow(is_raised) {
        resume_unwind(Box::new(Stopped));
    }
}

/// Bytes of stack of every thread. Without optimisation every temporary has its own place in a frame: at opt-level 0 a sweep
/// overflows 4 MiB and a certificate 10 MiB. (Threads of rayon have 2 MiB, a main thread usually 8.) The profile of an
/// embedding program is outside the engine's control, and a stack overflow ends the process. Untouched pages take address
/// space only.
const STACK: usize = 64 << 20;

thread_local! {
    /// True if this thread belongs to a pool that was made here.
    static HAS_LARGE_STACK: Cell<bool> = const { Cell::new(false) };
}

/// A pool with this number of threads; 0 for rayon's default.
///
/// # Errors
/// The system cannot start the threads.
pub fn pool(threads: usize) -> Result<ThreadPool, ThreadPoolBuildError> {
    ThreadPoolBuilder::new()
        .num_threads(threads)
        .stack_size(STACK)
        .start_handler(|_| HAS_LARGE_STACK.set(true))
        .build()
}

/// Runs a task on a large stack, with this number of threads for its parallel parts. It uses a pool of its own, or this
/// thread if it belongs to such a pool already. If no thread can be started, it also runs on this thread, whose stack may
/// suffice.
pub(crate) fn on_large_stacks<T: Send>(threads: usize, run: impl FnOnce() -> T + Send) -> T {
    let own = match HAS_LARGE_STACK.get() {
        true => None,
        false => pool(threads).ok(),
    };
    match own {
        Some(pool) => pool.install(run),
        None => run(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Touches so many KiB of stack.
    fn descend(kib: usize) -> usize {
        let frame = std::hint::black_box([1_u8; 1024]);
        match kib {
            0 => 0,
            _ => descend(kib - 1) + usize::from(frame[kib % 1024]),
        }
    }

    /// A stack of 8 MiB, let alone the 2 MiB of rayon's threads, would end this test's process.
    #[test]
    fn stacks_are_larger_than_those_of_a_main_thread() {
        assert_eq!(on_large_stacks(1, || descend(12 << 10)), 12 << 10);
        let all = pool(2).unwrap().broadcast(|_| descend(12 << 10));
        assert_eq!(all, [12 << 10; 2]);
    }

    /// Work ends at the checkpoint after the flag is raised, and outer work only by its own flag.
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
