//! The bytes of a checkpoint.
//!
//! All numbers are little-endian. A text is its length in bytes (u64), then UTF-8.
//!
//! | bytes | content |
//! |---|---|
//! | 8 | `LENNARD` and 0x1A |
//! | 4 | version of the format |
//! | 4 | zero |
//! | 8 | length of the whole file |
//! | … | metadata as JSON text; scene text; number of arrays (u64) |
//! | … | for each array, names ascending: name text, type (u64: 1 f64, 3 u64, 4 vector), count (u64), values of 8 or 24 bytes |
//! | 4 | CRC-32 (IEEE 802.3) of everything before |

use std::collections::BTreeMap;
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::ops::Range;

use crc32fast::Hasher;
use glam::DVec3;
use lennard_core::{Array, Own, StateArchive, Team};
use serde::{Deserialize, Serialize};

use crate::FileMark;

/// Version of the container that this program writes, and the only one that it reads.
pub const CHECKPOINT_VERSION: u32 = 1;

/// A checkpoint.
#[derive(Debug, Clone, PartialEq)]
pub struct Checkpoint {
    /// What must be known before the arrays are looked at.
    pub metadata: CheckpointMetadata,
    /// The scene as resolved, as text.
    pub scene: String,
    /// Every array, kept to the bit.
    pub archive: StateArchive,
}

/// What is known of a checkpoint before its arrays are looked at.
///
/// No floating-point number stands here: the time is in the archive, to the bit.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CheckpointMetadata {
    /// Version of the program that wrote it.
    pub program_version: String,
    /// Name of the scene.
    pub scene_name: String,
    /// Instruction set of the force kernel: another one gives other bits.
    pub isa: String,
    /// Precision of the force kernel.
    pub precision: String,
    /// Number of steps done.
    pub step: u64,
    /// How far each growing output file was written, by file name.
    pub files: BTreeMap<String, FileMark>,
    /// Remarks for the run record that belong to the whole run.
    #[serde(default)]
    pub remarks: Vec<String>,
    /// Whether the rows and frames of this step are still to be written: so after a write that failed.
    #[serde(default)]
    pub owes_output: bool,
}

/// What is wrong with a checkpoint.
#[derive(Debug, thiserror::Error)]
pub enum CheckpointProblem {
    /// The operating system refused.
    #[error("it cannot be read: {0}")]
    Io(#[from] io::Error),
    /// It is something else.
    #[error("it is not a checkpoint of this program")]
    NotACheckpoint,
    /// Another version of the container.
    #[error(
        "it has version {found} of the format; this program reads version {CHECKPOINT_VERSION}"
    )]
    OtherVersion {
        /// The version found.
        found: u32,
    },
    /// It is shorter or longer than it says.
    #[error("it has {found} bytes and should have {wanted}: it is truncated or damaged")]
    WrongLength {
        /// Bytes found.
        found: u64,
        /// Bytes that it says it has.
        wanted: u64,
    },
    /// The checksum does not fit the content.
    #[error("it is damaged: its content does not fit its checksum")]
    Damaged,
    /// The checksum fits, but the content makes no sense.
    #[error("its content makes no sense: {0}")]
    Malformed(String),
    /// There is none.
    #[error("there is no checkpoint in this folder")]
    None,
}

const MAGIC: [u8; 8] = *b"LENNARD\x1a";

/// Bytes before the metadata: magic, version, zero, length.
const PREFIX: u64 = 24;

/// Bytes of the checksum.
const CHECKSUM: u64 = 4;

/// Bytes moved at a time; a multiple of 8, the size of every value.
const PIECE: usize = 1 << 16;

/// Bytes of a number.
const WORD: u64 = 8;

fn kind_and_words(array: &Array) -> (u64, u64, u64) {
    match array {
        Array::F64(v) => (1, v.len() as u64, 1),
        Array::U64(v) => (3, v.len() as u64, 1),
        Array::Vec3(v) => (4, v.len() as u64, 3),
    }
}

/// The vectors of an array of which each rank has a part.
fn parted<'a>(name: &str, array: &'a Array) -> Option<&'a [DVec3]> {
    match array {
        Array::Vec3(here) if StateArchive::is_of_particles(name) => Some(here),
        _ => None,
    }
}

/// Counts what passes through into the checksum.
struct Summed<'a, W> {
    to: &'a mut W,
    sum: Hasher,
}

impl<W: Write> Summed<'_, W> {
    fn bytes(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.sum.update(bytes);
        self.to.write_all(bytes)
    }

    fn text(&mut self, text: &str) -> io::Result<()> {
        self.bytes(&(text.len() as u64).to_le_bytes())?;
        self.bytes(text.as_bytes())
    }

    fn words(&mut self, words: impl Iterator<Item = u64>) -> io::Result<()> {
        let mut piece = Vec::with_capacity(PIECE);
        for word in words {
            piece.extend_from_slice(&word.to_le_bytes());
            if piece.len() == PIECE {
                self.bytes(&piece)?;
                piece.clear();
            }
        }
        self.bytes(&piece)
    }
}

