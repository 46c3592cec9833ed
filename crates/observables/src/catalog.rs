//! Everything that follows from the list of observables in `lib.rs`.

/// Declares the observables: a line makes the module of an observable, exports its options, and adds it to the list.
/// An observable whose module stands above has no `in`.
macro_rules! catalog {
    ($($(#[$doc:meta])* $variant:ident $(in $file:ident)? => $options:ident,)*) => {
        $($(mod $file; pub use $file::$options;)?)*

        /// The options of one observable, as a scene's `[[observable]]` table gives them (`kind` and
        /// the keys of that kind; `every` belongs to the scene and is not among them).
        #[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
        #[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
        pub enum ObservableOptions {
            $($(#[$doc])* $variant($options),)*
        }

        impl ObservableOptions {
            /// What the observable declares about itself.
            #[must_use]
            pub fn spec(&self) -> &'static ObservableSpec {
                match self {
                    $(Self::$variant(_) => <$options as Recipe>::SPEC,)*
                }
            }

            /// The shortest measured part of a run that gives the observable an error, τ.
            #[must_use]
            pub fn least_length(&self) -> f64 {
                match self {
                    $(Self::$variant(o) => o.least_length(),)*
                }
            }

            /// The scene keys of every observable, by its name.
            #[must_use]
            pub fn keys() -> Vec<(&'static str, Keys)> {
                vec![$((<$options as Recipe>::SPEC.name, <$options as Options>::KEYS),)*]
            }

            /// Every observable with its default options, in the order of the list.
            #[must_use]
            pub fn all() -> Vec<Self> {
                vec![$(Self::$variant(<$options>::default()),)*]
            }
        }

        /// Builds an observable from its options.
        ///
        /// # Errors
        /// [`ObservableError`] where an option is impossible in this context.
        pub fn build(
            options: &ObservableOptions,
            context: &BuildContext,
        ) -> Result<Box<dyn Observable>, ObservableError> {
            match options {
                $(ObservableOptions::$variant(o) => o.build(context),)*
            }
        }

        impl ObservableOptions {
            /// The observable's name in scene files.
            #[must_use]
            pub fn name(&self) -> &'static str {
                self.spec().name
            }
        }

        /// All observables, in the order of the list.
        #[must_use]
        pub fn observables() -> &'static [ObservableSpec] {
            const SPECS: &[ObservableSpec] = &[$(*<$options as Recipe>::SPEC,)*];
            SPECS
        }
    };
}
