//! Tables and the run record.

use crate::common::{refused, scratch};
use lennard_io::{
    AverageRecord, Comparison, Conservation, Host, NeighborRecord, PairRecord, Performance,
    RUN_SCHEMA, RunRecord, SpeciesRecord, StageSeconds, StatePoint, TableWriter, ThermostatRecord,
    read_run_record, read_run_record_bytes, read_table_csv, write_json_atomically, write_table_csv,
};
use lennard_observables::{Average, Cell, Column, Estimate, Fronts, Remark, Table};

fn table() -> Table {
    Table::new("rdf", "radial distribution function")
        .with("r", "σ", vec![0.1, 1.0, 1e-300])
        .with("g", "", vec![0.0, f64::NAN, f64::NEG_INFINITY])
        .with("a, \"quoted\" name", "ε/σ³", vec![1.0, 2.0, 3.0])
}

#[test]
fn a_table_has_its_units_below_the_heading_and_reads_back_to_the_bit() {
    let (_folder, path) = scratch("rdf.csv");
    write_table_csv(&path, &table()).unwrap();
    assert_eq!(
        std::fs::read_to_string(&path).unwrap(),
        "r,g,a_quoted_name\n# r [σ]\n# a_quoted_name [ε/σ³]: a, \"quoted\" name\n# radial distribution function\n\
         0.1,0.0,1.0\n1.0,nan,2.0\n1e-300,-inf,3.0\n"
    );
    let back = read_table_csv(&path).unwrap();
    assert_eq!(back.name, "rdf");
    for (written, read) in table().columns.iter().zip(&back.columns) {
        assert_eq!(written.unit, read.unit);
        let bits = |column: &Column| -> Vec<u64> {
            column.numbers().iter().map(|x| x.to_bits()).collect()
        };
        assert_eq!(bits(written), bits(read));
    }
}

#[test]
fn words_errors_and_missing_values_have_fields_of_their_own() {
    let items = [("a, b", Some(0.5), Some((1.0, 0.25)), 7_u64), ("c", None, None, 8)];
    let table = Table::rows_of("t", &items)
        .column("name", |i| i.0)
        .column("x [σ]", |i| Cell::rounded(i.1, 2))
        .measured("u [ε]", |i| i.2)
        .column("n", |i| i.3)
        .column("range", |i| Cell::figures(format!("{} – {}", i.3, i.3 + 1)))
        .table();
    let (folder, path) = scratch("t.csv");
    write_table_csv(&path, &table).unwrap();
    assert_eq!(
        std::fs::read_to_string(&path).unwrap(),
        "name,x,u,u_standard_error,n,range\n# x [σ]\n# u [ε]\n\"a, b\",0.5,1.0,0.25,7,7 – 8\nc,,,,8,8 – 9\n"
    );
    let path = folder.path().join("t.json");
    write_json_atomically(&path, &table).unwrap();
    let read: serde_json::Value = serde_json::from_slice(&std::fs::read(&path).unwrap()).unwrap();
    assert_eq!(
        read["columns"][2],
        serde_json::json!({
            "name": "u",
            "unit": "ε",
            "cells": [{"value": 1.0, "standard_error": 0.25}, null],
        })
    );
}

#[test]
fn a_growing_table_quotes_words_and_leaves_missing_values_empty() {
    let (_folder, path) = scratch("t.csv");
    let mut writer = TableWriter::create(&path, &[("step", ""), ("word", "")]).unwrap();
    writer.write(&[1_u64.into(), "a, b".into()]).unwrap();
    writer.write(&[2_u64.into(), Cell::default()]).unwrap();
    assert_eq!(writer.mark().records, 2);
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "step,word\n1,\"a, b\"\n2,\n");
}

#[test]
fn headings_are_names_in_every_language_and_each_is_there_once() {
    let names = ["P − P₀", "ρ", "χ² per point", "T", "t", "dt / limit", "|x|", "± ", "g_A_B"];
    let table = names.iter().fold(Table::new("t", ""), |t, name| t.with(*name, "", vec![1.0]));
    let (_folder, path) = scratch("t.csv");
    write_table_csv(&path, &table.with("potential_energy", "", vec![1.0])).unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    assert!(
        text.starts_with(
            "p_minus_p,density,chi_squared_per_point,t,t_,dt_per_limit,x,column_,g_A_B,potential_energy\n"
        ) && text.contains("\n# potential_energy [ε]: potential energy U/N\n"),
        "{text}"
    );
}

#[test]
fn columns_of_different_lengths_are_refused_and_nothing_is_written() {
    let (_folder, path) = scratch("t.csv");
    let ragged = table().with("short", "", vec![1.0]);
    refused(write_table_csv(&path, &ragged), &["[3, 3, 3, 1]"]);
    assert!(write_table_csv(&path, &Table::new("t", "no column")).is_err());
    assert!(!path.exists());
}

