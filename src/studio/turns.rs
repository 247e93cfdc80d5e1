//! Requests that a later request of the same page stops.
//!
//! A page that drags a point asks for one design after the other. If the search for an equilibrium takes long, the page asks for
//! the next design before it has the answer. The earlier search then stops at its next checkpoint.

use std::collections::HashMap;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Reason in the answer to a request that was stopped. The page has dropped the request by then.
pub(super) const STOPPED: &str = "a later request of the page has replaced this request";

/// Running request of each page: its number, and the flag that stops it.
#[derive(Default)]
pub(super) struct Turns(Mutex<HashMap<u64, (u64, Stop)>>);

/// Flag that stops a request.
pub(super) type Stop = Arc<AtomicBool>;

/// Registration of a running request. The registration is removed when this value is dropped.
pub(super) struct Turn<'t> {
    turns: &'t Turns,
    page: u64,
    pub stop: Stop,
}

impl Turns {
    /// Registers a request of a page, and stops the earlier request of this page. If a later request of the page has already
    /// arrived, this request is stopped itself.
    pub(super) fn begin(&self, [page, number]: [u64; 2]) -> Turn<'_> {
        let stop = Stop::default();
        let mut running = self.running();
        match running.get(&page) {
            Some((other, _)) if *other > number => stop.store(true, Ordering::Relaxed),
            _ => {
                if let Some((_, earlier)) = running.insert(page, (number, stop.clone())) {
                    earlier.store(true, Ordering::Relaxed);
                }
            }
        }
        Turn {
            turns: self,
            page,
            stop,
        }
    }

    fn running(&self) -> MutexGuard<'_, HashMap<u64, (u64, Stop)>> {
        // The registrations are complete even after a panic in a thread, so a poisoned lock is harmless.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Drop for Turn<'_> {
    fn drop(&mut self) {
        let mut running = self.turns.running();
        let is_own = |(_, stop): &(u64, Stop)| Arc::ptr_eq(stop, &self.stop);
        if running.get(&self.page).is_some_and(is_own) {
            running.remove(&self.page);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn is_stopped(turn: &Turn<'_>) -> bool {
        turn.stop.load(Ordering::Relaxed)
    }

    /// The later request of a page stops the earlier request, in whatever order they arrive. Requests of other pages continue.
    #[test]
    fn the_latest_request_of_a_page_goes_on() {
        let turns = Turns::default();
        let [first, other] = [[1, 5], [2, 1]].map(|turn| turns.begin(turn));
        let later = turns.begin([1, 6]);
        assert!(is_stopped(&first) && !is_stopped(&later) && !is_stopped(&other));
        drop(first);
        let late = turns.begin([1, 4]);
        assert!(is_stopped(&late) && !is_stopped(&later));
        drop(late);
        let latest = turns.begin([1, 7]);
        assert!(is_stopped(&later) && !is_stopped(&latest) && !is_stopped(&other));
        drop((later, latest, other));
        assert!(turns.running().is_empty());
    }
}
