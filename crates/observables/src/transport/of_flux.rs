//! A transport coefficient of one fluid from the fluctuations of its flux at equilibrium.

use std::marker::PhantomData;

use crate::{BuildContext, Findings, Observable, ObservableError, ObservableSpec};
use lennard_core::{View, Want, persist};

use super::checked_interval;
use super::green_kubo::{GreenKubo, Words};
use crate::seen_box::SeenBox;

/// A flux j with the coefficient κ = A ∫₀^∞ ⟨j(0)·j(t)⟩ dt, averaged over its equivalent components.
pub trait Flux: Send + 'static {
    /// What the observable declares about itself.
    const SPEC: &'static ObservableSpec;
    /// Names and units of the coefficient.
    const WORDS: Words;
    /// What the flux needs from the force evaluation.
    const WANT: Want;
    /// Number of components.
    const COMPONENTS: usize;

    /// The components in one state; `None` where the state lacks what the flux needs.
    fn of(view: &View<'_>) -> Option<impl AsRef<[f64]>>;

    /// A at a volume in σ³ and a temperature in ε/k_B.
    fn prefactor(volume: f64, temperature: f64) -> f64;
}

/// The coefficient of a flux.
#[derive(Debug, Clone, PartialEq)]
pub struct OfFlux<F> {
    seen: SeenBox,
    flux: GreenKubo,
    of: PhantomData<F>,
}

impl<F: Flux> OfFlux<F> {
    /// Nothing seen yet; `window` is the longest lag of the correlation, τ.
    ///
    /// # Errors
    /// [`ObservableError`] where the window is no positive number or shorter than 32 samples.
    pub fn new(window: f64, context: &BuildContext) -> Result<Self, ObservableError> {
        let interval = checked_interval(window, context)?;
        Ok(Self {
            seen: SeenBox::new(&context.cell),
            flux: GreenKubo::new(F::COMPONENTS, interval, window),
            of: PhantomData,
        })
    }
}

impl<F: Flux> Observable for OfFlux<F> {
    fn spec(&self) -> &'static ObservableSpec {
        F::SPEC
    }

    fn want(&self) -> Want {
        F::WANT
    }

    /// # Panics
    /// Where the state lacks what [`Observable::want`] asks for: that is a bug of the caller.
    fn sample(&mut self, view: &View<'_>) {
        let flux = F::of(view).expect("the force evaluation gives what the observable wants");
        self.seen.see(view.cell());
        self.flux.push(flux.as_ref(), view.temperature());
    }

    fn finish(&self, discarded: f64) -> Findings {
        let temperature = self.flux.mean_temperature(discarded);
        let prefactor = F::prefactor(self.seen.volume(), temperature);
        self.flux.findings(discarded, prefactor, F::WORDS)
    }
}

persist!([F: Flux] OfFlux<F> { ..flux, seen as "box", fixed of });
