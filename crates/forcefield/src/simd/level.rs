//! Instruction sets, and tokens that prove that this processor has one.

lennard_core::choices! {
    /// Which instruction set the pair loop uses.
    pub enum Isa {
        /// The widest that this processor has.
        #[default]
        Auto = "auto",
        /// AVX-512 (F, BW, DQ and VL).
        Avx512 = "avx512",
        /// AVX2 with FMA.
        Avx2 = "avx2",
        /// No particular instruction set.
        Portable = "portable",
    }
}

/// Proof that this processor has AVX-512 F, BW, DQ, VL, and everything of [`Avx2`].
///
/// The private field makes [`Avx512::detect`] the only source of values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Avx512(());

/// Proof that this processor has AVX2, FMA, BMI1, BMI2 and POPCNT.
///
/// The private field makes [`Avx2::detect`] and [`Avx512::avx2`] the only sources of values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Avx2(());

impl Avx512 {
    /// The token, where this processor has the instruction set.
    pub fn detect() -> Option<Self> {
        #[cfg(target_arch = "x86_64")]
        if Avx2::detect().is_some()
            && is_x86_feature_detected!("avx512f")
            && is_x86_feature_detected!("avx512bw")
            && is_x86_feature_detected!("avx512dq")
            && is_x86_feature_detected!("avx512vl")
        {
            return Some(Self(()));
        }
        None
    }

    /// Runs a task, of which everything that is inlined is compiled for the instruction set.
    #[inline(always)]
    pub fn run<R>(self, task: impl FnOnce() -> R) -> R {
        #[cfg_attr(
            target_arch = "x86_64",
            target_feature(
                enable = "avx512f,avx512bw,avx512dq,avx512vl,avx2,fma,bmi1,bmi2,popcnt"
            )
        )]
        fn compiled<R>(task: impl FnOnce() -> R) -> R {
            task()
        }
        // SAFETY: the token proves the instruction set.
        unsafe { compiled(task) }
    }

    /// The token of the instruction set that this one includes.
    #[inline(always)]
    pub fn avx2(self) -> Avx2 {
        Avx2(())
    }
}

impl Avx2 {
    /// As [`Avx512::run`].
    #[inline(always)]
    pub fn run<R>(self, task: impl FnOnce() -> R) -> R {
        #[cfg_attr(target_arch = "x86_64", target_feature(enable = "avx2,fma,bmi1,bmi2,popcnt"))]
        fn compiled<R>(task: impl FnOnce() -> R) -> R {
            task()
        }
        // SAFETY: the token proves the instruction set.
        unsafe { compiled(task) }
    }

    /// The token, where this processor has the instruction set.
    pub fn detect() -> Option<Self> {
        #[cfg(target_arch = "x86_64")]
        if is_x86_feature_detected!("avx2")
            && is_x86_feature_detected!("fma")
            && is_x86_feature_detected!("bmi1")
            && is_x86_feature_detected!("bmi2")
            && is_x86_feature_detected!("popcnt")
        {
            return Some(Self(()));
        }
        None
    }
}

/// The instruction set of a kernel, after every choice has been made.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Level {
    /// AVX-512 with FMA.
    Avx512(Avx512),
    /// AVX2 with FMA.
    Avx2(Avx2),
    /// No particular instruction set.
    Portable,
}

impl Level {
    /// The levels of this processor, widest first.
    pub fn available() -> Vec<Self> {
        let avx512 = Avx512::detect().map(Self::Avx512);
        let avx2 = Avx2::detect().map(Self::Avx2);
        [avx512, avx2, Some(Self::Portable)].into_iter().flatten().collect()
    }

    /// The level that an option asks for; `None` where this processor lacks it.
    pub fn choose(isa: Isa) -> Option<Self> {
        match isa {
            Isa::Auto => Self::available().first().copied(),
            Isa::Avx512 => Avx512::detect().map(Self::Avx512),
            Isa::Avx2 => Avx2::detect().map(Self::Avx2),
            Isa::Portable => Some(Self::Portable),
        }
    }

    /// The name in run records and options.
    pub fn name(self) -> &'static str {
        match self {
            Self::Avx512(_) => "avx512",
            Self::Avx2(_) => "avx2",
            Self::Portable => "portable",
        }
    }

    /// Number of doubles in a register: entries of rows are padded to a multiple of it.
    pub fn lanes(self) -> usize {
        match self {
            Self::Avx512(_) => 8,
            Self::Avx2(_) => 4,
            Self::Portable => 2,
        }
    }

    /// The AVX2 token, where the level includes AVX2.
    #[inline(always)]
    pub fn avx2(self) -> Option<Avx2> {
        match self {
            Self::Avx512(isa) => Some(isa.avx2()),
            Self::Avx2(isa) => Some(isa),
            Self::Portable => None,
        }
    }
}
