//! What molecules do: temperatures of their parts, strain of bonds, and the pressure by two routes.

mod vibration;

use crate::{
    BuildContext, Findings, Frames, Observable, ObservableSpec, Remark, Surroundings, Table, recipe,
};
use lennard_core::exact::exact_sum;
use lennard_core::{DVec3, View, Want, persist};

use crate::series::{Series, columns};
use vibration::vibration;

const SPEC: ObservableSpec = ObservableSpec {
    name: "molecules",
    summary: "temperatures of the centres of mass, of the motion inside molecules and of vibrations of springs, bond lengths, end-to-end distance, and the pressure over sites",
    equation: "T_centres = Σ M V²/(3M − 3); T_inside = 2(K − K_centres)/(n_dof − 3M + 3); T_vibration = Σ uᵀA⁻¹u/rank(A), A = G·M⁻¹·Gᵀ, u = G·v; P_sites = (2K + W_pairs + Σ λ|d|²)/(3V) + T/V",
    source: "Allen and Tildesley, Computer Simulation of Liquids, 2nd ed. (2017), sections 2.7.2 and 3.4",
    suits: crate::Suits::Molecules,
    surroundings: Surroundings::Periodic,
    frames: Frames::Velocities,
    alone: Some("is for molecules"),
    ..ObservableSpec::PLAIN
};

/// Rows kept before neighbors are averaged in pairs.
const MOST_ROWS: usize = 1 << 14;

lennard_core::options! {
    /// Options of [`MolecularMotion`]: there are none.
    pub struct MolecularMotionOptions {}
}

recipe!(MolecularMotionOptions, |_, context| MolecularMotion::new(context));

columns! {
    struct Rows {
        time, temperature_of_centers, temperature_inside, temperature_of_rotation,
        temperature_of_vibration, bond_length, bond_strain_squared, end_to_end_squared,
        pressure_of_sites
    }
}

/// Temperatures of the parts of molecules, their bonds and their extension, and the pressure by forces on sites.
///
/// - `temperature_of_centers`: Σ M V²/(3M − 3) over the M centres of mass.
/// - `temperature_inside`: twice the kinetic energy about the centres over its degrees of freedom: rotation of a rigid
///   dumbbell; rotation and vibration of others. Equipartition makes both temperatures equal.
/// - `temperature_of_vibration`, for bonds that are not rigid: of the motion that changes bond lengths, twice its kinetic energy
///   over its degrees of freedom. For a dumbbell of unit masses this is ½(u·w)², with the relative velocity w along the bond u.
/// - `temperature_of_rotation`, for such bonds: what else is inside, turns of bonds against each other included.
/// - `bond_length` and `bond_strain`: the mean |d| and the root mean square of |d|/r − 1.
/// - `end_to_end`: the root mean square distance of the first and the last site; the mean is given for chains alone.
/// - `pressure_of_sites`: (2K + W)/(3V) with the virial over pairs, springs and constraints, and T/V for the conserved
///   momentum. For rigid dumbbells it equals the pressure over molecules, (Σ M V² + Σ R_ab·F_ab)/(3V) + T/V, at each
///   instant. Without the tail.
#[derive(Debug, Clone, PartialEq)]
pub struct MolecularMotion {
    series: Series<Rows>,
    context: BuildContext,
    largest_residual: f64,
}

impl MolecularMotion {
    /// Nothing seen yet.
    #[must_use]
    pub fn new(context: &BuildContext) -> Self {
        Self {
            series: Series::new(Rows::default(), MOST_ROWS),
            context: context.clone(),
            largest_residual: 0.0,
        }
    }
}

/// Sums over molecules: Σ ½ M V² of the centres (ε), of bond lengths, of squared strains and of squared end-to-end distances.
/// The last two are the kinetic energy (ε) and the degrees of freedom of the motion that changes bond lengths.
fn sums(view: &View<'_>) -> [f64; 6] {
    let (system, state) = (view.system, view.state);
    let molecules = &system.molecules;
    let of_molecule = |m: usize| {
        let sites = molecules.sites_of(m);
        let (x, v) = (&state.positions[sites.clone()], &state.velocities[sites.clone()]);
        let mass: f64 = sites.clone().map(|i| system.masses.of(i)).sum();
        let momentum: DVec3 = sites.zip(v).map(|(i, v)| system.masses.of(i) * *v).sum();
        let (mut length, mut strain_squared) = (0.0, 0.0);
        for bond in molecules.bonds() {
            let found = bond.vector(x).length();
            length += found;
            strain_squared += (found / bond.length - 1.0).powi(2);
        }
        let first = molecules.sites_of(m).start;
        let of_springs = molecules.topology().filter(|_| !molecules.are_rigid());
        let [energy, rank] =
            of_springs.map_or([0.0; 2], |one| vibration(one, &system.masses, first, x, v));
        [
            0.5 * momentum.length_squared() / mass,
            length,
            strain_squared,
            (x[x.len() - 1] - x[0]).length_squared(),
            energy,
            rank,
        ]
    };
    exact_sum(system.n_molecules(), of_molecule)
}

