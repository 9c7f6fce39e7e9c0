//! Pins and ropes as sold. `cad/doc/process.md` gives the sources.

use crate::config::parameter::choice;

choice! {
    /// Steel of the pins, as bought.
    PinStock {
        /// Polished, tin-plated steel, as in the paper.
        TinPlated = "tin-plated",
        /// Music wire (ASTM A228, EN 10270-1), cut to length.
        MusicWire = "music-wire",
        /// Hardened dowel pins (ISO 8734).
        Dowel = "dowel",
    }
}

choice! {
    /// Coating of the tendon, as bought.
    Coating {
        /// Polyamide 12, as in the paper.
        Polyamide = "polyamide",
        /// Polytetrafluoroethylene.
        Ptfe = "ptfe",
        /// Bare rope.
        Bare = "none",
    }
}

/// Diameters of music wire, mm, that hobby and spring suppliers keep; 0.94 is 0.037 in.
const WIRE_MM: [f64; 14] = [0.5, 0.6, 0.7, 0.8, 0.9, 0.94, 1.0, 1.2, 1.4, 1.5, 1.6, 2.0, 2.5, 3.0];
/// Nominal diameters of ISO 8734, mm.
const DOWEL_MM: [f64; 7] = [1.0, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0];
/// Largest difference between a pin and the diameter under which it is sold, mm.
const SAME_MM: f64 = 0.005;

impl PinStock {
    /// Returns the name in a shopping list.
    pub const fn title(self) -> &'static str {
        match self {
            Self::TinPlated => "polished, tin-plated steel pins",
            Self::MusicWire => "music wire (EN 10270-1), cut and deburred",
            Self::Dowel => "hardened dowel pins (ISO 8734 m6)",
        }
    }

    /// Returns the material in a parts list.
    pub const fn material(self) -> &'static str {
        match self {
            Self::TinPlated => "Steel, polished",
            Self::MusicWire => "Spring steel",
            Self::Dowel => "Steel, hardened",
        }
    }

    /// Returns the diameters on sale, mm; empty where any diameter is.
    pub const fn diameters_mm(self) -> &'static [f64] {
        match self {
            Self::TinPlated => &[],
            Self::MusicWire => &WIRE_MM,
            Self::Dowel => &DOWEL_MM,
        }
    }
}

/// Whether pins of this diameter are sold.
pub fn pin_is_sold(stock: PinStock, diameter_mm: f64) -> bool {
    let all = stock.diameters_mm();
    all.is_empty() || all.iter().any(|d| (d - diameter_mm).abs() <= SAME_MM)
}

/// Returns the nearest diameter on sale of at most `most_mm`; `None` if none is.
pub fn nearest_pin_mm(stock: PinStock, diameter_mm: f64, most_mm: f64) -> Option<f64> {
    let distance = |d: &f64| (d - diameter_mm).abs();
    let on_sale = stock.diameters_mm().iter().copied().filter(|d| *d <= most_mm);
    on_sale.min_by(|a, b| distance(a).total_cmp(&distance(b)))
}

impl Coating {
    /// Returns the name in a shopping list.
    pub const fn title(self) -> &'static str {
        match self {
            Self::Polyamide => "polyamide-12 coating",
            Self::Ptfe => "PTFE coating",
            Self::Bare => "no coating",
        }
    }

    /// Returns the material in a parts list, with that of the rope.
    pub const fn with_rope(self) -> &'static str {
        match self {
            Self::Polyamide => "Steel, polyamide 12",
            Self::Ptfe => "Steel, PTFE",
            Self::Bare => "Steel",
        }
    }
}
