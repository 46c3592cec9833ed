//! The second line of an extended XYZ frame.

use std::collections::BTreeMap;

use glam::DVec3;
use lennard_core::PeriodicBox;

use crate::error::excerpt;
use crate::lines::{finite, tokens};

/// Most columns that a line may have.
const MOST_COLUMNS: usize = 256;

/// What is wrong with a header: found, allowed.
pub(crate) type Refusal = (String, String);

/// What a column holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Column {
    Species,
    Position,
    Velocity,
    Force,
    ImageFlags,
    Mass,
    /// Something that is not used, this many columns wide.
    Other(usize),
}

impl Column {
    pub(crate) fn width(self) -> usize {
        match self {
            Self::Species | Self::Mass => 1,
            Self::Position | Self::Velocity | Self::Force | Self::ImageFlags => 3,
            Self::Other(width) => width,
        }
    }
}

/// What a header says.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Header {
    /// In units of the file: lengths still multiplied by `length_scale`.
    pub(crate) cell: Option<PeriodicBox>,
    pub(crate) columns: Vec<Column>,
    pub(crate) step: Option<u64>,
    pub(crate) time: Option<f64>,
    pub(crate) length_scale: f64,
    /// Everything else, as it stands there.
    pub(crate) info: BTreeMap<String, String>,
}

impl Header {
    pub(crate) fn parse(line: &[u8]) -> Result<Self, Refusal> {
        let text = std::str::from_utf8(line)
            .map_err(|_| (excerpt(line), "a header line in UTF-8".to_string()))?;
        let mut info = pairs(text)?;
        let columns = match info.remove("Properties") {
            Some(text) => columns(&text)?,
            // What a plain XYZ file holds.
            None => vec![Column::Species, Column::Position],
        };
        let cell = info.remove("Lattice").map(|t| lattice(&t)).transpose()?;
        if let Some(text) = info.remove("pbc") {
            check_periodic(&text, cell.is_some())?;
        }
        if let Some(units) = info.get("units").filter(|u| *u != "lj") {
            return Err((
                format!("units={}", excerpt(units.as_bytes())),
                "units=lj (reduced units), or no such entry".into(),
            ));
        }
        let number = |key: &str, text: String| {
            finite(text.as_bytes()).ok_or_else(|| {
                (
                    format!("{key}={}", excerpt(text.as_bytes())),
                    "a finite number".to_string(),
                )
            })
        };
        let time = take_either(&mut info, ["Time", "time"])
            .map(|t| number("Time", t))
            .transpose()?;
        let step = take_either(&mut info, ["Step", "step"])
            .map(|text| {
                text.parse::<u64>().map_err(|_| {
                    (
                        format!("Step={}", excerpt(text.as_bytes())),
                        "an integer of at least 0".to_string(),
                    )
                })
            })
            .transpose()?;
        let length_scale = match info.remove("length_scale") {
            None => 1.0,
            Some(text) => match number("length_scale", text)? {
                scale if scale > 0.0 => scale,
                scale => {
                    return Err((
                        format!("length_scale={scale}"),
                        "a finite positive number".into(),
                    ));
                }
            },
        };
        if cell.is_none() && columns.contains(&Column::ImageFlags) {
            return Err((
                "image flags (map_shift) without a box".into(),
                "a Lattice=\"…\" entry beside them".into(),
            ));
        }
        Ok(Self {
            cell,
            columns,
            step,
            time,
            length_scale,
            info,
        })
    }
}

fn take_either(info: &mut BTreeMap<String, String>, keys: [&str; 2]) -> Option<String> {
    keys.into_iter().find_map(|key| info.remove(key))
}

/// `key=value`, `key="a value"`, `key={a value}`, or a bare key, which means true.
fn pairs(text: &str) -> Result<BTreeMap<String, String>, Refusal> {
    let mut all = BTreeMap::new();
    let mut rest = text.trim_start();
    while !rest.is_empty() {
        let end = rest
            .find(|c: char| c == '=' || c.is_whitespace())
            .unwrap_or(rest.len());
        let (key, after) = rest.split_at(end);
        if key.is_empty() {
            return Err((
                excerpt(rest.as_bytes()),
                "key=value pairs, values with spaces in double quotes".into(),
            ));
        }
        let (value, after) = match after.strip_prefix('=') {
            None => ("T".to_string(), after),
            Some(after) => value(after)?,
        };
        if all.insert(key.to_string(), value).is_some() {
            return Err((
                format!("{} twice", excerpt(key.as_bytes())),
                "each key once".into(),
            ));
        }
        rest = after.trim_start();
    }
    Ok(all)
}

