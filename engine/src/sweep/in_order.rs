//! Runs work on all CPU threads and passes the results on in order, while the work continues.

use std::collections::VecDeque;
use std::ops::Range;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

/// Limit for each thread: number of pieces of work that have been started, but whose results have not been passed on yet.
const AHEAD: u64 = 8;

/// Processes the pieces of work with the numbers in `range` on the threads of the current rayon pool. Each thread has its own
/// worker. Any free thread passes the results to `take` in order, while the other threads continue. Only a few pieces per
/// thread wait in memory, however long the range is.
///
/// Ends early if `take` fails, or if `work` returns `None`. If `work` returns `None`, the results of all earlier pieces have
/// been passed on.
pub fn in_order<W, T: Send, E: Send>(
    range: Range<u64>,
    worker: impl Fn() -> W + Sync,
    work: impl Fn(&mut W, u64) -> Option<T> + Sync,
    take: impl FnMut(T) -> Result<(), E> + Send,
) -> Result<(), E> {
    let queue = Queue {
        most: AHEAD * rayon::current_num_threads() as u64,
        state: Mutex::new(QueueState {
            next: range.start,
            end: range.end,
            first: range.start,
            waiting: VecDeque::new(),
            take: Some(take),
            failed: None,
        }),
        changed: Condvar::new(),
    };
    rayon::broadcast(|_| {
        let mut own = None;
        // If this thread panics, all other threads must not wait for its result.
        let _ends = EndsOnPanic(&queue);
        while let Some(turn) = queue.turn() {
            match turn {
                Turn::Work(number) => {
                    let result = work(own.get_or_insert_with(&worker), number);
                    queue.put(number, result);
                }
                Turn::Take(result, mut take) => {
                    let taken = take(result);
                    queue.has_taken(taken, take);
                }
            }
        }
    });
    let state = queue.state.into_inner();
    let failed = state.unwrap_or_else(PoisonError::into_inner).failed;
    failed.map_or(Ok(()), Err)
}

/// Queue of the pieces of work: finished pieces, running pieces and pieces that have not been started.
struct Queue<T, F, E> {
    /// Largest number of pieces that have been started, but whose results have not been passed on yet.
    most: u64,
    state: Mutex<QueueState<T, F, E>>,
    changed: Condvar,
}

struct QueueState<T, F, E> {
    /// Number of the next piece to start.
    next: u64,
    /// End of the range: the number of the last piece plus 1.
    end: u64,
    /// Number of the first piece whose result has not been passed on. `waiting` holds the finished results from this
    /// piece on.
    first: u64,
    waiting: VecDeque<Option<Option<T>>>,
    /// Callback that takes results. `None` while a thread is using it.
    take: Option<F>,
    failed: Option<E>,
}

/// Next task of a thread.
enum Turn<T, F> {
    Work(u64),
    Take(T, F),
}

impl<T, F, E> Queue<T, F, E> {
    fn state(&self) -> MutexGuard<'_, QueueState<T, F, E>> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Returns the next task. `None` if all work is done.
    fn turn(&self) -> Option<Turn<T, F>> {
        let mut state = self.state();
        loop {
            if matches!(state.waiting.front(), Some(Some(_)))
                && let Some(take) = state.take.take()
            {
                let Some(result) = state.waiting.pop_front().flatten().flatten() else {
                    state.end_at_once();
                    self.changed.notify_all();
                    return None;
                };
                state.first += 1;
                return Some(Turn::Take(result, take));
            }
            if state.next < state.end && state.next - state.first < self.most {
                state.next += 1;
                state.waiting.push_back(None);
                return Some(Turn::Work(state.next - 1));
            }
            if state.next >= state.end && state.waiting.is_empty() {
                return None;
            }
            let changed = self.changed.wait(state);
            state = changed.unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Stores the result of a finished piece.
    fn put(&self, number: u64, result: Option<T>) {
        let mut state = self.state();
        // Results after an early end are dropped.
        if let Some(place) = number.checked_sub(state.first)
            && let Some(entry) = state.waiting.get_mut(place as usize)
        {
            *entry = Some(result);
        }
        self.changed.notify_all();
    }

    fn has_taken(&self, taken: Result<(), E>, take: F) {
        let mut state = self.state();
        state.take = Some(take);
        if let Err(error) = taken {
            state.failed = Some(error);
            state.end_at_once();
        }
        self.changed.notify_all();
    }
}

impl<T, F, E> QueueState<T, F, E> {
    fn end_at_once(&mut self) {
        self.end = self.next;
        self.waiting.clear();
    }
}

/// Ends the queue if the thread that owns this value panics.
struct EndsOnPanic<'q, T, F, E>(&'q Queue<T, F, E>);

impl<T, F, E> Drop for EndsOnPanic<'_, T, F, E> {
    fn drop(&mut self) {
        if std::thread::panicking() {
            self.0.state().end_at_once();
            self.0.changed.notify_all();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::convert::Infallible;
    use std::sync::atomic::{AtomicU64, Ordering};

    fn on_threads<T: Send>(threads: usize, run: impl FnOnce() -> T + Send) -> T {
        crate::threads::pool(threads).unwrap().install(run)
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
    fn few_results_wait_at_a_time() {
        let waiting = AtomicU64::new(0);
        let mut most = 0;
        let ended: Result<(), Infallible> = on_threads(3, || {
            in_order(
                0..500,
                || (),
                |(), n| Some((n, waiting.fetch_add(1, Ordering::SeqCst) + 1)),
                |(_, count)| {
                    most = most.max(count);
                    std::thread::sleep(std::time::Duration::from_micros(200));
                    waiting.fetch_sub(1, Ordering::SeqCst);
                    Ok(())
                },
            )
        });
        assert!(ended.is_ok());
        // The count includes the piece whose result is being passed on.
        assert!(most > 3 && most <= 3 * AHEAD + 1, "{most}");
    }

    #[test]
    fn a_panic_ends_it_for_all_threads() {
        let ended = std::panic::catch_unwind(|| {
            on_threads(2, || {
                let work = |_: &mut (), n: u64| match n {
                    100 => panic!("of the test"),
                    n => Some(n),
                };
                in_order(0..1_000_000, || (), work, |_| Ok::<(), Infallible>(()))
            })
        });
        assert!(ended.is_err());
    }

    #[test]
    fn a_failure_to_take_ends_the_work() {
        let take = |n: u64| if n < 5 { Ok(()) } else { Err(n) };
        let ended = on_threads(2, || in_order(0..1_000_000, || (), |(), n| Some(n), take));
        assert_eq!(ended, Err(5));
    }
}