impl Observable for MolecularMotion {
    fn spec(&self) -> &'static ObservableSpec {
        &SPEC
    }

    fn want(&self) -> Want {
        Want { virial: true, ..Want::NOTHING }
    }

    /// # Panics
    /// Where the state lacks what [`Observable::want`] asks for: that is a bug of the caller.
    fn sample(&mut self, view: &View<'_>) {
        let molecules = view.system.n_molecules() as f64;
        let bonds = molecules * view.system.molecules.bonds().len() as f64;
        let [centers, length, strain_squared, end_to_end_squared, vibration, vibrations] =
            sums(view);
        let kinetic = view.kinetic_energy();
        let n_dof = view.n_dof();
        let kept = 3.0 * view.len() as f64
            - if view.system.molecules.are_rigid() { bonds } else { 0.0 }
            - n_dof;
        let of_centers = 3.0 * molecules - kept;
        let inside = kinetic - centers;
        let constraints = view.constraint_sums();
        self.largest_residual = self.largest_residual.max(constraints.largest_residual);
        let virial = view.state.energetics.scalar_virial();
        let virial = virial.expect("the force evaluation gives what the observable wants");
        let w = constraints.virial;
        let virial = virial + w.x_axis.x + w.y_axis.y + w.z_axis.z;
        let volume = view.cell().volume();
        let momentum_part = kept / 3.0 * view.temperature() / volume;
        self.series.push(&[
            view.state.time,
            2.0 * centers / of_centers,
            2.0 * inside / (n_dof - of_centers),
            2.0 * (inside - vibration) / (n_dof - of_centers - vibrations),
            2.0 * vibration / vibrations,
            length / bonds,
            strain_squared / bonds,
            end_to_end_squared / molecules,
            (2.0 * kinetic + virial) / (3.0 * volume) + momentum_part,
        ]);
    }

    fn finish(&self, discarded: f64) -> Findings {
        let rows = self.series.rows();
        let cut = (discarded * rows.time.len() as f64).round() as usize;
        let squares = |column: &[f64]| column.iter().map(|x| x.sqrt()).collect::<Vec<_>>();
        let strain = squares(&rows.bond_strain_squared);
        let end_to_end = squares(&rows.end_to_end_squared);
        let is_rigid = self.context.molecules.are_rigid();
        let average = |name, unit, column| self.series.average(name, unit, column, cut);
        let mut averages = vec![
            average("temperature_of_centers", "ε/k_B", &rows.temperature_of_centers),
            average("temperature_inside_molecules", "ε/k_B", &rows.temperature_inside),
        ];
        let hidden = self.context.molecules.hide_forces();
        if !hidden {
            let pressure = &rows.pressure_of_sites;
            averages.push(average("pressure_of_sites", "ε/σ³", pressure));
        }
        if !is_rigid {
            let parts = [
                ("temperature_of_rotation", &rows.temperature_of_rotation),
                ("temperature_of_vibration", &rows.temperature_of_vibration),
            ];
            averages.extend(parts.map(|(name, of)| average(name, "ε/k_B", of)));
            averages.push(average("bond_length", "σ", &rows.bond_length));
            averages.push(average("bond_strain", "", &strain));
        }
        let topology = self.context.molecules.topology();
        if topology.is_some_and(|one| one.is_chain() && one.sites() > 2) {
            averages.push(average("end_to_end_distance", "σ", &end_to_end));
        }
        let mut remarks = vec![match hidden {
            true => "pressure_of_sites is left out: the forces of these bonds act inside the step",
            false => {
                "pressure_of_sites is by forces on sites, constraints included, and without the tail"
            }
        }
        .to_owned()];
        if is_rigid {
            remarks.push(format!("largest | |d|/r − 1 | of a bond: {:.2e}", self.largest_residual));
        }
        let mut table = Table::new("molecules", "molecules against time")
            .with("time", "τ", rows.time.clone())
            .with("temperature_of_centers", "ε/k_B", rows.temperature_of_centers.clone())
            .with("temperature_inside_molecules", "ε/k_B", rows.temperature_inside.clone())
            .with("bond_length", "σ", rows.bond_length.clone())
            .with("bond_strain", "", strain)
            .with("end_to_end_distance", "σ", end_to_end);
        if !is_rigid {
            let (rotation, vibration) =
                (&rows.temperature_of_rotation, &rows.temperature_of_vibration);
            table = table.with("temperature_of_rotation", "ε/k_B", rotation.clone()).with(
                "temperature_of_vibration",
                "ε/k_B",
                vibration.clone(),
            );
        }
        if !hidden {
            table = table.with("pressure_of_sites", "ε/σ³", rows.pressure_of_sites.clone());
        }
        Findings {
            averages,
            tables: vec![table],
            remarks: remarks.into_iter().map(Remark::from).collect(),
        }
    }
}

persist!(MolecularMotion { series, largest_residual, fixed context });
