//! One process at a time in an output folder, on one machine or on many.
//!
//! A claim is a file that names the process. It is linked into the folder with its content, which only one process can do.
//! Two things say that its process lives:
//!
//! - The file is locked. The operating system lets go of the lock when the process ends, however it ends.
//! - The file is renewed every half minute. Other machines may not see the lock, but they see the time of the file.
//!
//! A claim of a process that does not live is removed, and the folder is free.

use std::fmt;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Read, Seek, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::thread::JoinHandle;
use std::time::Duration;

/// Name of the claim file in a folder; hidden, and never counted as content of the folder.
pub(crate) const CLAIM_FILE: &str = ".lennard-claim";

/// Time between two renewals.
const RENEWED_EVERY: Duration = Duration::from_secs(30);
/// A claim of another machine that was not renewed for so long is a claim of a dead process.
const DEAD_AFTER: Duration = Duration::from_secs(300);
/// The largest claim file that is read.
const LARGEST: u64 = 4096;

/// A folder held by this process until the value is dropped.
#[derive(Debug)]
pub(crate) struct Claim {
    path: PathBuf,
    file: File,
    lost: Arc<AtomicBool>,
    /// Ends the renewal when it is dropped.
    end: Option<mpsc::Sender<()>>,
    renewal: Option<JoinHandle<()>>,
}

/// Why a folder cannot be claimed.
#[derive(Debug)]
pub(crate) enum Unclaimed {
    /// A process holds it; who, where the claim file tells.
    Busy(Option<Holder>),
    /// The operating system refuses.
    Io(io::Error),
}

impl From<io::Error> for Unclaimed {
    fn from(error: io::Error) -> Self {
        Self::Io(error)
    }
}

impl Claim {
    /// Claims an existing folder.
    pub(crate) fn take(folder: &Path) -> Result<Self, Unclaimed> {
        let path = folder.join(CLAIM_FILE);
        loop {
            if let Some(file) = begin(&path)? {
                return Ok(Self::renewed(path, file));
            }
            free(&path)?;
        }
    }

    /// A claim that renews itself.
    fn renewed(path: PathBuf, file: File) -> Self {
        let lost = Arc::new(AtomicBool::new(false));
        let (end, ended) = mpsc::channel();
        let renewal = file.try_clone().and_then(|mut file| {
            let (path, lost) = (path.clone(), Arc::clone(&lost));
            let renew = move || {
                while ended.recv_timeout(RENEWED_EVERY) == Err(RecvTimeoutError::Timeout) {
                    lost.store(!renew(&mut file, &path), Ordering::Relaxed);
                }
            };
            std::thread::Builder::new().name("claim".into()).spawn(renew)
        });
        Self {
            path,
            file,
            lost,
            end: Some(end),
            // Without a thread the lock alone says that the process lives.
            renewal: renewal.ok(),
        }
    }

    /// Whether another process has taken the folder over, because this one did not renew its claim in time.
    pub(crate) fn is_lost(&self) -> bool {
        self.lost.load(Ordering::Relaxed)
    }

    /// Removes the claim file; the lock lasts until the value is dropped or the process ends.
    pub(crate) fn remove(&self) {
        // The folder may have been moved away, and another process may hold what has its name now.
        if is_still(&self.file, &self.path) {
            // A leftover does no harm: it is hidden, and claims nothing once this process has ended.
            let _ = fs::remove_file(&self.path);
        }
    }
}

impl Drop for Claim {
    fn drop(&mut self) {
        drop(self.end.take());
        if let Some(renewal) = self.renewal.take() {
            // A renewal that has panicked renews nothing any more.
            let _ = renewal.join();
        }
        self.remove();
    }
}

/// Whether a file of a folder belongs to a claim.
pub(crate) fn is_of_claim(name: &std::ffi::OsStr) -> bool {
    name.to_str().is_some_and(|name| name.starts_with(CLAIM_FILE))
}

