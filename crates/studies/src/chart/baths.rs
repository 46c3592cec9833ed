//! Choices of barostat and thermostat around the scene's own.

use lennard_engine::measured_stage;
use lennard_integrators::barostats::{mtk, stochastic_cell_rescaling};
use lennard_integrators::{BarostatOptions, ThermostatOptions, bussi, langevin, nose_hoover};
use lennard_scene::{Scene, SceneError};

use super::types::Size;
use crate::settings::Baths;

/// Factors on the interval of the scene's barostat …
const INTERVALS: [f64; 4] = [0.2, 1.0, 5.0, 20.0];
/// … on its τ_p …
const PACES: [f64; 3] = [0.5, 1.0, 4.0];
/// … and on the τ of its thermostat.
const HEATS: [f64; 3] = [0.2, 1.0, 5.0];

/// The baths of the measured stage, which hold a pressure that other baths can hold too.
///
/// # Errors
/// [`SceneError`] where the scene has no barostat, where pressure or temperature change on the way, or where two phases stand side by side.
pub(super) fn own_baths(scene: &Scene) -> Result<Baths, SceneError> {
    let stage = measured_stage(scene);
    let index = (scene.stages.iter().rposition(|s| s.measure)).unwrap_or(scene.stages.len() - 1);
    let key = |name: &str| format!("stage.{index}.{name}");
    let allowed = "a stage that is measured with a thermostat and a barostat, at one temperature and one pressure; `lennard chart` without --ensemble for other scenes";
    let refused = |key: &str, message: &str, found: &str| {
        Err(scene.contradiction(key, message, found, allowed))
    };
    let (Some(control), Some(thermostat)) = (&stage.barostat, &stage.thermostat) else {
        let found = format!("stage {:?} at constant volume", stage.name);
        return refused(
            &key("barostat"),
            "is missing: `lennard chart --ensemble` crosses the settings of a barostat",
            &found,
        );
    };
    if stage.is_ramp() {
        let ramped = match stage.temperature_from {
            Some(_) => "temperature",
            None => "barostat.pressure",
        };
        let found = format!("a ramp in stage {:?}", stage.name);
        return refused(&key(ramped), "has no one value for `lennard chart --ensemble`", &found);
    }
    if scene.half_crystal().is_some() {
        return Err(scene.contradiction(
            "crystal",
            "has no one density for `lennard chart --ensemble`",
            "a crystal beside its liquid",
            "a homogeneous fluid",
        ));
    }
    Ok(Baths { thermostat: thermostat.clone(), barostat: control.options.clone() })
}

/// Refuses a scene whose measured stage holds no pressure that other baths can hold too.
///
/// # Errors
/// As the scene's own baths: [`SceneError`] without a barostat, with a ramp, and with two phases side by side.
pub fn suits(scene: &Scene) -> Result<(), SceneError> {
    own_baths(scene).map(drop)
}

/// Baths to be tried around the scene's own, in the order in which they are numbered; some stand there twice.
pub(super) fn choices(own: &Baths, size: Size) -> Vec<Baths> {
    let (scr, mtk) = (rescaling_like(own), chains_like(own));
    let of_scr = |interval, pace, heat| vary(&scr, interval, pace, heat);
    let of_mtk = |pace, heat| vary(&mtk, 1.0, pace, heat);
    let mut all = vec![own.clone()];
    match size {
        Size::Quick => all.extend([
            of_scr(0.2, 1.0, 1.0),
            of_scr(5.0, 1.0, 1.0),
            of_scr(1.0, 4.0, 1.0),
            mtk.clone(),
        ]),
        Size::Default => {
            for interval in INTERVALS {
                all.extend(PACES.map(|pace| of_scr(interval, pace, 1.0)));
            }
            for heat in HEATS {
                all.extend([of_scr(1.0, 1.0, heat), of_mtk(1.0, heat)]);
            }
            all.extend(PACES.map(|pace| of_mtk(pace, 1.0)));
        }
        Size::Full => {
            for heat in HEATS {
                for pace in PACES {
                    all.extend(INTERVALS.map(|interval| of_scr(interval, pace, heat)));
                    all.push(of_mtk(pace, heat));
                }
            }
        }
    }
    all
}

/// Stochastic cell rescaling in the place of another barostat, with its τ.
fn rescaling_like(own: &Baths) -> Baths {
    let barostat = match &own.barostat {
        BarostatOptions::StochasticCellRescaling(_) => own.barostat.clone(),
        BarostatOptions::Mtk(o) => {
            BarostatOptions::StochasticCellRescaling(stochastic_cell_rescaling::Options {
                tau: o.tau,
                ..stochastic_cell_rescaling::Options::default()
            })
        }
    };
    Baths { barostat, thermostat: own.thermostat.clone() }
}

