//! Reads the tables `[[species]]`, `[mixing]` and `[[pair]]`.

use lennard_core::MOST_SPECIES;
use lennard_core::options::quoted;
use lennard_forcefield::{CombiningOptions, combining_rules};
use lennard_io::is_element_symbol;

use crate::read::Reader;
use crate::section::Section;
use crate::tables::species::{PairKeys, SpeciesKeys};
use crate::{Amount, MixtureTables, Name, PairEntry, SceneError, SpeciesEntry, nearest};

/// Symbols of species that name none and are called like no element.
const USUAL_ELEMENTS: [&str; MOST_SPECIES] = ["Ar", "Kr", "Xe", "Ne", "He", "Rn", "H", "Li"];

impl Reader<'_> {
    /// The species of the scene with what acts between them; `None` where it names none.
    pub fn mixture(&self) -> Result<Option<MixtureTables>, SceneError> {
        let species = self.species()?;
        if species.is_empty() {
            for table in ["mixing", "pair"] {
                if self.source.wrote(table) {
                    return Err(self
                        .refuse(table, "has no species to act on")
                        .found(format!("`{table}` without `[[species]]`"))
                        .allowed("a table `[[species]]` for each species beside it"));
                }
            }
            return Ok(None);
        }
        let rule = self.rule(&species)?;
        let pairs = self.pairs(&species, rule.as_ref())?;
        let mixture = MixtureTables { species, rule, pairs };
        self.all_pairs_are_said(&mixture)?;
        Ok(Some(mixture))
    }

    fn species(&self) -> Result<Vec<SpeciesEntry>, SceneError> {
        let tables = self.list("species")?;
        if tables.len() > MOST_SPECIES {
            return Err(self
                .refuse("species", "is written too often")
                .found(format!("{} times", tables.len()))
                .allowed(format!("at most {MOST_SPECIES} times")));
        }
        let mut rows = Vec::new();
        for (a, table) in tables.into_iter().enumerate() {
            let path = format!("species.{a}");
            let section = Section::new(self.source, &path, "species");
            let mut row: SpeciesKeys = section.read(table)?;
            let name = section.needed(table, "name", row.name.take())?;
            let name = self.name_of_species(&path, name)?;
            if let Some(first) = rows.iter().position(|(n, _)| *n == name) {
                let first = format!("species.{first}.name");
                return Err(self.source.twice(&section.name("name"), &name, &first));
            }
            rows.push((name, row));
        }
        let elements = self.elements(&rows)?;
        let amounts = self.amounts(&rows)?;
        let entries = rows.into_iter().zip(elements).zip(amounts);
        let entries = entries.map(|(((name, row), element), amount)| SpeciesEntry {
            name,
            amount,
            sigma: row.sigma,
            epsilon: row.epsilon,
            mass: row.mass,
            element,
        });
        Ok(entries.collect())
    }

    fn name_of_species(&self, path: &str, name: String) -> Result<Name, SceneError> {
        // Overrides find a species by its name, between dots.
        let finds = |name: &Name| {
            !name.contains('.') && name.starts_with(|c: char| c.is_ascii_alphabetic())
        };
        let refused = || {
            self.refuse(&format!("{path}.name"), "is not allowed")
                .found(format!("{name:?}"))
                .allowed("at most 200 letters, digits, `-` and `_`, beginning with a letter")
        };
        Name::new(&*name).filter(finds).ok_or_else(refused)
    }

    /// The symbol of each species in files: as written, as its name, or one that no other has.
    fn elements(&self, rows: &[(Name, SpeciesKeys)]) -> Result<Vec<String>, SceneError> {
        let mut elements: Vec<Option<String>> = Vec::new();
        for (a, (name, row)) in rows.iter().enumerate() {
            let key = format!("species.{a}.element");
            if let Some(element) = row.element.as_ref().filter(|e| !is_element_symbol(e)) {
                return Err(self
                    .refuse(&key, "is not allowed")
                    .found(format!("{element:?}"))
                    .allowed("an element symbol, or \"X\""));
            }
            let named = is_element_symbol(name).then(|| name.to_string());
            let element = row.element.clone().or(named);
            let twin = elements.iter().position(|e| e.is_some() && *e == element);
            if let (Some(first), Some(element)) = (twin, &element) {
                return Err(self
                    .refuse(&key, "stands for two species")
                    .found(format!("{element:?} for {:?} and for {name:?}", rows[first].0))
                    .allowed("an element for each species: files tell them apart by it"));
            }
            elements.push(element);
        }
        let mut free = USUAL_ELEMENTS
            .into_iter()
            .filter(|usual| elements.iter().all(|e| e.as_deref() != Some(usual)))
            .map(str::to_owned)
            .collect::<Vec<_>>()
            .into_iter();
        let all = elements.iter().map(|e| e.clone().or_else(|| free.next()));
        Ok(all.map(Option::unwrap_or_default).collect())
    }

    /// The amount of each species: all as fractions, all as counts, or all in a configuration file.
    fn amounts(&self, rows: &[(Name, SpeciesKeys)]) -> Result<Vec<Amount>, SceneError> {
        let of_file = self.source.wrote("start.file");
        let by_count = rows.iter().any(|(_, row)| row.count.is_some());
        let mut amounts = Vec::new();
        for (a, (name, row)) in rows.iter().enumerate() {
            let refuse =
                |key: &str, message: &str| self.refuse(&format!("species.{a}.{key}"), message);
            let amount = match (row.fraction, row.count) {
                (Some(_), Some(_)) => {
                    return Err(refuse("count", "and `fraction` are both given")
                        .found("both")
                        .allowed("one of them"));
                }
                (Some(_), None) | (None, Some(_)) if of_file => {
                    let key = if row.count.is_some() { "count" } else { "fraction" };
                    return Err(refuse(key, "does not go with `start.file`")
                        .found(format!("`{key}` of {name:?}"))
                        .allowed("no such key: the file has it"));
                }
                (None, None) if of_file => Amount::OfFile,
                (Some(_), None) if by_count => {
                    return Err(refuse("fraction", "stands beside a `count` of another species")
                        .found(format!("`fraction` of {name:?}"))
                        .allowed("all species by `fraction`, or all by `count`"));
                }
                (Some(fraction), None) => Amount::Fraction(fraction),
                (None, Some(count)) => Amount::Count(count),
                (None, None) if rows.len() == 1 => Amount::Fraction(1.0),
                (None, None) => {
                    let key = if by_count { "count" } else { "fraction" };
                    return Err(refuse(key, "is missing")
                        .found(format!("neither `fraction` nor `count` of {name:?}"))
                        .allowed("`fraction`, a number above 0, or `count`, a whole number"));
                }
            };
            amounts.push(amount);
        }
        self.fractions_are_all(&amounts)?;
        Ok(amounts)
    }

    fn fractions_are_all(&self, amounts: &[Amount]) -> Result<(), SceneError> {
        /// Room for decimals typed by hand, such as 0.333333.
        const CLOSE_ENOUGH: f64 = 1e-5;
        let fractions: Option<Vec<f64>> = amounts
            .iter()
            .map(|amount| match amount {
                Amount::Fraction(x) => Some(*x),
                _ => None,
            })
            .collect();
        let Some(fractions) = fractions else {
            return Ok(());
        };
        let sum: f64 = fractions.iter().sum();
        if fractions.is_empty() || (sum - 1.0).abs() <= CLOSE_ENOUGH {
            return Ok(());
        }
        let each: Vec<String> = fractions.iter().map(ToString::to_string).collect();
        let last = fractions.len() - 1;
        let before = sum - fractions[last];
        let rest = (before < 1.0).then(|| format!("{:.6}", 1.0 - before));
        let rest = rest.map(|rest| format!("fraction = {} here", rest.trim_end_matches('0')));
        Err(self
            .refuse(&format!("species.{last}.fraction"), "leaves a sum other than 1")
            .found(format!("{} = {sum:.6}", each.join(" + ")))
            .allowed("fractions that add up to 1")
            .suggestion(rest))
    }

    fn rule(&self, species: &[SpeciesEntry]) -> Result<Option<CombiningOptions>, SceneError> {
        let names: Vec<&str> = combining_rules().iter().map(|rule| rule.name).collect();
        if !self.source.wrote("mixing") {
            if species.len() < 2 {
                return Ok(None);
            }
            return Err(self
                .refuse("mixing.rule", "is missing: no combining rule is the default")
                .at(self.source.place("species.1").cloned())
                .found(format!("{} species without `[mixing]`", species.len()))
                .allowed(format!("[mixing] with rule = {}", quoted(&names))));
        }
        self.section("mixing").method(self.table("mixing")).map(Some)
    }

    fn pairs(
        &self,
        species: &[SpeciesEntry],
        rule: Option<&CombiningOptions>,
    ) -> Result<Vec<PairEntry>, SceneError> {
        let mut pairs: Vec<PairEntry> = Vec::new();
        for (i, table) in self.list("pair")?.into_iter().enumerate() {
            let path = format!("pair.{i}");
            let section = Section::new(self.source, &path, "pair");
            let row: PairKeys = section.read(table)?;
            let a = section.needed(table, "a", row.a.as_deref())?;
            let b = section.needed(table, "b", row.b.as_deref())?;
            let number = |key: &str, name: &str| {
                species
                    .iter()
                    .position(|s| s.name == name)
                    .ok_or_else(|| self.unknown_species(&section.name(key), name, species))
            };
            let species = [number("a", a)?, number("b", b)?];
            if let Some(first) = pairs.iter().position(|pair| pair.is_of(species)) {
                let first = format!("pair.{first}.a");
                return Err(self.source.twice(&section.name("a"), &format!("{a} and {b}"), &first));
            }
            self.pair_is_sound(&path, &row, [a, b], rule)?;
            pairs.push(PairEntry { species, keys: row });
        }
        Ok(pairs)
    }

    fn unknown_species(&self, key: &str, name: &str, species: &[SpeciesEntry]) -> SceneError {
        let names: Vec<&str> = species.iter().map(|s| s.name.as_str()).collect();
        self.refuse(key, "is the name of no species")
            .found(format!("{name:?}"))
            .allowed(quoted(&names))
            .suggestion(nearest(name, names.iter().copied()))
    }

    /// Refuses what a pair says that the rule or the species say.
    fn pair_is_sound(
        &self,
        path: &str,
        pair: &PairKeys,
        [a, b]: [&str; 2],
        rule: Option<&CombiningOptions>,
    ) -> Result<(), SceneError> {
        let refuse = |key: &str, message: &str| self.refuse(&format!("{path}.{key}"), message);
        let written = [
            ("sigma", pair.sigma),
            ("epsilon", pair.epsilon),
            ("k", pair.k),
            ("l", pair.l),
            ("r_cut", pair.r_cut),
        ];
        let written = || written.into_iter().filter_map(|(key, x)| Some((key, x?)));
        let Some((first, value)) = written().next() else {
            return Err(self
                .refuse(path, "sets nothing")
                .found(format!("{a:?} and {b:?} alone"))
                .allowed("at least one of sigma, epsilon, k, l, r_cut"));
        };
        if a == b && first != "r_cut" {
            return Err(refuse(first, "is for two unlike species")
                .found(format!("{value} for {a:?} and {b:?}"))
                .allowed(
                    "`r_cut` alone; `[[species]]` has sigma and epsilon of its own particles",
                ));
        }
        for (deviation, instead) in [("k", "epsilon"), ("l", "sigma")] {
            let find = |key: &str| written().find(|(k, _)| *k == key);
            let Some((_, x)) = find(deviation) else {
                continue;
            };
            if let Some(rule) = rule.filter(|rule| !rule.deviates()) {
                return Err(refuse(deviation, "does not go with the combining rule")
                    .found(format!("{x} with rule = {:?}", rule.spec().name))
                    .allowed("rule = \"lorentz-berthelot\", or sigma and epsilon of the pair"));
            }
            if let Some((_, other)) = find(instead) {
                return Err(refuse(deviation, &format!("and `{instead}` are both given"))
                    .found(format!("{deviation} = {x} and {instead} = {other}"))
                    .allowed("one of them"));
            }
        }
        Ok(())
    }

    /// Refuses a scene without a rule that leaves out a pair of unlike species.
    fn all_pairs_are_said(&self, mixture: &MixtureTables) -> Result<(), SceneError> {
        let n = mixture.species.len();
        for a in 0..n {
            for b in a + 1..n {
                if mixture.size(a, b).is_some() {
                    continue;
                }
                let [one, other] = [a, b].map(|a| &mixture.species[a].name);
                let entry = mixture.pairs.iter().position(|pair| pair.is_of([a, b]));
                let key = entry.map_or("mixing.rule".to_owned(), |i| format!("pair.{i}"));
                return Err(self
                    .refuse(&key, "leaves a pair of species without σ or ε")
                    .found(format!("no sigma and epsilon of {one:?} with {other:?}"))
                    .allowed("a table `[[pair]]` with both for each pair of unlike species"));
            }
        }
        Ok(())
    }
}
