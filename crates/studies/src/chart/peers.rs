use super::{ChartedPoint, Plan};
use crate::settings::{Slopes, Workbench};
pub(super) fn lammps(
    _b: &Workbench,
    _p: &Plan,
    _s: &Slopes,
    _n: usize,
) -> Result<Vec<ChartedPoint>, String> {
    Err("todo".into())
}
