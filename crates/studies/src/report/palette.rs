//! Colours, symbols and dashes that stay apart for colour-blind readers and in grey print.

/// The palette of Okabe and Ito ("Color Universal Design", 2008) without its yellow, which is too light
/// for lines on white; black stands last.
pub const COLORS: [(u8, u8, u8); 7] = [
    (0, 114, 178),
    (213, 94, 0),
    (0, 158, 115),
    (204, 121, 167),
    (86, 180, 233),
    (230, 159, 0),
    (30, 30, 30),
];

/// How a line is broken, so that lines differ without colour too.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Dash {
    /// Unbroken.
    #[default]
    Solid,
    /// Long strokes.
    Dashed,
    /// Short strokes.
    Dotted,
}

/// The mark of a measured point.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Symbol {
    /// A filled circle.
    #[default]
    Disc,
    /// An open circle.
    Ring,
    /// A filled square.
    Square,
    /// An open square.
    Frame,
    /// A filled triangle, upright.
    Triangle,
    /// A filled triangle on its tip.
    Wedge,
    /// A filled diamond.
    Diamond,
    /// An upright cross.
    Plus,
    /// An open triangle, upright.
    OpenTriangle,
    /// An open triangle on its tip.
    OpenWedge,
    /// An open diamond.
    OpenDiamond,
}

impl Symbol {
    /// The open form of a filled symbol.
    #[must_use]
    pub fn open(self) -> Self {
        match self {
            Self::Disc => Self::Ring,
            Self::Square => Self::Frame,
            Self::Triangle => Self::OpenTriangle,
            Self::Wedge => Self::OpenWedge,
            Self::Diamond => Self::OpenDiamond,
            open => open,
        }
    }

    /// The symbols in the order in which series take them.
    pub const ALL: [Self; 8] = [
        Self::Disc,
        Self::Frame,
        Self::Triangle,
        Self::Diamond,
        Self::Ring,
        Self::Wedge,
        Self::Plus,
        Self::Square,
    ];

    /// The symbol of the `index`-th series, going round.
    pub(crate) fn cycle(index: usize) -> Self {
        Self::ALL[index % Self::ALL.len()]
    }
}

impl Dash {
    /// The dash of the `index`-th series: a new one each time the colours have gone round.
    pub(crate) fn cycle(index: usize) -> Self {
        [Self::Solid, Self::Dashed, Self::Dotted][(index / COLORS.len()) % 3]
    }
}
