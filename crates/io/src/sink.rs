//! Growing files that hold whole records only.

use std::fs::{File, OpenOptions};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::WriteError;
use crate::atomic::making;

/// What a growing file is written to: a file, or in tests something that fails on purpose.
pub trait Sink: Write + Send {
    /// Removes everything after the first `length` bytes; the next write goes there.
    ///
    /// # Errors
    /// Where the operating system refuses.
    fn cut_back(&mut self, length: u64) -> io::Result<()>;

    /// Waits until everything written is on the disk.
    ///
    /// # Errors
    /// Where the operating system refuses.
    fn sync(&mut self) -> io::Result<()>;

    /// Whether `path` still names what this writes to. Bytes written to a removed file are lost
    /// without any error from the operating system, so this is asked before each record.
    fn is_still_at(&self, path: &Path) -> bool;
}

impl Sink for File {
    fn cut_back(&mut self, length: u64) -> io::Result<()> {
        self.set_len(length)?;
        self.seek(SeekFrom::Start(length)).map(|_| ())
    }

    fn sync(&mut self) -> io::Result<()> {
        self.sync_data()
    }

    #[cfg(unix)]
    fn is_still_at(&self, path: &Path) -> bool {
        use std::os::unix::fs::MetadataExt;
        match (self.metadata(), std::fs::metadata(path)) {
            (Ok(open), Ok(named)) => open.dev() == named.dev() && open.ino() == named.ino(),
            _ => false,
        }
    }

    #[cfg(not(unix))]
    fn is_still_at(&self, path: &Path) -> bool {
        path.exists()
    }
}

/// How far a growing file had been written: what a checkpoint keeps of it.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FileMark {
    /// Length in bytes.
    pub bytes: u64,
    /// Number of whole records (frames, rows).
    pub records: u64,
}

/// A growing file of whole records.
pub(crate) struct WholeFile {
    path: PathBuf,
    sink: Box<dyn Sink>,
    mark: FileMark,
    given_up: bool,
}

impl std::fmt::Debug for WholeFile {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("WholeFile")
            .field("path", &self.path)
            .field("mark", &self.mark)
            .finish_non_exhaustive()
    }
}

impl WholeFile {
    /// An empty file; what stood there before is gone.
    pub(crate) fn create(path: &Path) -> Result<Self, WriteError> {
        let _making = making(path)?;
        let file = File::create(path).map_err(|e| WriteError::io(path, "create the file", e))?;
        Ok(Self::over(path, Box::new(file)))
    }

    /// Nothing written yet, to any sink; `path` is for messages and for [`Sink::is_still_at`].
    pub(crate) fn over(path: &Path, sink: Box<dyn Sink>) -> Self {
        Self { path: path.to_path_buf(), sink, mark: FileMark::default(), given_up: false }
    }

    /// Goes on after `mark`: everything behind it is cut off. Where records end with a line, one must end there.
    pub(crate) fn resume_at(
        path: &Path,
        mark: FileMark,
        ends_with_line: bool,
    ) -> Result<Self, WriteError> {
        let refuse = |reason: String| WriteError::NotResumable {
            path: path.to_path_buf(),
            wanted: mark.bytes,
            reason,
        };
        let open = |e: io::Error| match e.kind() {
            io::ErrorKind::NotFound => refuse(format!("the file is not there: {e}")),
            _ => WriteError::io(path, "open the file to go on", e),
        };
        let mut file = OpenOptions::new().read(true).write(true).open(path).map_err(open)?;
        let length = file.metadata().map_err(open)?.len();
        if length < mark.bytes {
            return Err(refuse(format!("the file has only {length} bytes")));
        }
        if mark.bytes > 0 && ends_with_line {
            let mut last = [0];
            file.seek(SeekFrom::Start(mark.bytes - 1)).map_err(open)?;
            file.read_exact(&mut last).map_err(open)?;
            if last != *b"\n" {
                return Err(refuse("no line ends there: the file was changed".into()));
            }
        }
        file.cut_back(mark.bytes).map_err(|e| WriteError::io(path, "cut the file back", e))?;
        Ok(Self { mark, ..Self::over(path, Box::new(file)) })
    }

