//! What observables say when an option does not suit the run.

use lennard_core::{PeriodicBox, Species, SpeciesTable};
use lennard_observables::{BuildContext, ObservableOptions, build};

#[test]
fn an_option_that_does_not_suit_the_run_is_named_with_what_is_allowed() {
    let context = BuildContext {
        cell: PeriodicBox::new(lennard_core::DVec3::splat(10.0)).unwrap(),
        n_atoms: 100,
        dt: 0.004,
        every: 10,
        r_cut: 2.5,
        molecules: lennard_core::Molecules::ATOMS,
        species: SpeciesTable::one(Species::unnamed(), 100),
        insertion: None,
    };
    for (options, wanted) in [
        (
            "kind = \"msd\"\nlongest_lag = 0.0",
            "`longest_lag` is 0; allowed: a finite number greater than 0",
        ),
        (
            "kind = \"msd\"\nfit_from = 3.0\nfit_to = 2.0",
            "`fit_from` is 3; allowed: less than `fit_to`, which is 2",
        ),
        ("kind = \"structure-factor\"\nk_max = 1e9", "`k_max` is 1000000000; allowed: from 0.628"),
        ("kind = \"structure-factor\"\nk_max = 0.1", " σ⁻¹ in this box"),
        (
            "kind = \"shear-viscosity\"\nwindow = 0.5",
            "`window` is 0.5; allowed: at least 32 sampling intervals of 0.04 τ (change `window` or `every`)",
        ),
        ("kind = \"vacf\"\nwindow = 0.01", "`window` is 0.01; allowed: from 2 to "),
        (
            "kind = \"vacf\"\nwindow = 1e300",
            " sampling intervals of 0.04 τ (change `window` or `every`)",
        ),
    ] {
        let options: ObservableOptions = toml::from_str(options).unwrap();
        let Err(error) = build(&options, &context) else {
            panic!("{options:?} was taken");
        };
        assert!(error.to_string().contains(wanted), "wanted `{wanted}` in\n{error}");
    }
}