/// Puts the claim of this process in place, locked and whole; `None` where there is a claim.
fn begin(path: &Path) -> Result<Option<File>, Unclaimed> {
    let own = Temporary::beside(path)?;
    let mut file = own.file()?;
    write(&mut file)?;
    lock(&file);
    match fs::hard_link(&own.0, path) {
        Ok(()) => Ok(Some(file)),
        Err(e) if e.kind() == io::ErrorKind::AlreadyExists => Ok(None),
        // A file system without links: the file is made first and filled then.
        Err(_) => {
            let made = OpenOptions::new().read(true).write(true).create_new(true).open(path);
            let mut file = match made {
                Err(e) if e.kind() == io::ErrorKind::AlreadyExists => return Ok(None),
                made => made?,
            };
            lock(&file);
            write(&mut file)?;
            Ok(Some(file))
        }
    }
}

/// Removes a claim of a process that does not live; one that lives keeps it.
fn free(path: &Path) -> Result<(), Unclaimed> {
    let mut file = match OpenOptions::new().read(true).write(true).open(path) {
        Err(e) if e.kind() == io::ErrorKind::NotFound => return Ok(()),
        opened => opened?,
    };
    let holder = holder_in(&mut file);
    let is_locked_by_us = match file.try_lock() {
        Err(TryLockError::WouldBlock) => return Err(Unclaimed::Busy(holder)),
        Ok(()) => true,
        // A file system without locks.
        Err(TryLockError::Error(_)) => false,
    };
    // The process before may have removed the file between opening and locking it.
    if !is_still(&file, path) {
        return Ok(());
    }
    let may_live = match &holder {
        Some(holder) if holder.is_here() => !is_locked_by_us && holder.has_process(),
        Some(_) => true,
        // Not yet filled, or no claim of ours.
        None => !is_locked_by_us,
    };
    if may_live && age(&file, path)? < DEAD_AFTER {
        return Err(Unclaimed::Busy(holder));
    }
    // Another process may have done the same before, and its claim must not be removed.
    let left = Temporary::named(path);
    match fs::rename(path, &left.0) {
        Err(e) if e.kind() == io::ErrorKind::NotFound => Ok(()),
        Err(e) => Err(e.into()),
        Ok(()) => {
            if !is_still(&file, &left.0) {
                // Where it cannot be put back, its process sees that its claim is lost.
                let _ = fs::hard_link(&left.0, path);
            }
            Ok(())
        }
    }
}

/// A file beside the claim that is removed with the value.
struct Temporary(PathBuf);

impl Temporary {
    /// A name that no other process and no other thread has.
    fn named(path: &Path) -> Self {
        static NEXT: AtomicU64 = AtomicU64::new(0);
        let here = Holder::here().text().replace('\n', "-");
        let number = NEXT.fetch_add(1, Ordering::Relaxed);
        let mut name = path.as_os_str().to_owned();
        name.push(format!("-{here}{number}"));
        Self(name.into())
    }

    /// The same, with an empty file.
    fn beside(path: &Path) -> io::Result<Self> {
        let named = Self::named(path);
        File::create(&named.0)?;
        Ok(named)
    }

    fn file(&self) -> io::Result<File> {
        OpenOptions::new().read(true).write(true).open(&self.0)
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        // It may be gone already.
        let _ = fs::remove_file(&self.0);
    }
}

/// Renews a claim; `false` where another process has taken it over.
fn renew(file: &mut File, path: &Path) -> bool {
    let is_ours = is_still(file, path);
    if is_ours {
        // One renewal that fails is followed by another.
        let _ = write(file);
    }
    is_ours
}

/// Names this process in its claim file.
fn write(file: &mut File) -> io::Result<()> {
    let text = Holder::here().text();
    file.rewind()?;
    file.write_all(text.as_bytes())?;
    file.set_len(text.len() as u64)
}

fn lock(file: &File) {
    // A file system without locks must not keep a run from its folder.
    let _ = file.try_lock();
}

/// Time since the claim was renewed, by the clock of the file system.
fn age(file: &File, path: &Path) -> io::Result<Duration> {
    let now = Temporary::beside(path)?.file()?.metadata()?.modified()?;
    let then = file.metadata()?.modified()?;
    Ok(now.duration_since(then).unwrap_or_default())
}