    /// Appends one record with one write, or leaves the file as it was.
    pub(crate) fn append(&mut self, record: &[u8]) -> Result<(), WriteError> {
        self.append_parts(|take| {
            take(record);
            Ok(())
        })
    }

    /// Appends one record that comes in parts, or leaves the file as it was. All parts are taken, whether they can be written or not.
    pub(crate) fn append_parts<T>(
        &mut self,
        parts: impl FnOnce(&mut dyn FnMut(&[u8])) -> Result<T, WriteError>,
    ) -> Result<T, WriteError> {
        let ready = self.is_ready();
        let (mut written, mut length) = (Ok(()), 0);
        let whole = parts(&mut |part| {
            if ready.is_ok() && written.is_ok() {
                written = self.sink.write_all(part);
                length += part.len() as u64;
            }
        });
        ready?;
        match (whole, written.and_then(|()| self.sink.flush())) {
            (Ok(found), Ok(())) => {
                self.mark.bytes += length;
                self.mark.records += 1;
                Ok(found)
            }
            (Err(error), _) if length == 0 => Err(error),
            (whole, written) => {
                let source = written.err().unwrap_or_else(|| io::Error::other("a part is missing"));
                let kept = self.mark.bytes;
                Err(match self.sink.cut_back(kept) {
                    Ok(()) => {
                        whole.err().unwrap_or_else(|| WriteError::io(&self.path, "write", source))
                    }
                    Err(cut_back) => {
                        self.given_up = true;
                        let path = self.path.clone();
                        WriteError::NotCutBack { path, whole: kept, source, cut_back }
                    }
                })
            }
        }
    }

    /// Refuses a file that was given up, or that is gone.
    fn is_ready(&mut self) -> Result<(), WriteError> {
        let path = || self.path.clone();
        if self.given_up {
            return Err(WriteError::GivenUp { path: path() });
        }
        if !self.sink.is_still_at(&self.path) {
            self.given_up = true;
            return Err(WriteError::Vanished { path: path() });
        }
        Ok(())
    }

    /// How far it is written.
    pub(crate) fn mark(&self) -> FileMark {
        self.mark
    }

    /// Counts everything so far as no record: a heading is none.
    pub(crate) fn records_start_here(&mut self) {
        self.mark.records = 0;
    }

    /// The path it was opened with.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// Waits until everything written is on the disk.
    pub(crate) fn sync(&mut self) -> Result<(), WriteError> {
        self.sink.sync().map_err(|e| WriteError::io(&self.path, "sync", e))
    }
}

#[cfg(test)]
pub(crate) mod faults {
    //! A sink in memory that fails on purpose.

    use super::*;
    use std::sync::{Arc, Mutex};

    /// Takes `room` bytes, then fails like a full disk.
    #[derive(Clone)]
    pub(crate) struct SmallDisk {
        pub(crate) content: Arc<Mutex<Vec<u8>>>,
        pub(crate) room: usize,
        pub(crate) can_cut_back: bool,
        pub(crate) present: bool,
    }

    impl SmallDisk {
        pub(crate) fn with_room(room: usize) -> Self {
            Self { content: Arc::default(), room, can_cut_back: true, present: true }
        }

        pub(crate) fn content(&self) -> Vec<u8> {
            self.content.lock().unwrap().clone()
        }
    }

