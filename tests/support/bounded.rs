//! Limits of time and memory for child processes.

use std::process::{Child, ExitStatus};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// Processor time allowed for a command on a study of ordinary size, summed over all CPU threads. The test does not use
/// elapsed time, because elapsed time depends on the load of the machine.
const MOST_SECONDS: f64 = 10.0;
/// Limit of elapsed time. It ends processes that wait without computing. It also applies on systems where the processor
/// time cannot be read.
const MOST_SECONDS_ELAPSED: f64 = if cfg!(target_os = "linux") {
    120.0
} else {
    MOST_SECONDS
};
/// Memory limit of a command without stations, KiB. A command takes some tens of MiB. It takes far more if it allocates memory
/// for an unchecked number from a study.
const MOST_KIBIBYTES: u64 = 512 * 1024;
/// Memory limit added for each requested station, KiB. A station takes some hundreds of bytes.
const MOST_KIBIBYTES_PER_STATION: u64 = 2;
/// Clock ticks per second in `/proc/PID/stat` (USER_HZ). This is 100 on every common architecture.
const TICKS_PER_SECOND: f64 = 100.0;

/// Waits for the end of a child process with this many requested stations. If the process exceeds a limit, kills it and
/// returns the reason.
pub fn wait_within_bounds(child: &mut Child, stations: u64) -> Result<ExitStatus, String> {
    let begun = Instant::now();
    let most_kibibytes = MOST_KIBIBYTES + MOST_KIBIBYTES_PER_STATION * stations;
    loop {
        if let Some(status) = child.try_wait().unwrap() {
            return Ok(status);
        }
        let elapsed = begun.elapsed();
        let worked = seconds_of_processor(child.id()).unwrap_or(0.0);
        let memory = kibibytes_of_memory(child.id()).unwrap_or(0);
        let fault = if worked > MOST_SECONDS {
            format!("takes more than {MOST_SECONDS} s of the processor")
        } else if elapsed.as_secs_f64() > MOST_SECONDS_ELAPSED {
            format!("hangs: {worked} s of the processor in {MOST_SECONDS_ELAPSED} s")
        } else if memory > most_kibibytes {
            format!("takes {memory} KiB for {stations} stations")
        } else {
            // Most commands end within milliseconds. The process that waits must not use their processor, so it pauses.
            let pause = elapsed / 8;
            sleep(pause.clamp(Duration::from_micros(200), Duration::from_millis(20)));
            continue;
        };
        child.kill().unwrap();
        child.wait().unwrap();
        return Err(fault);
    }
}

/// Processor time of a process so far, in user and system mode. `None` if it cannot be read.
fn seconds_of_processor(id: u32) -> Option<f64> {
    let stat = std::fs::read_to_string(format!("/proc/{id}/stat")).ok()?;
    // The manual page proc(5) defines fields 14 and 15. The second field is the name in parentheses, which may contain
    // any character.
    let (_, after_name) = stat.rsplit_once(')')?;
    let mut ticks = after_name.split_whitespace().skip(11);
    let [user, system] = [ticks.next()?, ticks.next()?].map(str::parse::<f64>);
    Some((user.ok()? + system.ok()?) / TICKS_PER_SECOND)
}

/// Peak memory of a process so far.
fn kibibytes_of_memory(id: u32) -> Option<u64> {
    let status = std::fs::read_to_string(format!("/proc/{id}/status")).ok()?;
    let line = status
        .lines()
        .find_map(|line| line.strip_prefix("VmHWM:"))?;
    line.trim().strip_suffix("kB")?.trim().parse().ok()
}
