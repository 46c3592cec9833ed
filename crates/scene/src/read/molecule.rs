//! Reads the tables `[molecule]` and `[bonds]`.

use std::sync::Arc;

use lennard_core::{Bond, Bonds, DVec3, Topology};
use lennard_integrators::BondOptions;

use crate::read::Reader;
use crate::{Molecule, MoleculeKind, MoleculeOptions, Scene, SceneError};

/// Lengths that are written and places of a shape may differ by this share.
const LARGEST_STRAIN: f64 = 1e-3;

impl Reader<'_> {
    pub fn molecule(&self) -> Result<Option<Molecule>, SceneError> {
        if !self.source.wrote("molecule") {
            if self.source.wrote("bonds") {
                return Err(self
                    .refuse("bonds", "has no bonds to hold")
                    .found("`[bonds]` without `[molecule]`")
                    .allowed("a table `[molecule]` beside it"));
            }
            return Ok(None);
        }
        let options: MoleculeOptions = self.plain("molecule")?;
        let topology = match options.kind {
            MoleculeKind::Dumbbell | MoleculeKind::Chain => self.chain(&options)?,
            MoleculeKind::Sites => self.sites(&options)?,
        };
        let bonds: BondOptions = self.section("bonds").method(self.table("bonds"))?;
        let molecule = Molecule { options, bonds, topology: Arc::new(topology) };
        if let (Bonds::Rigid, Some(shape)) = (molecule.bonds.bonds(), molecule.shape())
            && let Some(bond) = molecule.topology.redundant_bond(&shape, |_| false)
        {
            return Err(redundant(&molecule, self.source, bond, "the shape"));
        }
        Ok(Some(molecule))
    }

    fn needed_of_molecule(&self, key: &str, allowed: &str) -> SceneError {
        self.refuse(&format!("molecule.{key}"), "is missing").found("nothing").allowed(allowed)
    }

    fn chain(&self, options: &MoleculeOptions) -> Result<Topology, SceneError> {
        let Some(length) = options.bond_length else {
            return Err(self.needed_of_molecule(
                "bond_length",
                "a length above 0 and below `truncation.r_cut`, σ",
            ));
        };
        for key in ["bonds", "bond_lengths", "shape"] {
            if self.source.wrote(&format!("molecule.{key}")) {
                return Err(self
                    .refuse(&format!("molecule.{key}"), "is not used")
                    .found(format!("`{key}` with kind = {:?}", options.kind.name()))
                    .allowed("kind = \"sites\", or no such key"));
            }
        }
        match options.kind {
            MoleculeKind::Dumbbell if options.sites != 2 => {
                Err(self.section("molecule").impossible(
                    "sites",
                    &options.sites.to_string(),
                    "2 for a dumbbell; kind = \"chain\" takes more",
                ))
            }
            MoleculeKind::Chain if !self.source.wrote("molecule.sites") => {
                Err(self.needed_of_molecule("sites", "a whole number from 2 to 64"))
            }
            _ => Ok(Topology::chain(options.sites as usize, length)),
        }
    }

    /// Molecules whose bonds the scene lists.
    fn sites(&self, options: &MoleculeOptions) -> Result<Topology, SceneError> {
        let refuse = |key: &str, found: String, allowed: String| {
            Err(self.section("molecule").impossible(key, &found, &allowed))
        };
        if !self.source.wrote("molecule.sites") {
            return Err(self.needed_of_molecule("sites", "a whole number from 2 to 64"));
        }
        let Some(pairs) = &options.bonds else {
            return Err(
                self.needed_of_molecule("bonds", "pairs of sites, as [[1, 2], [2, 3], [3, 1]]")
            );
        };
        let sites = options.sites as usize;
        let shape: Option<Vec<DVec3>> = (options.shape.as_ref())
            .map(|shape| shape.iter().map(|r| DVec3::from_array(*r)).collect());
        if let Some(shape) = &shape
            && shape.len() != sites
        {
            let found = shape.len().to_string();
            return refuse("shape", found, format!("{sites} places, one for each site"));
        }
        let lengths = match (options.bond_length, &options.bond_lengths, &shape) {
            (Some(_), Some(_), _) => {
                let found = "`bond_length` and `bond_lengths`".to_owned();
                return refuse("bond_lengths", found, "one of the two".to_owned());
            }
            (None, Some(lengths), _) => {
                let fits = |r: &f64| (0.01..=100.0).contains(r);
                if lengths.len() != pairs.len() || !lengths.iter().all(fits) {
                    return refuse(
                        "bond_lengths",
                        format!("{lengths:?}"),
                        format!("{} lengths, each from 0.01 to 100 σ", pairs.len()),
                    );
                }
                lengths.iter().map(|r| Some(*r)).collect()
            }
            (Some(length), None, _) => vec![Some(length); pairs.len()],
            (None, None, Some(_)) => vec![None; pairs.len()],
            (None, None, None) => {
                return Err(self
                    .needed_of_molecule("bond_length", "a length, `bond_lengths`, or a `shape`"));
            }
        };
        let mut bonds = Vec::new();
        for (pair, length) in pairs.iter().zip(lengths) {
            // A site 0 is no site: it becomes one that the molecule does not have.
            let joined = pair.map(|site| (site as usize).wrapping_sub(1));
            let inside = joined.iter().all(|site| *site < sites);
            let apart = shape
                .as_ref()
                .filter(|_| inside)
                .map(|shape| (shape[joined[1]] - shape[joined[0]]).length());
            let length = length.or(apart).unwrap_or(1.0);
            if let Some(apart) = apart
                && ((apart / length - 1.0).abs() > LARGEST_STRAIN || apart.is_nan() || apart < 0.01)
            {
                let found = format!("sites {} and {} at {apart:.6} σ", pair[0], pair[1]);
                return refuse("shape", found, format!("a bond of {length} σ, within 0.1 %"));
            }
            bonds.push(Bond { sites: joined, length });
        }
        Topology::new(sites, bonds).or_else(|e| {
            refuse("bonds", e.to_string(), "pairs of sites, each once, that join all".to_owned())
        })
    }
}

impl Scene {
    /// The refusal of a bond that follows from the others where a molecule has this form.
    #[must_use]
    pub fn redundant(&self, bond: usize, found: &str) -> SceneError {
        let molecule = self.molecule.as_ref().expect("the scene has molecules");
        redundant(molecule, &self.source, bond, found)
    }
}

fn redundant(molecule: &Molecule, source: &crate::Source, bond: usize, found: &str) -> SceneError {
    let [i, j] = molecule.topology.bonds()[bond].sites.map(|site| site + 1);
    source
        .refuse("molecule.bonds", "has constraints that are redundant")
        .found(format!(
            "bond {} (sites {i} and {j}), which follows from the others in {found}",
            bond + 1
        ))
        .allowed(
            "bonds that are all needed (no more than 3·sites − 6, not three along a line); or springs, or SPOOK with a compliance",
        )
}
