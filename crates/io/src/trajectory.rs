//! Writing trajectories: growing files of whole frames.

use std::path::Path;

use crate::atomic::write_parts_atomically;
use crate::formats::pass_frame;
use crate::sink::WholeFile;
use crate::{FileMark, Frame, FrameStyle, Sink, TrajectoryFormat, WriteError};

/// Bytes kept allocated between frames. Small frames follow each other quickly and should not allocate. Large frames are rare,
/// and should not hold memory while the run goes on.
const KEPT_BUFFER: usize = 16 << 20;

/// Writes a trajectory, whole frames only.
///
/// A frame is made and written in pieces. Where one cannot be made or written, the file is cut back to its last whole frame.
#[derive(Debug)]
pub struct TrajectoryWriter {
    file: WholeFile,
    format: TrajectoryFormat,
    style: FrameStyle,
    bytes: Vec<u8>,
}

impl TrajectoryWriter {
    /// An empty trajectory; what stood at `path` before is gone.
    ///
    /// # Errors
    /// Where the file cannot be created or the style holds an impossible value.
    pub fn create(
        path: &Path,
        format: TrajectoryFormat,
        style: &FrameStyle,
    ) -> Result<Self, WriteError> {
        style.check(path)?;
        Ok(Self::over(WholeFile::create(path)?, format, style))
    }

    /// Goes on after `mark` (from a checkpoint): later frames, whole or not, are cut off.
    ///
    /// # Errors
    /// Where the file cannot be opened, is shorter than the mark, or, in a format of lines, has no line end there.
    pub fn resume_at(
        path: &Path,
        format: TrajectoryFormat,
        style: &FrameStyle,
        mark: FileMark,
    ) -> Result<Self, WriteError> {
        style.check(path)?;
        let ends_with_line = format.spec().ends_with_line;
        Ok(Self::over(WholeFile::resume_at(path, mark, ends_with_line)?, format, style))
    }

    /// A trajectory to any sink: for tests that make writes fail.
    ///
    /// # Errors
    /// Where the style holds an impossible value.
    pub fn to_sink(
        path: &Path,
        format: TrajectoryFormat,
        style: &FrameStyle,
        sink: Box<dyn Sink>,
    ) -> Result<Self, WriteError> {
        style.check(path)?;
        Ok(Self::over(WholeFile::over(path, sink), format, style))
    }

    fn over(file: WholeFile, format: TrajectoryFormat, style: &FrameStyle) -> Self {
        Self { file, format, style: style.clone(), bytes: Vec::new() }
    }

    /// Appends a frame. Returns the precision of its positions, per σ, where the format rounds them. It is below the precision
    /// of the style where a coordinate is too large.
    ///
    /// # Errors
    /// Where a number is not finite or the operating system refuses; the file then holds the
    /// frames before this one and nothing else.
    pub fn write(&mut self, frame: &Frame<'_>) -> Result<Option<f64>, WriteError> {
        let Self { file, format, style, bytes } = self;
        let path = file.path().to_path_buf();
        let precision =
            file.append_parts(|take| pass_frame(bytes, &path, *format, style, frame, take));
        if bytes.capacity() > KEPT_BUFFER {
            *bytes = Vec::new();
        }
        precision
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
}

/// Writes a file of extended XYZ that holds one frame: to a hidden neighbor first, synced, then renamed.
///
/// # Errors
/// Where a number is not finite or the operating system refuses; what stood at `path` before is
/// then still there.
pub fn write_frame(path: &Path, style: &FrameStyle, frame: &Frame<'_>) -> Result<(), WriteError> {
    style.check(path)?;
    write_parts_atomically(path, |take| {
        pass_frame(&mut Vec::new(), path, TrajectoryFormat::Xyz, style, frame, take).map(|_| ())
    })
}

/// Gives rank 0 the text of the particles of this rank, while it writes a frame of a format by parts.
///
/// # Errors
/// Where a number is not finite, here or on another rank.
pub fn give_frame(
    format: TrajectoryFormat,
    style: &FrameStyle,
    frame: &Frame<'_>,
) -> Result<(), WriteError> {
    let path = Path::new(format.spec().file);
    pass_frame(&mut Vec::new(), path, format, style, frame, |_| {}).map(|_| ())
}