/// The barostat of Martyna, Tobias and Klein in the place of another, with its τ and a chain on the particles.
fn chains_like(own: &Baths) -> Baths {
    let barostat = match &own.barostat {
        BarostatOptions::Mtk(_) => own.barostat.clone(),
        BarostatOptions::StochasticCellRescaling(o) => {
            BarostatOptions::Mtk(mtk::Options { tau: o.tau, ..mtk::Options::default() })
        }
    };
    let thermostat = match &own.thermostat {
        ThermostatOptions::NoseHoover(_) => own.thermostat.clone(),
        _ => ThermostatOptions::NoseHoover(nose_hoover::Options::default()),
    };
    Baths { barostat, thermostat }
}

/// These baths with factors on interval, τ_p and τ_T.
fn vary(of: &Baths, interval: f64, pace: f64, heat: f64) -> Baths {
    let barostat = match &of.barostat {
        BarostatOptions::StochasticCellRescaling(o) => {
            BarostatOptions::StochasticCellRescaling(stochastic_cell_rescaling::Options {
                interval: ((o.interval as f64 * interval).round() as u64).max(1),
                tau: o.tau * pace,
                ..o.clone()
            })
        }
        BarostatOptions::Mtk(o) => {
            BarostatOptions::Mtk(mtk::Options { tau: o.tau * pace, ..o.clone() })
        }
    };
    Baths { barostat, thermostat: with_tau(&of.thermostat, heat) }
}

/// A thermostat with a factor on its τ. Rescaling has none, and stays.
fn with_tau(of: &ThermostatOptions, factor: f64) -> ThermostatOptions {
    match of {
        ThermostatOptions::Bussi(o) => {
            ThermostatOptions::Bussi(bussi::Options { tau: o.tau * factor })
        }
        ThermostatOptions::NoseHoover(o) => {
            ThermostatOptions::NoseHoover(nose_hoover::Options { tau: o.tau * factor, ..o.clone() })
        }
        ThermostatOptions::Langevin(o) => {
            ThermostatOptions::Langevin(langevin::Options { friction: o.friction / factor })
        }
        ThermostatOptions::Rescale(_) => of.clone(),
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    const TEXT: &str = "[system]\nn_atoms = 500\ndensity = 0.65\ntemperature = 1.2\n[truncation]\nkind = \"shift\"\nr_cut = 2.5\n\
        [integrator]\ndt = 0.004\n[[stage]]\nname = \"p\"\nsteps = 1000\nthermostat = { kind = \"bussi\", tau = 0.5 }\n\
        barostat = { kind = \"stochastic-cell-rescaling\", pressure = 1.0, tau = 1.0, interval = 10 }\n";

    #[test]
    fn the_last_measured_stage_is_the_one_that_is_named() {
        let bare = TEXT.split("barostat").next().unwrap();
        let measured = bare.replacen("name = \"p\"", "name = \"p\"\nmeasure = true", 1);
        let stage = &measured[measured.find("[[stage]]").unwrap()..];
        let text = format!("{measured}{}", stage.replace("\"p\"", "\"q\""));
        let scene = Scene::parse(&text, "t.toml", &[]).unwrap();
        let error = own_baths(&scene).unwrap_err().to_string();
        assert!(
            error.contains("`stage.1.barostat` is missing") && error.contains("stage \"q\""),
            "{error}"
        );
    }

    #[test]
    fn a_ramp_is_refused_by_its_key_and_a_crystal_beside_its_liquid_by_its_table() {
        let refused = |text: &str| {
            let scene = Scene::parse(text, "t.toml", &[]).unwrap();
            own_baths(&scene).unwrap_err().to_string()
        };
        let ramp = "{ from = 1.0, to = 1.2 }";
        let warmer = TEXT.replace("steps = 1000", &format!("steps = 1000\ntemperature = {ramp}"));
        let error = refused(&warmer);
        assert!(
            error.contains("`stage.0.temperature` has no one value for `lennard chart --ensemble`"),
            "{error}"
        );
        let error = refused(&TEXT.replace("pressure = 1.0", &format!("pressure = {ramp}")));
        assert!(
            error.contains(
                "`stage.0.barostat.pressure` has no one value for `lennard chart --ensemble`"
            ),
            "{error}"
        );
        let file = lennard_scene::shipped::locate(Path::new("two-phase/melting"));
        let error = own_baths(&Scene::load(&file, &[]).unwrap()).unwrap_err();
        let error = error.to_string();
        assert!(
            error.contains("`crystal` has no one density for `lennard chart --ensemble`"),
            "{error}"
        );
    }

    #[test]
    fn a_scene_without_a_barostat_is_refused_by_its_stage() {
        let text =
            TEXT.lines().filter(|l| !l.starts_with("barostat")).collect::<Vec<_>>().join("\n");
        let scene = Scene::parse(&text, "t.toml", &[]).unwrap();
        let error = own_baths(&scene).unwrap_err().to_string();
        assert!(
            error.contains("t.toml") && error.contains("`stage.0.barostat` is missing"),
            "{error}"
        );
        assert!(error.contains("at constant volume") && error.contains("--ensemble"), "{error}");
    }
}
