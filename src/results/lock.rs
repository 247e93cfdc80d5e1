//! Lock file of a directory that is being written. The operating system holds the lock, so a process that dies releases it.

use super::Owner;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{self, Read, Seek, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Longest time that a run waits for a lock that another run holds, because the other run may end soon.
const ALONE: Duration = Duration::from_millis(300);

/// Longest time that a shard of a sweep waits while another shard prepares the directory.
const TOGETHER: Duration = Duration::from_secs(10);

/// Largest number of attempts to lock a file that another run removes at the same moment.
const MOST_ATTEMPTS: usize = 1000;

/// Locks of this process with their numbers. A signal that ends the process uses this list to remove the lock files.
static HELD: Mutex<Vec<(u64, PathBuf, File)>> = Mutex::new(Vec::new());

/// Number of the next lock.
static NEXT: AtomicU64 = AtomicU64::new(0);

fn held() -> MutexGuard<'static, Vec<(u64, PathBuf, File)>> {
    // The list is complete even after a panic in a thread, so a poisoned lock is harmless.
    HELD.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Releases all locks of this process before it ends.
pub(super) fn release_all() {
    for (_, path, file) in held().drain(..) {
        release(&path, &file);
    }
}

/// Releases a lock. If several processes share it, the last one removes the file: only that process can lock the file
/// exclusively.
fn release(path: &Path, file: &File) {
    if file.unlock().is_ok() && file.try_lock().is_ok() {
        remove(path, file);
    }
}

/// Removes a lock file, if the path still leads to the opened file.
fn remove(path: &Path, file: &File) {
    if is_at(file, path) {
        let _ = std::fs::remove_file(path);
    }
}

/// A lock that is held until this value is dropped. Dropping it also removes the lock file, unless another process shares it.
#[derive(Debug)]
pub struct Lock {
    number: u64,
    path: PathBuf,
    file: File,
}

/// Reason why a lock cannot be taken.
#[derive(Debug)]
pub enum NotLocked {
    /// Another run holds the lock, or has just moved the directory aside. The owner is given if the lock file could be read.
    Held(Option<Owner>),
    /// The lock file cannot be created or locked.
    Failed(io::Error),
}

impl Lock {
    /// Takes the lock exclusively. If another run holds it, waits up to 0.3 s.
    pub fn exclusive(path: &Path, owner: &Owner) -> Result<Self, NotLocked> {
        Lock::patiently(path, owner, ALONE, |file| file.try_lock())
    }

    /// Takes the lock together with other processes that share it. If another run holds the lock exclusively,
    /// waits up to 10 s.
    pub fn shared(path: &Path, owner: &Owner) -> Result<Self, NotLocked> {
        Lock::patiently(path, owner, TOGETHER, |file| file.try_lock_shared())
    }

    /// Takes the lock exclusively, without waiting.
    pub fn at_once(path: &Path, owner: &Owner) -> Result<Self, NotLocked> {
        Lock::try_once(path, owner, &|file| file.try_lock())
    }

    /// Turns an exclusive lock into a shared one. Another run can take the lock in between.
    pub fn share(self, owner: &Owner) -> Result<Self, NotLocked> {
        let path = self.path.clone();
        drop(self);
        Lock::shared(&path, owner)
    }

    fn patiently(
        path: &Path,
        owner: &Owner,
        patience: Duration,
        take: impl Fn(&File) -> Result<(), TryLockError>,
    ) -> Result<Self, NotLocked> {
        let begun = Instant::now();
        loop {
            match Lock::try_once(path, owner, &take) {
                Err(NotLocked::Held(_)) if begun.elapsed() < patience => {
                    std::thread::sleep(Duration::from_millis(20));
                }
                other => return other,
            }
        }
    }

    fn try_once(
        path: &Path,
        owner: &Owner,
        take: &impl Fn(&File) -> Result<(), TryLockError>,
    ) -> Result<Self, NotLocked> {
        for _ in 0..MOST_ATTEMPTS {
            // The lock must be a plain file. Another program may have replaced it by a symbolic link. A lock on the target of
            // this link would not protect the directory.
            if std::fs::symlink_metadata(path).is_ok_and(|there| there.is_symlink()) {
                return Err(NotLocked::Failed(io::Error::other(
                    "it is a symbolic link, which was not created by a run: remove it",
                )));
            }
            // While the list of locks is locked, a signal cannot end the process before the new lock is on the list.
            let mut held = held();
            let file = OpenOptions::new()
                .read(true)
                .write(true)
                .create(true)
                .truncate(false)
                .open(path);
            let file = match file {
                Ok(file) => file,
                // The file cannot be created because another process has just moved the directory aside.
                Err(e) if e.kind() == io::ErrorKind::NotFound => return Err(NotLocked::Held(None)),
                Err(e) => return Err(NotLocked::Failed(e)),
            };
            match take(&file) {
                Ok(()) => {}
                Err(TryLockError::WouldBlock) => return Err(NotLocked::Held(holder(file))),
                Err(TryLockError::Error(error)) if error.kind() == io::ErrorKind::Unsupported => {}
                Err(TryLockError::Error(error)) => return Err(NotLocked::Failed(error)),
            }
            // The previous holder may have removed the file between opening and locking it.
            if is_at(&file, path) {
                let same = file.try_clone().map_err(NotLocked::Failed)?;
                let number = NEXT.fetch_add(1, Ordering::Relaxed);
                held.push((number, path.to_owned(), same));
                drop(held);
                let mut lock = Lock {
                    number,
                    path: path.to_owned(),
                    file,
                };
                lock.sign(owner).map_err(NotLocked::Failed)?;
                return Ok(lock);
            }
        }
        Err(NotLocked::Failed(io::Error::other(
            "the file system does not identify the opened file: give a directory on a local disk with --out",
        )))
    }

    fn sign(&mut self, owner: &Owner) -> io::Result<()> {
        let text = serde_json::to_string(owner).expect("JSON can store an owner");
        self.file.rewind()?;
        self.file.set_len(0)?;
        self.file.write_all(text.as_bytes())
    }

    /// Removes the lock file before the lock is released, for a directory that will be moved.
    pub fn remove_file(&self) {
        remove(&self.path, &self.file);
    }
}

impl Drop for Lock {
    fn drop(&mut self) {
        release(&self.path, &self.file);
        held().retain(|(number, ..)| *number != self.number);
    }
}

fn holder(mut file: File) -> Option<Owner> {
    let mut text = String::new();
    (&mut file).take(4096).read_to_string(&mut text).ok()?;
    serde_json::from_str(&text).ok()
}

/// True if a path still leads to an open file.
#[cfg(unix)]
pub(super) fn is_at(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let identity = |m: std::fs::Metadata| (m.dev(), m.ino());
    let (open, there) = (file.metadata(), std::fs::symlink_metadata(path));
    open.ok().map(identity) == there.ok().map(identity)
}

/// True if the path exists. On systems other than Unix, the identity of the file is not checked.
#[cfg(not(unix))]
pub(super) fn is_at(_: &File, path: &Path) -> bool {
    path.exists()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn owner(name: &str) -> Owner {
        Owner::here(name)
    }

    #[test]
    fn one_holds_it_and_others_are_told_who() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("lock");
        let held = Lock::exclusive(&path, &owner("first")).unwrap();
        match Lock::at_once(&path, &owner("second")) {
            Err(NotLocked::Held(Some(found))) => assert_eq!(found, owner("first")),
            other => panic!("{other:?}"),
        }
        drop(held);
        assert!(!path.exists());
        Lock::at_once(&path, &owner("second")).unwrap();
    }

    #[test]
    fn some_share_it_and_the_last_clears_up() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("lock");
        let first = Lock::exclusive(&path, &owner("a")).unwrap();
        let first = first.share(&owner("a")).unwrap();
        let second = Lock::shared(&path, &owner("b")).unwrap();
        assert!(Lock::at_once(&path, &owner("c")).is_err());
        drop(first);
        assert!(path.exists());
        assert!(Lock::at_once(&path, &owner("c")).is_err());
        drop(second);
        assert!(!path.exists());
    }

    /// If a symbolic link has the name of the lock file, taking the lock fails with an error. The link is not followed, whether
    /// its target exists or not.
    #[cfg(unix)]
    #[test]
    fn a_link_is_no_lock() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("lock");
        let target = directory.path().join("target");
        for there in [false, true] {
            if there {
                std::fs::write(&target, "kept").unwrap();
            }
            let _ = std::fs::remove_file(&path);
            std::os::unix::fs::symlink(&target, &path).unwrap();
            for taken in [
                Lock::exclusive(&path, &owner("a")),
                Lock::shared(&path, &owner("a")),
            ] {
                let Err(NotLocked::Failed(error)) = taken else {
                    panic!("{taken:?}");
                };
                assert!(error.to_string().contains("symbolic link"), "{error}");
            }
            assert_eq!(target.exists(), there);
        }
        assert_eq!(std::fs::read_to_string(&target).unwrap(), "kept");
    }

    #[test]
    fn a_file_left_by_the_dead_is_no_lock() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("lock");
        std::fs::write(&path, "not even an owner").unwrap();
        let held = Lock::at_once(&path, &owner("next")).unwrap();
        drop(held);
        assert!(!path.exists());
    }
}
