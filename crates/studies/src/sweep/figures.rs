//! The figures of a sweep.

use crate::report::Picture;

use super::{Sweep, SweepRecord, arrhenius, coexistence, isotherms, melting, properties};

/// What is drawn of a sweep.
pub(super) struct Pictures {
    /// All points together, each also a file of its own.
    pub together: Vec<Picture>,
    /// One property each, on the page alone.
    pub properties: Vec<Picture>,
}

impl Pictures {
    /// The names of the files with their pictures.
    pub fn files(&self) -> impl Iterator<Item = (String, &Picture)> {
        let named = |picture| (format!("{}.svg", Picture::name(picture)), picture);
        self.together.iter().map(named)
    }
}

/// Every figure that the sweep has points for.
pub(super) fn all(sweep: &Sweep, record: &SweepRecord) -> Pictures {
    let mut together: Vec<Picture> = isotherms::picture(sweep, record).into_iter().collect();
    together.extend(coexistence::pictures(sweep, record));
    together.extend(arrhenius::picture(record));
    together.extend(melting::picture(&record.points, &record.melting));
    let drawn: Vec<&str> = together.iter().map(Picture::name).collect();
    let properties = properties::pictures(sweep, record, &drawn);
    Pictures { together, properties }
}
