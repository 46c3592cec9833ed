//! The second line of an extended XYZ frame.

use std::collections::BTreeMap;

use glam::DVec3;
use lennard_core::PeriodicBox;

use crate::columns::{Column, Columns, MOST_COLUMNS, Scalar, Vector, motion};
use crate::error::{Refusal, excerpt, refused};
use crate::geometry::upright;
use crate::lines::{finite, tokens};
use crate::units::{FileUnits, Scales, stated};

/// What a header says.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Header {
    /// In units of the file.
    pub(crate) cell: Option<PeriodicBox>,
    pub(crate) columns: Columns,
    pub(crate) step: Option<u64>,
    pub(crate) time: Option<f64>,
    pub(crate) scales: Scales,
    /// Everything else, as it stands there.
    pub(crate) info: BTreeMap<String, String>,
}

impl Header {
    /// Reads a header; `units` are those that the scene names.
    pub(crate) fn parse(line: &[u8], units: FileUnits) -> Result<Self, Refusal> {
        let text = String::from_utf8_lossy(line);
        let is_extended = text.split_whitespace().any(|word| {
            ["Lattice=", "lattice=\"", "Properties=", "properties="]
                .iter()
                .any(|key| word.starts_with(key))
        });
        if !is_extended {
            return Self::of_comment(&text, units);
        }
        let text = std::str::from_utf8(line)
            .map_err(|_| (excerpt(line), "a header line in UTF-8".to_string()))?;
        let mut info = pairs(text)?;
        let columns = match take_either(&mut info, ["Properties", "properties"]) {
            Some(text) => columns(&text)?,
            None => plain(),
        };
        let cell = take_either(&mut info, ["Lattice", "lattice"]);
        let cell = cell.map(|t| lattice(&t)).transpose()?;
        if let Some(text) = info.remove("pbc") {
            check_periodic(&text, cell.is_some())?;
        }
        let scales = scales(&mut info, units)?;
        let number = |key: &str, text: String| {
            finite(text.as_bytes()).ok_or_else(|| {
                (format!("{key}={}", excerpt(text.as_bytes())), "a finite number".to_string())
            })
        };
        let time =
            take_either(&mut info, ["Time", "time"]).map(|t| number("Time", t)).transpose()?;
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
        if cell.is_none() && columns.has(Vector::Image) {
            return refused(
                "image flags (map_shift) without a box",
                "a Lattice=\"…\" entry beside them",
            );
        }
        Ok(Self { cell, columns, step, time, scales, info })
    }

    /// The second line of a plain XYZ file says what it likes, of units alone what the file means.
    fn of_comment(text: &str, units: FileUnits) -> Result<Self, Refusal> {
        let entry = text.split_whitespace().find_map(|word| word.strip_prefix("length_scale="));
        let mut info: BTreeMap<String, String> =
            entry.map(|scale| ("length_scale".into(), scale.into())).into_iter().collect();
        info.extend(stated(text).map(|unit| ("units".into(), unit)));
        let scales = scales(&mut info, units)?;
        Ok(Self {
            cell: None,
            columns: plain(),
            step: None,
            time: None,
            scales,
            info: BTreeMap::new(),
        })
    }
}

/// What a plain XYZ file holds.
fn plain() -> Columns {
    Columns::fixed(&[Column::Scalar(Scalar::Name), Column::Vector(Vector::Position)])
}

