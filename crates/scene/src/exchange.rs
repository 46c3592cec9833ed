//! The exchange of a stage: how it is read, and what it needs.

use lennard_core::options::Options;
use lennard_integrators::{ExchangeOptions, Exchanged};
use toml::Value;

use crate::error::SceneError;
use crate::read::Reader;
use crate::section::Section;

impl Reader<'_> {
    /// The exchange of a stage: "none", a name, or a table.
    pub fn exchange(
        &self,
        stage: &str,
        written: &Value,
    ) -> Result<Option<ExchangeOptions>, SceneError> {
        let path = format!("{stage}.exchange");
        let section = Section::new(self.source, &path, "stage.exchange");
        let Some(named) = self.part(stage, "exchange", &Exchanged::names(), written)? else {
            return Ok(None);
        };
        let options: ExchangeOptions = section.read(&named)?;
        options.check().map_err(|e| section.impossible(e.key, &e.found, &e.allowed))?;
        if !options.slabs.is_multiple_of(2) {
            return Err(section.impossible("slabs", &options.slabs.to_string(), "an even number"));
        }
        Ok(Some(options))
    }
}
