//! The pressure tensor.

use crate::{
    Average, BuildContext, Findings, Frames, Observable, ObservableSpec, Surroundings, recipe,
};
use lennard_core::{DMat3, DVec3, View, Want, persist};

use crate::seen_box::SeenBox;
use crate::series::{Series, columns};

const SPEC: ObservableSpec = ObservableSpec {
    name: "pressure-tensor",
    summary: "the six components of the pressure tensor, and the surface tension of a slab across z",
    equation: "P_ab = [3N/n_dof · Σ m v_a v_b + Σ_{i<j} r_ij,a F_ij,b]/V + p_tail δ_ab",
    source: "J. H. Irving and J. G. Kirkwood, The statistical mechanical theory of transport processes IV, \
             J. Chem. Phys. 18, 817 (1950); surface tension: J. P. R. B. Walton, D. J. Tildesley, J. S. Rowlinson \
             and J. R. Henderson, Mol. Phys. 48, 1357 (1983), equation 2",
    suits: crate::Suits::Atoms,
    surroundings: Surroundings::Periodic,
    frames: Frames::Velocities,
    alone: None,
    ..ObservableSpec::PLAIN
};

/// Rows kept before neighbors are averaged in pairs.
const MOST_ROWS: usize = 1 << 16;

lennard_core::options! {
    /// Options of [`PressureTensor`]: there are none.
    pub struct PressureTensorOptions {}
}

recipe!(PressureTensorOptions, |_, context| PressureTensor::new(context));

columns! {
    struct Rows { time, xx, yy, zz, xy, xz, yz }
}

/// The pressure tensor in ε/σ³, with the tail on its diagonal where it is on.
///
/// The kinetic part carries the factor 3N/n_dof, so that a third of the trace is the pressure of
/// [`crate::Thermodynamics`], ρT + W/(3V) + p_tail, to rounding. For central pair forces the virial tensor is
/// symmetric; its two halves are averaged.
#[derive(Debug, Clone, PartialEq)]
pub struct PressureTensor {
    seen: SeenBox,
    series: Series<Rows>,
}

impl PressureTensor {
    /// Nothing seen yet.
    #[must_use]
    pub fn new(context: &BuildContext) -> Self {
        Self { seen: SeenBox::new(&context.cell), series: Series::new(Rows::default(), MOST_ROWS) }
    }

    /// The pressure tensor of one state, in ε/σ³, without the tail; `None` where the state has no virial.
    #[must_use]
    pub fn of(view: &View<'_>) -> Option<DMat3> {
        let (velocities, forces) = (&view.state.velocities, &view.state.forces);
        let masses = &view.system.masses;
        // The mean of m·v⊗v over the half steps on both sides, as in the scalar pressure: m·v⊗v + (h/2)²·F⊗F/m.
        let quarter = view.half_kick_step.map_or(0.0, |h| 0.25 * h * h);
        let kinetic: DMat3 = view.sum(|i| {
            let (mass, v, force) = (masses.of(i), velocities[i], forces[i]);
            outer(mass * v, v) + outer(force * (quarter / mass), force)
        });
        let degrees = 3.0 * view.len() as f64 / view.n_dof();
        let virial = view.state.energetics.virial?;
        let symmetric = (virial + virial.transpose()) * 0.5;
        Some((kinetic * degrees + symmetric) * (1.0 / view.cell().volume()))
    }
}

fn outer(a: DVec3, b: DVec3) -> DMat3 {
    DMat3::from_cols(a * b.x, a * b.y, a * b.z)
}

impl Observable for PressureTensor {
    fn spec(&self) -> &'static ObservableSpec {
        &SPEC
    }

    fn want(&self) -> Want {
        Want::VIRIAL_TENSOR
    }

    /// # Panics
    /// Where the state lacks what [`Observable::want`] asks for: that is a bug of the caller.
    fn sample(&mut self, view: &View<'_>) {
        let p = Self::of(view).expect("the force evaluation gives what the observable wants");
        self.seen.see(view.cell());
        let tail = view.tail.unwrap_or_default().pressure;
        self.series.push(&[
            view.state.time,
            p.x_axis.x + tail,
            p.y_axis.y + tail,
            p.z_axis.z + tail,
            p.y_axis.x,
            p.z_axis.x,
            p.z_axis.y,
        ]);
    }

    fn finish(&self, discarded: f64) -> Findings {
        let rows = self.series.rows();
        let cut = (discarded * rows.xx.len() as f64).ceil() as usize;
        let length = self.seen.sides().z;
        let tension: Vec<f64> = (0..rows.xx.len())
            .map(|i| 0.5 * length * (rows.zz[i] - 0.5 * (rows.xx[i] + rows.yy[i])))
            .collect();
        let pressure = "ε/σ³";
        let columns = [
            ("xx", &rows.xx),
            ("yy", &rows.yy),
            ("zz", &rows.zz),
            ("xy", &rows.xy),
            ("xz", &rows.xz),
            ("yz", &rows.yz),
        ];
        let average = |name: &str, unit, column| self.series.average(name, unit, column, cut);
        let mut averages: Vec<Average> = columns
            .iter()
            .map(|(name, column)| average(&format!("pressure_{name}"), pressure, column))
            .collect();
        averages.push(average("surface_tension_z", "ε/σ²", &tension));
        let columns = columns.map(|(name, column)| (name, pressure, column));
        let what = "components of the pressure tensor";
        let table = self.series.table("pressure_tensor", what, columns);
        Findings {
            averages,
            tables: vec![table],
            remarks: vec![
                "surface_tension_z = L_z/2·(P_zz − (P_xx + P_yy)/2) is the tension of one of two flat interfaces across z; in a homogeneous fluid it is zero within its error".into(),
            ],
        }
    }
}

persist!(PressureTensor { series, seen as "box" });
