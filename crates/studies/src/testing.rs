//! Numbers of made-up runs, and workbenches of small fluids, for tests.

use lennard_io::AverageRecord;
use lennard_observables::{Estimate, Standing};

use crate::lab::Workbench;
use crate::settings::Settings;
use crate::sweep::{Setting, SettingValue};

/// A sound mean with its error.
pub(crate) fn average(mean: f64, standard_error: f64) -> AverageRecord {
    AverageRecord {
        estimate: Estimate { freedom: 64.0, ..Estimate::new(mean, standard_error, 500.0) },
        unit: "ε".into(),
        standing: Standing::Sound,
        reason: String::new(),
    }
}

/// A number that a study chose for a key.
pub(crate) fn chosen(key: &str, number: f64) -> Setting {
    Setting { key: key.to_owned(), value: SettingValue::Number(number) }
}

/// A workbench of the small liquid with changes, and the settings of its scene.
pub(crate) fn bench(extra: &[(&str, &str)]) -> (Workbench, Settings) {
    let bench = Workbench::new(&crate::settings::tests::scene(extra)).unwrap();
    let settings = Settings::of(bench.scene());
    (bench, settings)
}
