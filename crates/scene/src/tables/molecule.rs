//! The tables `[molecule]` and `[bonds]`: what the molecules are, and how their bonds are held.

use std::sync::Arc;

use lennard_core::{DVec3, MOST_SITES, Molecules, Topology};
use lennard_integrators::BondOptions;

lennard_core::choices! {
    /// The kind of the molecules.
    pub enum MoleculeKind {
        /// Two sites.
        #[default]
        Dumbbell = "dumbbell",
        /// A chain of sites.
        Chain = "chain",
        /// Sites with bonds as the scene lists them: rings, branched molecules, rigid triangles.
        Sites = "sites",
    }
}

lennard_core::options! {
    /// The table `[molecule]`.
    pub struct MoleculeOptions {
        /// Kind of the molecules: a dumbbell has two sites, a chain 2 to 64, and `sites` are joined as `bonds` says. The two sites of a bond do not interact.
        kind: MoleculeKind = MoleculeKind::Dumbbell, Names(MoleculeKind::names);
        /// Sites of each molecule; a scene must say, except for dumbbells.
        sites: u32 = 2, Whole(2, MOST_SITES as i64);
        /// Length of each bond, below `truncation.r_cut`.
        bond_length: Option<f64> = None, else "needed for dumbbells and chains", Between(0.01, 100.0), in "σ";
        /// The bonds of `sites`: pairs of sites, which count from 1, as `[[1, 2], [2, 3], [3, 1]]`.
        bonds: Option<Vec<[u32; 2]>> = None, else "needed for `sites`", Words("a list of pairs of sites, each pair once, that leaves no site apart");
        /// Length of each bond of `sites`, in the order of `bonds`, where lengths differ.
        bond_lengths: Option<Vec<f64>> = None, else "`bond_length` for all, or as in `shape`", Words("a list with one length for each bond, each from 0.01 to 100"), in "σ";
        /// Places of the `sites` of one molecule, for a start on a lattice. It stands there as it is and turned by half a turn about x, y and z.
        shape: Option<Vec<[f64; 3]>> = None, else "needed for `sites` on a lattice", Words("a list with one place [x, y, z] for each site"), in "σ";
    }
}

/// The molecules of a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Molecule {
    /// The table `[molecule]`.
    pub options: MoleculeOptions,
    /// The table `[bonds]`.
    pub bonds: BondOptions,
    /// What is bonded to what in each molecule.
    pub topology: Arc<Topology>,
}

impl Molecule {
    /// The molecules as a system has them.
    #[must_use]
    pub fn molecules(&self) -> Molecules {
        Molecules::new(Arc::clone(&self.topology), self.bonds.bonds())
    }

    /// ω of the fastest vibration of bonds between unit masses, τ⁻¹; zero where bonds do not limit the step.
    ///
    /// Bonds that share sites vibrate faster together than alone: a long chain √2 times as fast.
    #[must_use]
    pub fn fastest_vibration(&self) -> f64 {
        self.bonds.frequency() * (0.5 * self.topology.stiffest()).sqrt()
    }

    /// Places of the sites of one molecule, σ, where the scene has them.
    #[must_use]
    pub fn shape(&self) -> Option<Vec<DVec3>> {
        let shape = self.options.shape.as_ref()?;
        Some(shape.iter().map(|r| DVec3::from_array(*r)).collect())
    }

    /// The key that the size of the molecules stands at.
    #[must_use]
    pub fn key_of_size(&self) -> &'static str {
        let MoleculeOptions { bond_length, bond_lengths, .. } = &self.options;
        match (bond_length, bond_lengths) {
            (Some(_), _) => "molecule.bond_length",
            (None, Some(_)) => "molecule.bond_lengths",
            (None, None) => "molecule.shape",
        }
    }
}
