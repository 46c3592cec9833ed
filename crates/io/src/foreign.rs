//! Files of other programs that are not read: their names, and the way out.

use crate::lines::{one_token, tokens};
use crate::nist::is_number;

const BY_MDANALYSIS: &str = "GRO, as MDAnalysis writes a frame (`universe.atoms.write(\"start.gro\")`), with `start.length_scale`, one σ in nm; \
    or extended XYZ, LAMMPS dump or data, or NIST columns";
const BY_ASE: &str = "extended XYZ, as `ase convert` writes it (`ase convert -o extxyz FILE start.xyz`), with `start.length_scale`, one σ in Å; \
    or LAMMPS dump or data, GRO, or NIST columns";
const BY_GZIP: &str = "the text itself, or the text compressed by gzip";

/// A format by the bytes at a place of the file, its name, and the way out.
const BINARIES: [(usize, &[u8], &str, &str); 17] = [
    (0, &[0, 0, 0x07, 0xcb], XTC, BY_RUN),
    // Files of very many particles.
    (0, &[0, 0, 0x07, 0xe7], XTC, BY_RUN),
    (0, &[0, 0, 0x07, 0xc9], "a TRR trajectory", BY_MDANALYSIS),
    (4, b"CORD", "a DCD trajectory", BY_MDANALYSIS),
    (8, b"CORD", "a DCD trajectory", BY_MDANALYSIS),
    (0, b"CDF\x01", NETCDF, BY_MDANALYSIS),
    (0, b"CDF\x02", NETCDF, BY_MDANALYSIS),
    (0, b"CDF\x05", NETCDF, BY_MDANALYSIS),
    (0, b"\x89HDF\r\n\x1a\n", "a file of HDF5 (NetCDF-4, H5MD)", BY_MDANALYSIS),
    (0, &[0xdf, 0x65, 0xdf, 0x65], "a GSD trajectory", BY_MDANALYSIS),
    (
        0,
        b"LammpS RestartT",
        "a restart file of LAMMPS",
        "a data file, as `write_data` of LAMMPS writes it",
    ),
    (
        0,
        b"LENNARD\x1a",
        "a checkpoint of this program",
        "`lennard resume` with its folder, or the `final.xyz` in it",
    ),
    (0, b"\xfd7zXZ\0", "a file compressed by xz", BY_GZIP),
    (0, b"BZh", "a file compressed by bzip2", BY_GZIP),
    (0, &[0x28, 0xb5, 0x2f, 0xfd], "a file compressed by zstd", BY_GZIP),
    (0, b"PK\x03\x04", "a zip archive", BY_GZIP),
    (0, b"7z\xbc\xaf\x27\x1c", "a 7z archive", BY_GZIP),
];

const XTC: &str =
    "an XTC trajectory, whose positions are rounded and which has neither velocities nor species";
const BY_RUN: &str =
    "extended XYZ (such as the `final.xyz` beside it), LAMMPS dump or data, GRO, or NIST columns";
const NETCDF: &str = "a NetCDF trajectory";

/// What a file is whose first bytes tell that it is not text.
pub(crate) fn binary(head: &[u8]) -> Option<(&'static str, &'static str)> {
    let is = |(at, bytes, ..): &&(usize, &[u8], &str, &str)| {
        head.get(*at..).is_some_and(|rest| rest.starts_with(bytes))
    };
    BINARIES.iter().find(is).map(|(_, _, name, way)| (*name, *way))
}

/// Records that a PDB file begins with.
const PDB: [&[u8]; 10] = [
    b"HEADER", b"TITLE", b"COMPND", b"CRYST1", b"REMARK", b"MODEL", b"ATOM", b"HETATM", b"AUTHOR",
    b"EXPDTA",
];

/// What a text is that is of no format which is read.
pub(crate) fn text(head: &[Vec<u8>]) -> Option<(&'static str, &'static str)> {
    let first_word = |line: &Vec<u8>| tokens(line).next().map(<[u8]>::to_vec).unwrap_or_default();
    let numbers = |line: &Vec<u8>| tokens(line).count() == 3 && tokens(line).all(is_number);
    let first = first_word(head.first()?);
    if PDB.contains(&first.as_slice()) {
        return Some(("a PDB file", BY_ASE));
    }
    if first.starts_with(b"data_") {
        return Some(("a CIF file", BY_ASE));
    }
    let is_poscar = head.len() > 4
        && one_token(&head[1]).is_some_and(is_number)
        && head[2..5].iter().all(numbers);
    is_poscar.then_some(("a POSCAR file", BY_ASE))
}
