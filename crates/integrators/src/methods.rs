//! What each list of methods has: one enum, and everything that is made from it.

/// Makes the enum of a list from lines `Variant: module,`. Each variant holds the `Options` of its module, which implement the trait of
/// the list, and a constant of the module declares the method. The enum serves as the trait object of the chosen method.
macro_rules! list_of_methods {
    (
        $(#[$about:meta])*
        pub enum $list:ident: $trait:ident, declared by $constant:ident: $spec:ident {
            $($(#[$doc:meta])* $variant:ident: $module:ident,)*
        }
    ) => {
        #[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
        $(#[$about])*
        pub enum $list {
            $($(#[$doc])* $variant($module::Options),)*
        }

        impl std::ops::Deref for $list {
            type Target = dyn $trait;

            fn deref(&self) -> &Self::Target {
                match self {
                    $(Self::$variant(options) => options,)*
                }
            }
        }

        impl $list {
            /// What each method declares about itself, in the order of the list.
            pub const SPECS: &'static [$spec] = &[$($module::$constant,)*];

            /// What the chosen method declares about itself, at its default options.
            #[must_use]
            pub fn spec(&self) -> &'static $spec {
                match self {
                    $(Self::$variant(_) => &$module::$constant,)*
                }
            }

            /// The name in scene files.
            #[must_use]
            pub fn name(&self) -> &'static str {
                self.spec().name
            }

            /// Every method with its default options, in the order of the list.
            #[must_use]
            pub fn all() -> Vec<Self> {
                vec![$(Self::$variant(Default::default()),)*]
            }

            /// The scene keys of every method, by its name.
            #[must_use]
            pub fn keys() -> Vec<(&'static str, lennard_core::options::Keys)> {
                use lennard_core::options::Options;
                vec![$(($module::$constant.name, <$module::Options as Options>::KEYS),)*]
            }

            /// Whether every option has a possible value, and all of them go together.
            ///
            /// # Errors
            /// [`lennard_core::options::OptionError`], which names the key, what was found and what is allowed.
            pub fn check(&self) -> Result<(), lennard_core::options::OptionError> {
                use lennard_core::options::Options;
                match self {
                    $(Self::$variant(options) => Options::check(options)?,)*
                }
                self.check_together()
            }
        }
    };
}
