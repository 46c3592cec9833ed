//! Writing trajectories: growing files of whole frames.

use std::path::Path;

use crate::atomic::write_bytes_atomically;
use crate::frame_text::push_frame;
use crate::sink::WholeFile;
use crate::{FileMark, Frame, FrameStyle, Sink, WriteError};

/// Text kept allocated between frames, in bytes: the frames of small systems follow each other quickly and
/// should not allocate; those of large ones are rare and should not hold memory while the run goes on.
const KEPT_BUFFER: usize = 16 << 20;

/// Writes a trajectory in extended XYZ, whole frames only.
///
/// A frame is formatted in memory and written with one write. Where that fails, the file is cut back
/// to its last whole frame.
#[derive(Debug)]
pub struct TrajectoryWriter {
    file: WholeFile,
    style: FrameStyle,
    text: Vec<u8>,
}

impl TrajectoryWriter {
    /// An empty trajectory; what stood at `path` before is gone.
    ///
    /// # Errors
    /// Where the file cannot be created or the style holds an impossible value.
    pub fn create(path: &Path, style: &FrameStyle) -> Result<Self, WriteError> {
        style.check(path)?;
        Ok(Self::over(WholeFile::create(path)?, style))
    }

    /// Goes on after `mark` (from a checkpoint): later frames, whole or not, are cut off.
    ///
    /// # Errors
    /// Where the file cannot be opened, is shorter than the mark, or has no line end there.
    pub fn resume_at(path: &Path, style: &FrameStyle, mark: FileMark) -> Result<Self, WriteError> {
        style.check(path)?;
        Ok(Self::over(WholeFile::resume_at(path, mark)?, style))
    }

    /// A trajectory to any sink: for tests that make writes fail.
    ///
    /// # Errors
    /// Where the style holds an impossible value.
    pub fn to_sink(
        path: &Path,
        style: &FrameStyle,
        sink: Box<dyn Sink>,
    ) -> Result<Self, WriteError> {
        style.check(path)?;
        Ok(Self::over(WholeFile::over(path, sink), style))
    }

    fn over(file: WholeFile, style: &FrameStyle) -> Self {
        Self {
            file,
            style: style.clone(),
            text: Vec::new(),
        }
    }

    /// Appends a frame.
    ///
    /// # Errors
    /// Where a number is not finite or the operating system refuses; the file then holds the
    /// frames before this one and nothing else.
    pub fn write(&mut self, frame: &Frame<'_>) -> Result<(), WriteError> {
        self.text.clear();
        push_frame(&mut self.text, self.file.path(), &self.style, frame)?;
        let appended = self.file.append(&self.text);
        if self.text.capacity() > KEPT_BUFFER {
            self.text = Vec::new();
        }
        appended
    }

    /// How far it is written: what a checkpoint keeps for [`Self::resume_at`].
    #[must_use]
    pub fn mark(&self) -> FileMark {
        self.file.mark()
    }

    /// Waits until every frame is on the disk.
    ///
    /// # Errors
    /// Where the operating system refuses.
    pub fn sync(&mut self) -> Result<(), WriteError> {
        self.file.sync()
    }

    /// Syncs and closes.
    ///
    /// # Errors
    /// Where the operating system refuses.
    pub fn finish(mut self) -> Result<FileMark, WriteError> {
        self.sync()?;
        Ok(self.mark())
    }
}

/// Writes a file that holds one frame: to a hidden neighbor first, synced, then renamed.
///
/// # Errors
/// Where a number is not finite or the operating system refuses; what stood at `path` before is
/// then still there.
pub fn write_frame(path: &Path, style: &FrameStyle, frame: &Frame<'_>) -> Result<(), WriteError> {
    style.check(path)?;
    let mut text = Vec::new();
    push_frame(&mut text, path, style, frame)?;
    write_bytes_atomically(path, &text)
}