#[test]
fn a_table_with_a_bad_row_is_refused_with_its_line() {
    for (text, line, found) in
        [("a,b\n1,2\n3\n", 3, "3"), ("a,b\n1,2\n3,x\n", 3, "`x`"), ("", 1, "no heading")]
    {
        let error = lennard_io::read_table_csv_bytes(text.as_bytes()).unwrap_err();
        assert_eq!(error.line(), Some(line), "{error}");
        assert!(error.to_string().contains(found), "{error}");
    }
}

fn record() -> RunRecord {
    let average = Average {
        name: "pressure".into(),
        unit: "ε/σ³".into(),
        estimate: Estimate {
            mean: 0.1 + 0.2,
            standard_error: f64::NAN,
            n_effective: 12.5,
            least_effective: 12.5,
            freedom: 32.0,
            equilibration_cut: 40,
        },
        doubt: None,
    };
    RunRecord {
        schema: RUN_SCHEMA.into(),
        finished: true,
        scene: serde_json::json!({"system": {"seed": 1}, "potential": {"kind": "lennard-jones"}}),
        model: "Lennard-Jones, cut at 2.5 σ, with tail correction".into(),
        seed: u64::MAX,
        version: "0.1.0".into(),
        host: Host { cpu: "a processor".into(), isa: "avx2".into(), threads: 2 },
        steps: 20_000,
        atoms: 864,
        species: vec![SpeciesRecord {
            name: "A".into(),
            element: "Ar".into(),
            count: 864,
            fraction: 1.0,
            mass: 2.0,
        }],
        pairs: vec![PairRecord {
            a: "A".into(),
            b: "A".into(),
            sigma: 1.1,
            epsilon: 0.9,
            r_cut: 2.75,
        }],
        n_dof: 2589,
        wall_s: 3.25,
        performance: Performance {
            atom_steps_per_s: 5.3e6,
            ns_per_atom_step: 188.0,
            stages: StageSeconds {
                force: 2.5,
                neighbor: 0.25,
                integrate: 0.25,
                observe: 0.125,
                write: 0.125,
            },
            ranks: None,
        },
        neighbor: NeighborRecord {
            builds: 900,
            checked_forces: 1200,
            largest_deviation: Some(0.03125),
            skin: Some(0.3),
        },
        units: None,
        averages: [(average.name.clone(), AverageRecord::new(&average, 1000))].into(),
        conservation: Conservation {
            energy_drift_per_atom_per_tau: -1.5e-8,
            energy_drift_standard_error: 2e-8,
            energy_rms_per_atom: 1e-4,
            momentum_per_atom: 1e-17,
        },
        barostat: None,
        thermostat: Some(ThermostatRecord {
            name: "bussi".into(),
            heat: -3.5,
            conserved_quantity: "total energy − heat".into(),
        }),
        tables: vec!["rdf.csv".to_owned()],
        comparison: vec![Comparison {
            quantity: "pressure".into(),
            unit: "ε/σ³".into(),
            measured: 0.31,
            reference: 0.3,
            finite_size: Some(0.25),
            finite_size_uncertainty: Some(0.5),
            reference_uncertainty: None,
            difference: 0.01,
            standard_error: 0.02,
            in_standard_errors: 0.5,
            at: StatePoint { temperature: 0.722, half_steps: true, density: 0.8442 },
            source: "a source".into(),
            remark: String::new(),
        }],
        remarks: vec!["a remark".into()],
        typed_remarks: vec![
            Remark::LeftOut { quantities: vec!["pressure".into()], why: "a reason".into() },
            Remark::Fronts(Fronts::Neither { solid_shares: [0.5, 0.25] }),
        ],
        trajectory_frames: Some(201),
        trajectory: None,
    }
}

/// The file in `tests/data` is the schema: scripts of others rely on these names.
#[test]
fn the_run_record_is_written_byte_for_byte_as_the_schema_says() {
    let (_folder, path) = scratch("run.json");
    write_json_atomically(&path, &record()).unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    assert_eq!(text, include_str!("../data/run.json"));
    let back = read_run_record(&path).unwrap();
    assert_eq!(back.averages["pressure"].estimate.mean.to_bits(), (0.1_f64 + 0.2).to_bits());
    assert!(back.averages["pressure"].estimate.standard_error.is_nan());
    assert_eq!(back.seed, u64::MAX);
    let again = serde_json::to_string_pretty(&back).unwrap() + "\n";
    assert_eq!(again, text);
}

#[test]
fn a_record_of_another_schema_is_refused_by_name() {
    let text = include_str!("../data/run.json").replace("lennard-run/1", "lennard-run/9");
    refused(read_run_record_bytes(text.as_bytes()), &["lennard-run/9", "lennard-run/1"]);
}