/// Gives rank 0 what it needs of this rank, while it calls [`encode`].
pub(crate) fn give(checkpoint: &Checkpoint, own: &Own) {
    for (name, array) in &checkpoint.archive.arrays {
        if let Some(here) = parted(name, array) {
            own.pass(here, |_| {});
        }
    }
}

/// Writes a checkpoint; the same checkpoint gives the same bytes. Where ranks share the particles, the others [`give`] theirs.
pub(crate) fn encode<W: Write>(checkpoint: &Checkpoint, own: &Own, to: &mut W) -> io::Result<()> {
    let metadata = serde_json::to_string(&checkpoint.metadata)?;
    let arrays = &checkpoint.archive.arrays;
    // All ranks have vectors in an array, or none has.
    let count_of = |name: &str, array: &Array| match parted(name, array) {
        Some(here) if own.team().is_some() && !here.is_empty() => own.all() as u64,
        _ => kind_and_words(array).1,
    };
    let text_length = |text: &str| WORD + text.len() as u64;
    let length = PREFIX
        + text_length(&metadata)
        + text_length(&checkpoint.scene)
        + WORD
        + arrays
            .iter()
            .map(|(name, array)| {
                let (_, _, words) = kind_and_words(array);
                text_length(name) + 2 * WORD + WORD * words * count_of(name, array)
            })
            .sum::<u64>()
        + CHECKSUM;
    let mut out = Summed { to, sum: Hasher::new() };
    let mut written = begin(&mut out, length, checkpoint, &metadata);
    for (name, array) in arrays {
        let (kind, _, _) = kind_and_words(array);
        written = written.and_then(|()| {
            out.text(name)?;
            out.bytes(&kind.to_le_bytes())?;
            out.bytes(&count_of(name, array).to_le_bytes())
        });
        // The other ranks give their parts, whether a disk takes them or not.
        if let Some(here) = parted(name, array) {
            own.pass(here, |words| {
                let done = std::mem::replace(&mut written, Ok(()));
                written = done.and_then(|()| out.words(words.iter().copied()));
            });
            continue;
        }
        written = written.and_then(|()| match array {
            Array::F64(v) => out.words(v.iter().map(|x| x.to_bits())),
            Array::U64(v) => out.words(v.iter().copied()),
            Array::Vec3(v) => out.words(v.iter().flat_map(|r| r.to_array().map(f64::to_bits))),
        });
    }
    written?;
    let sum = out.sum.finalize();
    to.write_all(&sum.to_le_bytes())
}

/// Writes what comes before the arrays.
fn begin<W: Write>(
    out: &mut Summed<'_, W>,
    length: u64,
    checkpoint: &Checkpoint,
    metadata: &str,
) -> io::Result<()> {
    out.bytes(&MAGIC)?;
    out.bytes(&CHECKPOINT_VERSION.to_le_bytes())?;
    out.bytes(&[0; 4])?;
    out.bytes(&length.to_le_bytes())?;
    out.text(metadata)?;
    out.text(&checkpoint.scene)?;
    out.bytes(&(checkpoint.archive.arrays.len() as u64).to_le_bytes())
}

/// Reads a checkpoint of `size` bytes. Nothing is taken from it before its length and checksum fit. A rank takes the particles alone
/// that it keeps.
pub(crate) fn decode<R: Read + Seek>(
    mut from: R,
    size: u64,
    team: Option<&Team>,
) -> Result<Checkpoint, CheckpointProblem> {
    let mut prefix = Vec::new();
    (&mut from).take(PREFIX).read_to_end(&mut prefix)?;
    if !prefix.starts_with(&MAGIC) {
        return Err(CheckpointProblem::NotACheckpoint);
    }
    let (Some(version), Some(wanted)) = (
        prefix.get(8..12).and_then(|b| b.try_into().ok()),
        prefix.get(16..24).and_then(|b| b.try_into().ok()),
    ) else {
        return Err(CheckpointProblem::WrongLength { found: size, wanted: PREFIX + CHECKSUM });
    };
    let found = u32::from_le_bytes(version);
    if found != CHECKPOINT_VERSION {
        return Err(CheckpointProblem::OtherVersion { found });
    }
    let wanted = u64::from_le_bytes(wanted).max(PREFIX + CHECKSUM);
    if wanted != size {
        return Err(CheckpointProblem::WrongLength { found: size, wanted });
    }
    check_sum(&mut from, &prefix, size)?;
    from.seek(SeekFrom::Start(PREFIX))?;
    Body { from, left: size - PREFIX - CHECKSUM }.checkpoint(team)
}