/// A value and what follows it.
fn value(text: &str) -> Result<(String, &str), Refusal> {
    let close = match text.chars().next() {
        Some('"') => '"',
        Some('{') => '}',
        _ => {
            let end = text.find(char::is_whitespace).unwrap_or(text.len());
            return Ok((text[..end].to_string(), &text[end..]));
        }
    };
    let mut value = String::new();
    let mut characters = text.char_indices().skip(1);
    while let Some((at, c)) = characters.next() {
        match c {
            '\\' if close == '"' => match characters.next() {
                Some((_, 'n')) => value.push('\n'),
                Some((_, escaped)) => value.push(escaped),
                None => break,
            },
            c if c == close => return Ok((value, &text[at + c.len_utf8()..])),
            c => value.push(c),
        }
    }
    Err((
        format!("{}, which is not closed", excerpt(text.as_bytes())),
        format!("a value that ends with {close}"),
    ))
}

/// `name:type:width` triples.
fn columns(text: &str) -> Result<Vec<Column>, Refusal> {
    let refuse = |allowed: &str| {
        (
            format!("Properties={}", excerpt(text.as_bytes())),
            allowed.to_string(),
        )
    };
    let parts: Vec<&str> = text.split(':').collect();
    if !parts.len().is_multiple_of(3) || parts.len() > 3 * MOST_COLUMNS {
        return Err(refuse("name:type:width triples joined by colons"));
    }
    let mut all = Vec::new();
    let mut total = 0;
    for triple in parts.chunks_exact(3) {
        let (name, kind) = (triple[0], triple[1]);
        let width: usize = triple[2].parse().unwrap_or(0);
        if name.is_empty() || !["S", "R", "I", "L"].contains(&kind) || width == 0 {
            return Err(refuse(
                "name:type:width triples with a type of S, R, I or L and a width of at least 1",
            ));
        }
        let (column, wanted) = match name {
            "species" => (Column::Species, "S:1"),
            "pos" => (Column::Position, "R:3"),
            "velo" | "vel" => (Column::Velocity, "R:3"),
            "forces" | "force" => (Column::Force, "R:3"),
            "map_shift" => (Column::ImageFlags, "I:3"),
            "mass" | "masses" => (Column::Mass, "R:1"),
            _ => (Column::Other(width), ""),
        };
        if !wanted.is_empty() && wanted != format!("{kind}:{width}") {
            return Err(refuse(&format!("{name}:{wanted}")));
        }
        if !matches!(column, Column::Other(_)) && all.contains(&column) {
            return Err(refuse("each quantity once"));
        }
        total += width.min(MOST_COLUMNS + 1);
        if total > MOST_COLUMNS {
            return Err(refuse(&format!("at most {MOST_COLUMNS} columns")));
        }
        all.push(column);
    }
    if !all.contains(&Column::Position) {
        return Err(refuse("positions among them, pos:R:3"));
    }
    Ok(all)
}

/// The three vectors of the box, row by row.
fn lattice(text: &str) -> Result<PeriodicBox, Refusal> {
    let found = || format!("Lattice={}", excerpt(text.as_bytes()));
    let numbers: Option<Vec<f64>> = tokens(text.as_bytes()).map(finite).collect();
    let Some(&[ax, ay, az, bx, by, bz, cx, cy, cz]) = numbers.as_deref() else {
        return Err((
            found(),
            "nine finite numbers, the box vectors a, b and c".into(),
        ));
    };
    if [ay, az, bx, bz, cx, cy] != [0.0; 6] {
        return Err((
            format!("{}, a triclinic box", found()),
            "an orthorhombic box, \"Lx 0.0 0.0 0.0 Ly 0.0 0.0 0.0 Lz\"; triclinic boxes are not there yet"
                .into(),
        ));
    }
    PeriodicBox::new(DVec3::new(ax, by, cz))
        .map_err(|_| (found(), "box sides that are positive".into()))
}

/// Every direction must be periodic where there is a box.
fn check_periodic(text: &str, has_box: bool) -> Result<(), Refusal> {
    let flags: Option<Vec<bool>> = tokens(text.as_bytes())
        .map(|token| match token {
            b"T" | b"True" | b"true" | b"TRUE" | b"1" => Some(true),
            b"F" | b"False" | b"false" | b"FALSE" | b"0" => Some(false),
            _ => None,
        })
        .collect();
    let found = format!("pbc={}", excerpt(text.as_bytes()));
    match flags.as_deref() {
        Some(&[x, y, z]) if (x && y && z) || !has_box => Ok(()),
        Some(&[_, _, _]) => Err((
            found,
            "\"T T T\"; boxes that are not periodic in all directions are not there yet".into(),
        )),
        _ => Err((found, "three of T or F".into())),
    }
}
