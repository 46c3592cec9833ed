//! Tables by path and content: each is read once and kept until the program ends.
//!
//! Pair loops compile formulas in, and a formula is a small value that is copied. It therefore refers to a table that stays.

use std::collections::HashMap;
use std::path::Path;
use std::sync::{Mutex, OnceLock, PoisonError};

use lennard_core::options::OptionValue;
use serde::{Deserialize, Deserializer, Serialize};

use super::Tabulated;
use super::file::Refusal;

/// The largest file that is read, bytes.
const LARGEST_FILE: u64 = 1 << 28;

/// The path of a table, relative to the scene file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct TablePath(&'static str);

impl TablePath {
    /// The name of the file, which messages have.
    #[must_use]
    pub fn name(&self) -> String {
        let name = self.path().file_name().unwrap_or_default();
        name.to_string_lossy().into_owned()
    }

    /// The path.
    #[must_use]
    pub fn path(&self) -> &'static Path {
        Path::new(self.0)
    }
}

impl From<String> for TablePath {
    fn from(path: String) -> Self {
        static PATHS: OnceLock<Mutex<HashMap<String, &'static str>>> = OnceLock::new();
        let mut paths = locked(&PATHS);
        if let Some(known) = paths.get(&path) {
            return Self(known);
        }
        let kept: &'static str = Box::leak(path.clone().into_boxed_str());
        paths.insert(path, kept);
        Self(kept)
    }
}

impl<'de> Deserialize<'de> for TablePath {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        String::deserialize(from).map(Self::from)
    }
}

impl OptionValue for TablePath {
    fn written(&self) -> String {
        format!("{:?}", self.0)
    }
}

/// The checksum of the content of a file, written as eight hexadecimal digits: CRC-32.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct Checksum(u32);

impl Checksum {
    /// The checksum of a content.
    #[must_use]
    pub fn of(content: &[u8]) -> Self {
        Self(crc32fast::hash(content))
    }
}

impl std::fmt::Display for Checksum {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{:08x}", self.0)
    }
}

impl From<Checksum> for String {
    fn from(checksum: Checksum) -> Self {
        checksum.to_string()
    }
}

impl TryFrom<String> for Checksum {
    type Error = &'static str;

    fn try_from(text: String) -> Result<Self, Self::Error> {
        let digits = (text.len() == 8).then(|| u32::from_str_radix(&text, 16).ok());
        digits.flatten().map(Self).ok_or("a checksum has eight hexadecimal digits")
    }
}

impl OptionValue for Checksum {
    fn written(&self) -> String {
        format!("\"{self}\"")
    }
}

/// The table of a file, with the checksum of its content.
///
/// Where a checksum is `expected`, a table that this program has already read is not read again, and a file with another content
/// is refused.
///
/// # Errors
/// What was found, and what is allowed.
pub fn stored(
    path: TablePath,
    expected: Option<Checksum>,
) -> Result<(&'static Tabulated, Checksum), Refusal> {
    type Tables = HashMap<Checksum, (Vec<u8>, &'static Tabulated)>;
    static TABLES: OnceLock<Mutex<Tables>> = OnceLock::new();
    if let Some(checksum) = expected
        && let Some((_, table)) = locked(&TABLES).get(&checksum)
    {
        return Ok((table, checksum));
    }
    let content = content(path)?;
    let checksum = Checksum::of(&content);
    if let Some(expected) = expected
        && checksum != expected
    {
        return Err(Refusal::new(
            format!("{} with the checksum {checksum}", path.name()),
            format!("the file as it was, with the checksum {expected}"),
        ));
    }
    let mut tables = locked(&TABLES);
    if let Some((known, table)) = tables.get(&checksum)
        && *known == content
    {
        return Ok((table, checksum));
    }
    let text = str::from_utf8(&content).map_err(|error| {
        Refusal::new(
            format!("{}: bytes that are no text after byte {}", path.name(), error.valid_up_to()),
            "a text of three columns r, U and F",
        )
    })?;
    let table = Tabulated::parse(text).map_err(|refusal| Refusal {
        found: format!("{}, {}", path.name(), refusal.found),
        ..refusal
    })?;
    let table: &'static Tabulated = Box::leak(Box::new(table));
    tables.insert(checksum, (content, table));
    Ok((table, checksum))
}

fn content(path: TablePath) -> Result<Vec<u8>, Refusal> {
    let allowed = "the path of a table of r, U and F, relative to the scene file";
    let fail = |error: String| Refusal::new(format!("{} ({error})", path.name()), allowed);
    // A device or a pipe may never end.
    let about = std::fs::metadata(path.path()).map_err(|e| fail(e.to_string()))?;
    if !about.is_file() || about.len() > LARGEST_FILE {
        return Err(fail("it is no regular file of at most 256 MiB".into()));
    }
    std::fs::read(path.path()).map_err(|e| fail(e.to_string()))
}

fn locked<T: Default>(lock: &'static OnceLock<Mutex<T>>) -> std::sync::MutexGuard<'static, T> {
    let lock = lock.get_or_init(Mutex::default);
    lock.lock().unwrap_or_else(PoisonError::into_inner)
}
