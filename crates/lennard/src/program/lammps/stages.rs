//! Stages as fixes and runs.

use lennard_integrators::barostats::mtk;
use lennard_integrators::{
    BarostatOptions, Coupling, IntegratorOptions, ThermostatOptions, nose_hoover,
};
use lennard_scene::{PressureControl, Scene, Stage};

use super::script::Script;
use lennard_engine::{EngineError, Simulation};

/// Seeds of LAMMPS are positive and have 31 bits; some fixes add to them.
const SEEDS: u64 = 900_000_000;

/// Columns of a dump: a start of Lennard, and what readers want.
const DUMP: &str = "id type x y z ix iy iz vx vy vz";

/// Writes the stages that are left, or the last one once more.
pub(super) fn write(script: &mut Script, simulation: &Simulation) -> Result<(), EngineError> {
    let scene = &simulation.scene;
    let step = simulation.state.step;
    let left = (0..scene.stages.len()).find(|i| step < scene.steps_before(i + 1));
    if left.is_none() {
        script.gap();
        script.comment("The run is finished: its last stage once more.");
    }
    for index in left.unwrap_or(scene.stages.len() - 1)..scene.stages.len() {
        let stage = &scene.stages[index];
        let done = step.saturating_sub(scene.steps_before(index));
        let steps = match left {
            Some(first) if first == index => stage.steps - done,
            _ => stage.steps,
        };
        write_stage(script, scene, index, steps)?;
    }
    Ok(())
}

fn write_stage(
    script: &mut Script,
    scene: &Scene,
    index: usize,
    steps: u64,
) -> Result<(), EngineError> {
    let stage = &scene.stages[index];
    script.gap();
    script.comment(format!("Stage {}", stage.name));
    if steps < stage.steps && stage.is_ramp() {
        script.remark(format!("the ramp of stage {} begins anew: part of it is done", stage.name));
    }
    script.command("timestep", format!("{:?}", scene.stage_dt(stage)));
    let seed = 1 + (scene.system.seed + index as u64) % SEEDS;
    let end = fixes(script, scene, stage, index, seed)?;
    if let Some(every) = scene.output.trajectory_every.filter(|_| stage.measure) {
        let file = format!("{}.lammpstrj", stage.name);
        script.command("dump", format!("frames all custom {every} {file} {DUMP}"));
        script.command("dump_modify", "frames sort id format float %.17g");
    }
    script.command("run", steps.to_string());
    if scene.output.trajectory_every.is_some() && stage.measure {
        script.command("undump", "frames");
    }
    for command in end.into_iter().rev() {
        let (name, arguments) = command.split_once(' ').unwrap_or((&command, ""));
        script.command(name, arguments);
    }
    Ok(())
}

/// "1.2 1.2", or both ends of a ramp.
fn from_to(from: Option<f64>, to: f64) -> String {
    format!("{:?} {to:?}", from.unwrap_or(to))
}

/// Writes the fixes of a stage, and gives the commands that end them, the last one first.
fn fixes(
    script: &mut Script,
    scene: &Scene,
    stage: &Stage,
    index: usize,
    seed: u64,
) -> Result<Vec<String>, EngineError> {
    let temperature = from_to(stage.temperature_from, stage.temperature);
    let chain = |options: &nose_hoover::Options| {
        format!("temp {temperature} {:?} tchain {}", options.tau, options.chain)
    };
    if let Some(control) = &stage.barostat {
        let chain = match &stage.thermostat {
            Some(ThermostatOptions::NoseHoover(options)) => chain(options),
            other => {
                let name = other.as_ref().map_or("none", ThermostatOptions::name);
                script.remark(format!(
                    "the thermostat {name} of stage {} is inside `fix npt` a chain of Nosé and Hoover",
                    stage.name
                ));
                chain(&nose_hoover::Options::default())
            }
        };
        let pressure = barostat(script, scene, stage, index, control)?;
        script.command("fix", format!("move all npt {chain} {pressure}"));
        return Ok(vec!["unfix move".to_owned()]);
    }
    let method = &scene.integrator.method;
    let own_step = matches!(stage.thermostat, Some(ThermostatOptions::Langevin(_)));
    if !(matches!(method, IntegratorOptions::VelocityVerlet(_)) || own_step) {
        script.remark(format!(
            "the integrator {} of stage {} is velocity Verlet (`fix nve`)",
            method.name(),
            stage.name
        ));
    }
    let mut end = vec!["unfix move".to_owned()];
    match &stage.thermostat {
        Some(ThermostatOptions::NoseHoover(options)) => {
            script.command("fix", format!("move all nvt {}", chain(options)));
            return Ok(end);
        }
        _ => script.command("fix", "move all nve"),
    }
    let bath = match &stage.thermostat {
        None | Some(ThermostatOptions::NoseHoover(_)) => return Ok(end),
        Some(ThermostatOptions::Bussi(options)) => {
            format!("temp/csvr {temperature} {:?} {seed}", options.tau)
        }
        Some(ThermostatOptions::Rescale(options)) => {
            format!("temp/rescale {} {temperature} 0.0 1.0", options.every)
        }
        Some(ThermostatOptions::Langevin(options)) => {
            script.remark(format!(
                "the thermostat langevin of stage {} has another splitting in LAMMPS than BAOAB",
                stage.name
            ));
            // Noise on every particle: 3N degrees of freedom.
            script.command("compute_modify", "thermo_temp extra/dof 0");
            end.push("compute_modify thermo_temp extra/dof 3".to_owned());
            format!("langevin {temperature} {:?} {seed}", 1.0 / options.friction)
        }
    };
    script.command("fix", format!("bath all {bath}"));
    end.push("unfix bath".to_owned());
    Ok(end)
}

/// The arguments of `fix npt` for a barostat.
fn barostat(
    script: &mut Script,
    scene: &Scene,
    stage: &Stage,
    index: usize,
    control: &PressureControl,
) -> Result<String, EngineError> {
    let options = &control.options;
    if options.coupling() != Coupling::Isotropic {
        let found = format!("{:?}, in an export to LAMMPS", options.coupling().name());
        let key = format!("stage.{index}.barostat.coupling");
        return Err(scene.source.invalid(&key, found, "\"isotropic\"").into());
    }
    let chain = match options {
        BarostatOptions::Mtk(own) => own.chain,
        BarostatOptions::StochasticCellRescaling(_) => {
            script.remark(format!(
                "the barostat {} of stage {} is the barostat of Martyna, Tobias and Klein (`fix npt`)",
                options.name(),
                stage.name
            ));
            mtk::Options::default().chain
        }
    };
    let pressure = from_to(control.pressure_from, control.pressure);
    Ok(format!("iso {pressure} {:?} pchain {chain}", options.tau()))
}