/// Reads on to the end and compares the checksum there with the checksum of everything before.
fn check_sum<R: Read>(from: &mut R, prefix: &[u8], size: u64) -> Result<(), CheckpointProblem> {
    let mut sum = Hasher::new();
    sum.update(prefix);
    let mut left = size - PREFIX - CHECKSUM;
    let mut piece = vec![0; PIECE];
    while left > 0 {
        let length = left.min(PIECE as u64);
        let piece = &mut piece[..length as usize];
        from.read_exact(piece)?;
        sum.update(piece);
        left -= length;
    }
    let mut stored = [0; CHECKSUM as usize];
    from.read_exact(&mut stored)?;
    if u32::from_le_bytes(stored) == sum.finalize() {
        Ok(())
    } else {
        Err(CheckpointProblem::Damaged)
    }
}

/// The part between prefix and checksum. Its counts are not believed, although the checksum fits:
/// whoever can write a file can write a checksum.
struct Body<R> {
    from: R,
    left: u64,
}

fn malformed(reason: impl Into<String>) -> CheckpointProblem {
    CheckpointProblem::Malformed(reason.into())
}

impl<R: Read> Body<R> {
    /// Takes note of `length` bytes that will be read next.
    fn claim(&mut self, length: u64, what: &str) -> Result<(), CheckpointProblem> {
        self.left = self.left.checked_sub(length).ok_or_else(|| {
            malformed(format!("{what} of {length} bytes, where {} are left", self.left))
        })?;
        Ok(())
    }

    fn word(&mut self) -> Result<u64, CheckpointProblem> {
        self.claim(WORD, "a number")?;
        let mut bytes = [0; WORD as usize];
        self.from.read_exact(&mut bytes)?;
        Ok(u64::from_le_bytes(bytes))
    }

    fn text(&mut self, what: &str) -> Result<String, CheckpointProblem> {
        let length = self.word()?;
        self.claim(length, what)?;
        let mut bytes = Vec::new();
        (&mut self.from).take(length).read_to_end(&mut bytes)?;
        String::from_utf8(bytes).map_err(|_| malformed(format!("{what} is not UTF-8")))
    }

    /// Of `count` values of `WORDS` words each, those that are kept.
    fn values<const WORDS: usize, T>(
        &mut self,
        count: u64,
        name: &str,
        kept: Option<Range<usize>>,
        value: impl Fn([u64; WORDS]) -> T,
    ) -> Result<Vec<T>, CheckpointProblem> {
        let each = WORD * WORDS as u64;
        let bytes = count
            .checked_mul(each)
            .ok_or_else(|| malformed(format!("`{name}` holds {count} values")))?;
        self.claim(bytes, &format!("`{name}`"))?;
        // The claim holds: there are as many bytes in the file as this takes memory.
        let room = kept.as_ref().map_or(usize::try_from(count).unwrap_or(0), Range::len);
        let mut values = Vec::with_capacity(room);
        let is_kept = |number: usize| kept.as_ref().is_none_or(|kept| kept.contains(&number));
        let (each, mut numbers) = (each as usize, 0..);
        let mut piece = vec![0; (PIECE / each * each).min(usize::try_from(bytes).unwrap_or(PIECE))];
        let mut left = bytes;
        while left > 0 {
            let length = left.min(piece.len() as u64);
            let piece = &mut piece[..length as usize];
            self.from.read_exact(piece)?;
            let found = piece.chunks_exact(each).zip(&mut numbers);
            values.extend(found.filter(|(_, number)| is_kept(*number)).map(|(bytes, _)| {
                let mut words = [0; WORDS];
                for (word, bytes) in words.iter_mut().zip(bytes.as_chunks::<8>().0) {
                    *word = u64::from_le_bytes(*bytes);
                }
                value(words)
            }));
            left -= length;
        }
        Ok(values)
    }

    fn checkpoint(mut self, team: Option<&Team>) -> Result<Checkpoint, CheckpointProblem> {
        let metadata = serde_json::from_str(&self.text("the metadata")?)
            .map_err(|e| malformed(format!("the metadata: {e}")))?;
        let scene = self.text("the scene")?;
        let mut archive = StateArchive::default();
        for _ in 0..self.word()? {
            let name = self.text("the name of an array")?;
            let in_order = archive.arrays.last_key_value().is_none_or(|(before, _)| *before < name);
            if !in_order {
                return Err(malformed(format!("`{name}` is not in order")));
            }
            let kind = self.word()?;
            let count = self.word()?;
            let array = match kind {
                1 => Array::F64(self.values(count, &name, None, |[w]| f64::from_bits(w))?),
                3 => Array::U64(self.values(count, &name, None, |[w]| w)?),
                4 => {
                    let of_rank = team.filter(|_| StateArchive::is_of_particles(&name));
                    let kept = of_rank.map(|team| team.numbers(count as usize));
                    Array::Vec3(self.values(count, &name, kept, |words: [u64; 3]| {
                        DVec3::from_array(words.map(f64::from_bits))
                    })?)
                }
                _ => return Err(malformed(format!("`{name}` has the unknown type {kind}"))),
            };
            archive.arrays.insert(name, array);
        }
        if self.left != 0 {
            return Err(malformed(format!("{} bytes after the last array", self.left)));
        }
        Ok(Checkpoint { metadata, scene, archive })
    }
}
