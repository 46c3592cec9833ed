//! File formats: extended XYZ, NIST columns, tables, run record
