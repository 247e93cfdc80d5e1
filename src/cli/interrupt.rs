//! Signals. The first one stops the command, the second one ends the process at once.
//!
//! A command that has something to keep looks at the [`flag`], stops, and writes it. Every other one ends where it is:
//! between two writes, and with its directories recorded as interrupted. Neither takes longer than [`MOST_WORK`].

use super::terminal;
use crate::results::exit_interrupted;
use std::sync::atomic::{AtomicBool, AtomicI32, Ordering};
use std::sync::mpsc;
use std::sync::{Arc, LazyLock, Once};
use std::thread;
use std::time::{Duration, Instant};

/// Processor time within which a command stops by itself.
const MOST_WORK: Duration = Duration::from_millis(200);

/// Time in which it does so where it waits for others: for the disk, or for whoever reads its output.
const MOST_WAIT: Duration = Duration::from_secs(2);

/// Interval between checks of both.
const LOOK: Duration = Duration::from_millis(5);

/// Time limit for a last line on standard error.
const LAST_WORDS: Duration = Duration::from_millis(20);

static FLAG: AtomicBool = AtomicBool::new(false);
/// The first signal's number; 0 before it.
static SIGNAL: AtomicI32 = AtomicI32::new(0);
/// True if this module listens to signals; inside another program that does.
static LISTENS: AtomicBool = AtomicBool::new(false);
/// The number of SIGINT.
const INTERRUPT: i32 = 2;
static STOPS_BY_ITSELF: AtomicBool = AtomicBool::new(false);
/// Ends a command inside another program that does not stop by itself.
static STOP: LazyLock<Arc<AtomicBool>> = LazyLock::new(Arc::default);

/// True from the first signal on.
pub(super) fn flag() -> &'static AtomicBool {
    &FLAG
}

/// Returns true if a signal has arrived.
pub(super) fn is_raised() -> bool {
    FLAG.load(Ordering::SeqCst)
}

/// Declares that the command checks the flag and stops by itself.
pub(super) fn stops_by_itself() {
    STOPS_BY_ITSELF.store(true, Ordering::SeqCst);
}

/// Exit code of a command that a signal has stopped: 128 and the signal's number.
pub(super) fn exit_code() -> u8 {
    let signal = SIGNAL.load(Ordering::SeqCst);
    u8::try_from(128 + signal).unwrap_or(u8::MAX)
}

/// Payload of the unwinding that ends a command inside another program.
pub(super) struct Ended;

/// Ends the command, where a signal has come and there is nothing to keep: with the process, or inside another program by
/// unwinding.
pub(super) fn end() -> ! {
    if !LISTENS.load(Ordering::SeqCst) {
        std::panic::resume_unwind(Box::new(Ended));
    }
    exit_interrupted(i32::from(exit_code()))
}

/// Stops the commands that run inside another program, as Ctrl-C does. Those that do not stop by themselves end at the next
/// checkpoint of the numerics.
pub(super) fn raise() {
    SIGNAL.store(INTERRUPT, Ordering::SeqCst);
    FLAG.store(true, Ordering::SeqCst);
    if !STOPS_BY_ITSELF.load(Ordering::SeqCst) {
        STOP.store(true, Ordering::SeqCst);
    }
}

/// The flag that ends a command at the next checkpoint of the numerics.
pub(super) fn stop() -> &'static Arc<AtomicBool> {
    &STOP
}

/// Forgets a signal, before the next command inside another program.
pub(super) fn reset() {
    SIGNAL.store(0, Ordering::SeqCst);
    FLAG.store(false, Ordering::SeqCst);
    STOP.store(false, Ordering::SeqCst);
    STOPS_BY_ITSELF.store(false, Ordering::SeqCst);
}

/// Listens to signals, for the rest of the process.
pub(super) fn listen() {
    static LISTENING: Once = Once::new();
    // Without a handler, a signal ends the process. This is safe, because files appear whole or not at all.
    LISTENING.call_once(|| {
        LISTENS.store(true, Ordering::SeqCst);
        let _ = listen_on_a_thread();
    });
}

#[cfg(unix)]
fn listen_on_a_thread() -> std::io::Result<()> {
    use signal_hook::consts::{SIGINT, SIGTERM};
    // SIGHUP keeps its effect, so that `nohup` can take it away.
    let mut signals = signal_hook::iterator::Signals::new([SIGINT, SIGTERM])?;
    let listener = thread::Builder::new().name("signals".to_owned());
    listener.spawn(move || signals.forever().for_each(heard))?;
    Ok(())
}

#[cfg(not(unix))]
fn listen_on_a_thread() -> Result<(), ctrlc::Error> {
    const SIGINT: i32 = 2;
    ctrlc::set_handler(|| heard(SIGINT))
}

fn heard(signal: i32) {
    if SIGNAL.compare_exchange(0, signal, Ordering::SeqCst, Ordering::SeqCst) != Ok(0) {
        std::process::exit(128 + signal);
    }
    FLAG.store(true, Ordering::SeqCst);
    let end = move || {
        wait();
        say("interrupted\n");
        exit_interrupted(128 + signal);
    };
    if thread::Builder::new().spawn(end).is_err() {
        exit_interrupted(128 + signal);
    }
}

/// Waits while the command stops by itself, within bounds.
fn wait() {
    let begun = Instant::now();
    let work = work_done();
    let stops = || STOPS_BY_ITSELF.load(Ordering::SeqCst);
    while stops() && begun.elapsed() < MOST_WAIT && work_done().saturating_sub(work) < MOST_WORK {
        thread::sleep(LOOK);
    }
}

/// Processor time of all threads so far.
#[cfg(unix)]
fn work_done() -> Duration {
    let clock = nix::time::ClockId::CLOCK_PROCESS_CPUTIME_ID.now();
    clock.map_or(Duration::ZERO, Duration::from)
}

/// Elsewhere the clock on the wall has to do.
#[cfg(not(unix))]
fn work_done() -> Duration {
    static BEGUN: std::sync::OnceLock<Instant> = std::sync::OnceLock::new();
    BEGUN.get_or_init(Instant::now).elapsed()
}

/// Prints a line, unless nobody reads it.
fn say(text: &'static str) {
    let (said, done) = mpsc::channel();
    let spawned = thread::Builder::new().spawn(move || {
        terminal::note(text);
        let _ = said.send(());
    });
    if spawned.is_ok() {
        let _ = done.recv_timeout(LAST_WORDS);
    }
}
