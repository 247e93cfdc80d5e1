//! Signals. The first signal stops the command, the second one ends the process at once.
//!
//! A command that has results to keep checks the [`flag`], stops, and writes them. Every other command ends immediately. This
//! is safe: the command ends between two writes, and its directories are recorded as interrupted. The limits [`MOST_WORK`] and
//! [`MOST_WAIT`] apply to the time until the process ends.

use super::terminal;
use crate::results::exit_interrupted;
use std::sync::atomic::{AtomicBool, AtomicI32, Ordering};
use std::sync::mpsc;
use std::sync::{Arc, LazyLock, Mutex, MutexGuard, Once, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

/// Processor time that a command may use to stop by itself.
const MOST_WORK: Duration = Duration::from_millis(200);

/// Elapsed time that a command may use to stop by itself. This time includes waiting for the disk, or for the program that
/// reads the output.
const MOST_WAIT: Duration = Duration::from_secs(2);

/// Interval between two checks of the time limits for stopping.
const LOOK: Duration = Duration::from_millis(5);

/// Time limit for printing the last line, `interrupted`, on standard error.
const LAST_WORDS: Duration = Duration::from_millis(20);

static FLAG: LazyLock<Arc<AtomicBool>> = LazyLock::new(Arc::default);
/// Number of the first signal. 0 before a signal arrives.
static SIGNAL: AtomicI32 = AtomicI32::new(0);
/// True if this module handles signals. False inside another program, which handles them itself.
static LISTENS: AtomicBool = AtomicBool::new(false);
/// Number of the signal SIGINT (Ctrl-C).
const INTERRUPT: i32 = 2;
/// Effect that a signal has now.
static PHASE: Mutex<Phase> = Mutex::new(Phase::Ends);
/// Flag that ends a command inside another program, if the command does not stop by itself.
static STOP: LazyLock<Arc<AtomicBool>> = LazyLock::new(Arc::default);

/// Effect of a signal on a command.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Phase {
    /// The signal ends the command.
    Ends,
    /// The command checks the flag, or has all of its results. After a signal, the program waits for the command.
    StopsByItself,
    /// A signal is ending the process.
    Ending,
}

fn phase() -> MutexGuard<'static, Phase> {
    PHASE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Flag that is true from the first signal, or from [`raise`], until [`reset`].
pub(super) fn flag() -> &'static Arc<AtomicBool> {
    &FLAG
}

/// True if a signal has arrived.
pub(super) fn is_raised() -> bool {
    FLAG.load(Ordering::SeqCst)
}

/// Declares that the command checks the flag and stops by itself. If a signal is already ending the process, the command does not
/// continue. So an interrupted command never looks like a finished command.
pub(super) fn stops_by_itself() {
    let mut phase = phase();
    if *phase == Phase::Ending {
        drop(phase);
        loop {
            thread::park();
        }
    }
    *phase = Phase::StopsByItself;
}

/// Exit code of a command that a signal stopped: 128 plus the number of the signal.
pub(super) fn exit_code() -> u8 {
    let signal = SIGNAL.load(Ordering::SeqCst);
    u8::try_from(128 + signal).unwrap_or(u8::MAX)
}

/// Panic payload with which [`end`] unwinds the stack to end a command inside another program.
pub(super) struct Ended;

/// After a signal, ends a command that has no results to keep. The function ends the process. Inside another program, it
/// unwinds the stack instead.
pub(super) fn end() -> ! {
    if !LISTENS.load(Ordering::SeqCst) {
        std::panic::resume_unwind(Box::new(Ended));
    }
    exit_interrupted(i32::from(exit_code()))
}

/// Stops a command inside another program, as Ctrl-C stops this program. If the command does not stop by itself, it ends as
/// soon as its computation checks the flag [`STOP`].
pub(super) fn raise() {
    SIGNAL.store(INTERRUPT, Ordering::SeqCst);
    FLAG.store(true, Ordering::SeqCst);
    if *phase() != Phase::StopsByItself {
        STOP.store(true, Ordering::SeqCst);
    }
}

/// Flag that computations check. If it is true, they end.
pub(super) fn stop() -> &'static Arc<AtomicBool> {
    &STOP
}

/// Clears the signal before the next command inside another program.
pub(super) fn reset() {
    SIGNAL.store(0, Ordering::SeqCst);
    FLAG.store(false, Ordering::SeqCst);
    STOP.store(false, Ordering::SeqCst);
    *phase() = Phase::Ends;
}

/// Starts to handle signals, for the rest of the process.
pub(super) fn listen() {
    static LISTENING: Once = Once::new();
    // Without a handler, a signal ends the process. This is safe, because files are written completely or not at all.
    LISTENING.call_once(|| {
        LISTENS.store(true, Ordering::SeqCst);
        let _ = listen_on_a_thread();
    });
}

#[cfg(unix)]
fn listen_on_a_thread() -> std::io::Result<()> {
    use signal_hook::consts::{SIGINT, SIGTERM};
    // SIGHUP keeps its default effect, so that `nohup` can disable it.
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

/// Waits until the command has stopped by itself, within the time limits [`MOST_WORK`] and [`MOST_WAIT`].
fn wait() {
    let begun = Instant::now();
    let work = work_done();
    loop {
        let mut phase = phase();
        let is_over = begun.elapsed() >= MOST_WAIT || work_done().saturating_sub(work) >= MOST_WORK;
        if is_over || *phase != Phase::StopsByItself {
            *phase = Phase::Ending;
            return;
        }
        drop(phase);
        thread::sleep(LOOK);
    }
}

/// Processor time that all threads of the process have used so far.
#[cfg(unix)]
fn work_done() -> Duration {
    let clock = nix::time::ClockId::CLOCK_PROCESS_CPUTIME_ID.now();
    clock.map_or(Duration::ZERO, Duration::from)
}

/// Time since the first call. Systems other than Unix use it instead of the processor time.
#[cfg(not(unix))]
fn work_done() -> Duration {
    static BEGUN: std::sync::OnceLock<Instant> = std::sync::OnceLock::new();
    BEGUN.get_or_init(Instant::now).elapsed()
}

/// Prints a line on standard error. Waits at most [`LAST_WORDS`] if no program reads standard error.
fn say(text: &'static str) {
    let (printed, done) = mpsc::channel();
    let spawned = thread::Builder::new().spawn(move || {
        terminal::note(text);
        let _ = printed.send(());
    });
    if spawned.is_ok() {
        let _ = done.recv_timeout(LAST_WORDS);
    }
}
