//! Extended XYZ, compressed by gzip: a frame is one member of the file or several, which every reader joins.

use std::io::Write;
use std::ops::Range;
use std::path::Path;

use flate2::{Compression, GzBuilder};
use rayon::prelude::*;

use super::{FormatSpec, xyz};
use crate::{Frame, FrameStyle, WriteError};

pub(super) const SPEC: FormatSpec = FormatSpec {
    file: "trajectory.xyz.gz",
    summary: "Extended XYZ compressed by gzip: the same content in half the space, more slowly.",
    by_parts: false,
    ends_with_line: false,
    push,
    ..xyz::SPEC
};

/// Text of one member, in bytes: members are compressed side by side, and the bytes do not depend on the number of threads.
const TEXT_OF_A_MEMBER: usize = 1 << 20;

/// Fast: random digits do not get smaller by patience.
const LEVEL: u32 = 1;

/// The operating system in the head of a member: unknown, so that files have the same bytes everywhere.
const ANY_SYSTEM: u8 = 255;

fn push(
    to: &mut Vec<u8>,
    path: &Path,
    style: &FrameStyle,
    frame: &Frame<'_>,
    particles: Range<usize>,
) -> Result<Option<f64>, WriteError> {
    let mut text = Vec::new();
    xyz::push(&mut text, path, style, frame, particles)?;
    let members: Vec<std::io::Result<Vec<u8>>> =
        text.par_chunks(TEXT_OF_A_MEMBER).map(member).collect();
    for member in members {
        to.extend_from_slice(&member.map_err(|e| WriteError::io(path, "compress", e))?);
    }
    Ok(None)
}

fn member(text: &[u8]) -> std::io::Result<Vec<u8>> {
    let mut encoder =
        GzBuilder::new().operating_system(ANY_SYSTEM).write(Vec::new(), Compression::new(LEVEL));
    encoder.write_all(text)?;
    encoder.finish()
}