/// The scales for what the entries say of units. An entry `length_scale` multiplies lengths alone.
fn scales(info: &mut BTreeMap<String, String>, mut units: FileUnits) -> Result<Scales, Refusal> {
    let own = info.remove("length_scale").map(|text| {
        let scale = finite(text.as_bytes()).filter(|scale| *scale > 0.0);
        let found = || format!("length_scale={}", excerpt(text.as_bytes()));
        scale.ok_or_else(|| (found(), "a finite positive number".to_string()))
    });
    let own = own.transpose()?;
    let names_unit = |key: &str| {
        let key = key.to_ascii_lowercase();
        key.ends_with("unit") || key.ends_with("units") || key.starts_with("units_")
    };
    let mut scales = units.scales(None)?;
    for (_, unit) in info.iter().filter(|(key, _)| names_unit(key)) {
        scales = units.scales(Some(unit))?;
    }
    match own {
        None => Ok(scales),
        Some(_) if units.length.is_some() => {
            refused("length_scale beside `start.length_scale` in the scene", "one of them")
        }
        Some(length) => Ok(Scales { length, ..scales }),
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
        let end = rest.find(|c: char| c == '=' || c.is_whitespace()).unwrap_or(rest.len());
        let (key, after) = rest.split_at(end);
        if key.is_empty() {
            return refused(
                excerpt(rest.as_bytes()),
                "key=value pairs, values with spaces in double quotes",
            );
        }
        let (value, after) = match after.strip_prefix('=') {
            None => ("T".to_string(), after),
            Some(after) => value(after)?,
        };
        if all.insert(key.to_string(), value).is_some() {
            return refused(format!("{} twice", excerpt(key.as_bytes())), "each key once");
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
    refused(
        format!("{}, which is not closed", excerpt(text.as_bytes())),
        format!("a value that ends with {close}"),
    )
}

/// `name:type:width` triples.
fn columns(text: &str) -> Result<Columns, Refusal> {
    let refuse =
        |allowed: &str| (format!("Properties={}", excerpt(text.as_bytes())), allowed.to_string());
    let parts: Vec<&str> = text.split(':').collect();
    if !parts.len().is_multiple_of(3) || parts.len() > 3 * MOST_COLUMNS {
        return Err(refuse("name:type:width triples joined by colons"));
    }
    let mut all = Columns::default();
    for triple in parts.chunks_exact(3) {
        let (name, kind) = (triple[0], triple[1]);
        let width: usize = triple[2].parse().unwrap_or(0);
        if name.is_empty() || !["S", "R", "I", "L"].contains(&kind) || width == 0 {
            return Err(refuse(
                "name:type:width triples with a type of S, R, I or L and a width of at least 1",
            ));
        }
        let column = match name {
            "species" => Column::Scalar(Scalar::Name),
            "pos" => Column::Vector(Vector::Position),
            "forces" | "force" => Column::Vector(Vector::Force),
            "map_shift" => Column::Vector(Vector::Image),
            "mass" | "masses" => Column::Scalar(Scalar::Mass),
            // One column of this name is a volume, a pressure, …
            "v" | "p" if width == 1 => Column::Other,
            _ => motion(name),
        };
        let wanted = match column {
            Column::Scalar(Scalar::Name) => "S:1",
            Column::Scalar(_) | Column::Component(..) => "R:1",
            Column::Vector(Vector::Image) => "I:3",
            Column::Vector(_) => "R:3",
            Column::Other => "",
        };
        if !wanted.is_empty() && wanted != format!("{kind}:{width}") {
            return Err(refuse(&format!("{name}:{wanted}")));
        }
        if all.width() + width.min(MOST_COLUMNS + 1) > MOST_COLUMNS {
            return Err(refuse(&format!("at most {MOST_COLUMNS} columns")));
        }
        if !all.add(column, width) {
            return Err(refuse("each quantity once"));
        }
    }
    if let Some(vector) = all.in_part() {
        return Err(refuse(&format!("all three components of {vector}, or none")));
    }
    if !all.has(Vector::Position) {
        return Err(refuse("positions among them, pos:R:3"));
    }
    Ok(all)
}

/// The three vectors of the box, row by row.
fn lattice(text: &str) -> Result<PeriodicBox, Refusal> {
    let found = || format!("Lattice={}", excerpt(text.as_bytes()));
    let numbers: Option<Vec<f64>> = tokens(text.as_bytes()).map(finite).collect();
    let Some(&[ax, ay, az, bx, by, bz, cx, cy, cz]) = numbers.as_deref() else {
        return refused(found(), "nine finite numbers, the box vectors a, b and c");
    };
    let edges = [[ax, ay, az], [bx, by, bz], [cx, cy, cz]].map(DVec3::from_array);
    upright(edges, found)
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
        Some(&[_, _, _]) => refused(
            found,
            "\"T T T\"; boxes that are not periodic in all directions are not there yet",
        ),
        _ => refused(found, "three of T or F"),
    }
}
