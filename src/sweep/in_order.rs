//! Work on all threads, its results taken in order while it runs.

use rayon::prelude::*;
use std::ops::Range;
use std::sync::Mutex;

/// Pieces of work that each thread has before it, between two hand-overs.
const AHEAD: u64 = 8;

/// Does the pieces of work numbered `range` on the threads of the current rayon pool, each thread with
/// a worker of its own, and hands the results to `take` in order: while one batch is worked on the one
/// before is taken, so that memory holds two batches, however long the range is.
///
/// Ends early when `take` fails, or when `work` returns `None`; then every piece before that one has
/// been taken.
pub fn in_order<W: Send, T: Send, E: Send>(
    range: Range<u64>,
    worker: impl Fn() -> W + Sync,
    work: impl Fn(&mut W, u64) -> Option<T> + Sync,
    mut take: impl FnMut(T) -> Result<(), E> + Send,
) -> Result<(), E> {
    let threads = rayon::current_num_threads();
    let workers: Vec<Mutex<Option<W>>> = (0..threads).map(|_| Mutex::new(None)).collect();
    let done = |number: u64| {
        let thread = rayon::current_thread_index().unwrap_or(0);
        // A thread never waits here: nothing it does meanwhile leads back.
        let mut place = workers[thread].lock().ok()?;
        work(place.get_or_insert_with(&worker), number)
    };
    let batch = AHEAD * threads as u64;
    let mut finished: Vec<Option<T>> = Vec::new();
    let mut next = range.start;
    loop {
        let end = range.end.min(next.saturating_add(batch));
        let (taken, results) = rayon::join(
            || -> Result<bool, E> {
                for result in finished {
                    match result {
                        Some(result) => take(result)?,
                        None => return Ok(false),
                    }
                }
                Ok(true)
            },
            || (next..end).into_par_iter().map(done).collect(),
        );
        // With nothing left to do the last batch has been taken, too.
        if !taken? || next == end {
            return Ok(());
        }
        (finished, next) = (results, end);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::convert::Infallible;

    fn on_threads<T: Send>(threads: usize, run: impl FnOnce() -> T + Send) -> T {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.unwrap().install(run)
    }

    #[test]
    fn results_come_in_order_from_any_number_of_threads() {
        for threads in [1, 2, 5] {
            for count in [0, 1, 7, 1000] {
                let mut taken = Vec::new();
                let ended: Result<(), Infallible> = on_threads(threads, || {
                    in_order(
                        3..3 + count,
                        || (),
                        |(), n| Some(n * n),
                        |n| {
                            taken.push(n);
                            Ok(())
                        },
                    )
                });
                assert!(ended.is_ok());
                assert!(taken.into_iter().eq((3..3 + count).map(|n| n * n)));
            }
        }
    }

    #[test]
    fn an_interruption_leaves_all_before_it() {
        let mut taken = Vec::new();
        let work = |_: &mut (), n: u64| (n < 37).then_some(n);
        let take = |n| {
            taken.push(n);
            Ok::<(), Infallible>(())
        };
        on_threads(2, || in_order(0..1000, || (), work, take)).unwrap();
        assert!(taken.into_iter().eq(0..37));
    }

    #[test]
    fn a_failure_to_take_ends_the_work() {
        let take = |n: u64| if n < 5 { Ok(()) } else { Err(n) };
        let ended = on_threads(2, || in_order(0..1_000_000, || (), |(), n| Some(n), take));
        assert_eq!(ended, Err(5));
    }
}