/// The process that a claim file names.
fn holder_in(file: &mut File) -> Option<Holder> {
    let mut text = String::new();
    file.rewind().ok()?;
    file.take(LARGEST).read_to_string(&mut text).ok()?;
    Holder::parse(&text)
}

/// Whether an open file is the one that the path names.
#[cfg(unix)]
fn is_still(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let (Ok(open), Ok(named)) = (file.metadata(), fs::symlink_metadata(path)) else {
        return false;
    };
    (open.dev(), open.ino()) == (named.dev(), named.ino())
}

/// Where files have no numbers, an open file cannot be removed either.
#[cfg(not(unix))]
fn is_still(_file: &File, path: &Path) -> bool {
    path.exists()
}

/// A process, as a claim file names it: number, machine and start of the machine, each on its line.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Holder {
    process: u32,
    /// Name of the machine; empty where it is not known.
    machine: String,
    /// Changes whenever the machine starts; empty where it is not known.
    start: String,
}

impl Holder {
    /// This process.
    pub(crate) fn here() -> Self {
        Self {
            process: std::process::id(),
            machine: said_by("/proc/sys/kernel/hostname"),
            start: said_by("/proc/sys/kernel/random/boot_id"),
        }
    }

    /// The process that a claim file names.
    pub(crate) fn parse(text: &str) -> Option<Self> {
        let mut lines = text.lines().map(str::trim);
        let process = lines.next()?.parse().ok()?;
        let mut next = || lines.next().map(str::to_owned);
        Some(Self { process, machine: next()?, start: next()? })
    }

    /// The content of a claim file.
    pub(crate) fn text(&self) -> String {
        format!("{}\n{}\n{}\n", self.process, self.machine, self.start)
    }

    /// Whether it belongs to this machine since its last start, where all locks are seen. Without a start it does.
    pub(crate) fn is_here(&self) -> bool {
        self.start.is_empty() || self.start == Self::here().start
    }

    /// Whether a process of this number lives on this machine, as far as the system tells.
    pub(crate) fn has_process(&self) -> bool {
        Path::new("/proc").join(self.process.to_string()).exists()
    }
}

impl fmt::Display for Holder {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "process {}", self.process)?;
        if !self.is_here() && !self.machine.is_empty() {
            write!(f, " on {}", self.machine)?;
        }
        Ok(())
    }
}

/// What a file of the system says, where there is one.
fn said_by(file: &str) -> String {
    fs::read_to_string(file).map(|text| text.trim().to_owned()).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_claim_is_renewed_until_another_process_takes_it_over() {
        let root = tempfile::tempdir().unwrap();
        let mut claim = Claim::take(root.path()).unwrap();
        let long_ago = std::time::SystemTime::UNIX_EPOCH;
        claim.file.set_modified(long_ago).unwrap();
        assert!(renew(&mut claim.file, &claim.path));
        assert!(age(&claim.file, &claim.path).unwrap() < DEAD_AFTER);
        assert!(!claim.is_lost());
        fs::remove_file(&claim.path).unwrap();
        fs::write(&claim.path, "17\nnode-7\nx\n").unwrap();
        assert!(!renew(&mut claim.file, &claim.path));
        drop(claim);
        let left = fs::read_to_string(root.path().join(CLAIM_FILE)).unwrap();
        assert!(left.starts_with("17"), "the claim of the other stays");
    }

    #[test]
    fn a_holder_is_read_back_and_another_machine_is_named() {
        let here = Holder::here();
        assert_eq!(Holder::parse(&here.text()), Some(here.clone()));
        assert!(here.is_here() && here.has_process());
        assert_eq!(here.to_string(), format!("process {}", std::process::id()));
        let there = Holder::parse("17\nnode-7\nx\n").unwrap();
        assert!(!there.is_here());
        assert_eq!(there.to_string(), "process 17 on node-7");
        // A system that tells neither its name nor its start.
        assert!(Holder::parse("17\n\n\n").unwrap().is_here());
        assert_eq!(Holder::parse("17\n"), None);
        assert_eq!(Holder::parse("who\n"), None);
    }
}
