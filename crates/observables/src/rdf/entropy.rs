//! The two-body entropy, from g(r).

use crate::Average;

use super::RadialDistribution;
use crate::averages::of_blocks;
use crate::binned::Binned;
use crate::species_pairs::SpeciesPair;

impl RadialDistribution {
    /// The part of the residual entropy that pairs give, per particle in k_B, up to `r_max`:
    ///
    /// s₂ = −2πρ Σ_ab x_a·x_b ∫ (g_ab·ln g_ab − g_ab + 1) r² dr.
    ///
    /// It is the first term of an expansion of the residual entropy (R. E. Nettleton and M. S. Green, J. Chem. Phys. 29, 1365
    /// (1958); A. Baranyai and D. J. Evans, Phys. Rev. A 40, 3817 (1989)). `None` for molecules, whose sites are bonded.
    pub(super) fn two_body_entropy(&self, counts: &Binned<SpeciesPair>) -> Option<Average> {
        if self.sites > 1 {
            return None;
        }
        let density = self.n_atoms as f64 / self.seen.volume();
        let species = &self.species;
        let (value, blocks) = match &counts.parts[..] {
            [] => self.reading().two_body_entropy(&counts.whole, density)?,
            pairs => {
                let mut sum = (0.0, Vec::new());
                for (pair, counts) in pairs {
                    let ordered = pair.ordered(species);
                    if ordered == 0.0 {
                        continue;
                    }
                    let weight = if pair.a == pair.b { 2.0 } else { 1.0 };
                    // Unlike pairs count for both orders.
                    let fractions = species.fraction(pair.a) * species.fraction(pair.b);
                    let density = density * fractions * 2.0 / weight;
                    let reading = self.reading_of(weight, ordered);
                    let (value, blocks) = reading.two_body_entropy(counts, density)?;
                    sum.0 += value;
                    sum.1.resize(blocks.len(), 0.0);
                    sum.1.iter_mut().zip(blocks).for_each(|(sum, b)| *sum += b);
                }
                sum
            }
        };
        Some(of_blocks("two_body_entropy", "k_B", value, &blocks, 0.0))
    }
}