    impl Write for SmallDisk {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            let mut content = self.content.lock().unwrap();
            let taken = bytes.len().min(self.room - content.len());
            if taken == 0 && !bytes.is_empty() {
                return Err(io::Error::from(io::ErrorKind::StorageFull));
            }
            content.extend_from_slice(&bytes[..taken]);
            Ok(taken)
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    impl Sink for SmallDisk {
        fn cut_back(&mut self, length: u64) -> io::Result<()> {
            if !self.can_cut_back {
                return Err(io::Error::from(io::ErrorKind::PermissionDenied));
            }
            self.content.lock().unwrap().truncate(length as usize);
            Ok(())
        }

        fn sync(&mut self) -> io::Result<()> {
            Ok(())
        }

        fn is_still_at(&self, _: &Path) -> bool {
            self.present
        }
    }
}

#[cfg(test)]
mod tests {
    use super::faults::SmallDisk;
    use super::*;

    #[test]
    fn a_failed_write_leaves_whole_records_only_whatever_the_byte_it_fails_at() {
        let record = b"one whole record\n";
        for room in 0..4 * record.len() {
            let disk = SmallDisk::with_room(room);
            let mut file = WholeFile::over(Path::new("x"), Box::new(disk.clone()));
            let mut whole = 0;
            let error = loop {
                match file.append(record) {
                    Ok(()) => whole += 1,
                    Err(error) => break error,
                }
            };
            assert_eq!(whole, room / record.len());
            assert_eq!(disk.content(), record.repeat(whole));
            assert_eq!(file.mark().records, whole as u64);
            assert_eq!(file.mark().bytes, (whole * record.len()) as u64);
            assert!(matches!(error, WriteError::Io { action: "write", .. }), "{error}");
        }
    }

    #[test]
    fn where_cutting_back_fails_too_nothing_more_is_written() {
        let disk = SmallDisk { can_cut_back: false, ..SmallDisk::with_room(20) };
        let mut file = WholeFile::over(Path::new("x"), Box::new(disk.clone()));
        file.append(b"0123456789abcde\n").unwrap();
        let error = file.append(b"0123456789abcde\n").unwrap_err();
        assert!(matches!(error, WriteError::NotCutBack { whole: 16, .. }));
        assert!(
            error.to_string().contains("; and cannot cut the file back to its 16 whole bytes: "),
            "{error}"
        );
        assert!(matches!(file.append(b"\n").unwrap_err(), WriteError::GivenUp { .. }));
    }

    #[test]
    fn a_removed_file_is_noticed_before_the_next_record() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("t");
        let mut file = WholeFile::create(&path).unwrap();
        file.append(b"a\n").unwrap();
        std::fs::remove_file(&path).unwrap();
        assert!(matches!(file.append(b"b\n").unwrap_err(), WriteError::Vanished { .. }));
        // Another file under the same name is not ours either.
        std::fs::write(&path, "other").unwrap();
        assert!(file.append(b"b\n").is_err());
        assert_eq!(std::fs::read(&path).unwrap(), b"other");
    }

    #[test]
    fn going_on_cuts_off_what_came_after_the_mark() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("t");
        let mut file = WholeFile::create(&path).unwrap();
        file.append(b"a\n").unwrap();
        let mark = file.mark();
        file.append(b"b\nhalf a reco").unwrap();
        drop(file);
        let mut file = WholeFile::resume_at(&path, mark, true).unwrap();
        file.append(b"c\n").unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"a\nc\n");
        assert_eq!(file.mark(), FileMark { bytes: 4, records: 2 });
        for (bytes, reason) in [(9, "only 4 bytes"), (3, "no line ends there")] {
            let error =
                WholeFile::resume_at(&path, FileMark { bytes, records: 2 }, true).unwrap_err();
            assert!(error.to_string().contains(reason), "{error}");
        }
        assert_eq!(std::fs::read(&path).unwrap(), b"a\nc\n", "refusal changes nothing");
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn the_operating_systems_own_full_disk_is_reported() {
        let mut file = WholeFile::create(Path::new("/dev/full")).unwrap();
        let error = file.append(b"a\n").unwrap_err();
        assert!(error.advice().contains("free space"), "{error}");
    }
}
