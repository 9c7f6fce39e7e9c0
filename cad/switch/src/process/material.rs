//! Materials of printed parts. `cad/doc/process.md` gives the sources.

use crate::config::parameter::choice;

choice! {
    /// Material of the printed parts.
    Material {
        /// Acrylonitrile butadiene styrene, the material of the paper.
        Abs = "abs",
        /// Glycol-modified polyethylene terephthalate.
        Petg = "petg",
        /// Polylactic acid.
        Pla = "pla",
        /// Photopolymer of a stereolithography or DLP printer.
        Resin = "resin",
    }
}

/// Properties of a material.
#[derive(Clone, Debug, PartialEq)]
pub struct PartMaterial {
    /// Name in texts.
    pub name: &'static str,
    /// Hottest cure that a mould of this material keeps its shape in, °C.
    pub hottest_cure_c: f64,
    /// Thermal expansion, 1/K.
    pub expansion_per_k: f64,
    /// Shrinkage to compensate in the slicer, per cent.
    pub shrinkage_pct: f64,
    /// Density, g/cm³; `None` if it is configured.
    pub density_g_cm3: Option<f64>,
    /// Name of the filament for a slicer; `None` for a material that is not extruded.
    pub filament: Option<&'static str>,
    /// What joins two parts of it.
    pub glue: &'static str,
    /// Preparation without which addition-cured silicone stays tacky on the material.
    pub inhibition: Option<&'static str>,
}

const ABS: PartMaterial = PartMaterial {
    name: "ABS",
    hottest_cure_c: 70.0,
    expansion_per_k: 90e-6,
    shrinkage_pct: 0.7,
    density_g_cm3: None,
    filament: Some("ABS"),
    glue: "ABS cement or epoxy",
    inhibition: None,
};
const PETG: PartMaterial = PartMaterial {
    name: "PETG",
    hottest_cure_c: 55.0,
    expansion_per_k: 60e-6,
    shrinkage_pct: 0.3,
    density_g_cm3: Some(1.27),
    filament: Some("PET"),
    glue: "epoxy",
    inhibition: None,
};
const PLA: PartMaterial = PartMaterial {
    name: "PLA",
    hottest_cure_c: 45.0,
    expansion_per_k: 70e-6,
    shrinkage_pct: 0.2,
    density_g_cm3: Some(1.24),
    filament: Some("PLA"),
    glue: "epoxy",
    inhibition: None,
};
const RESIN: PartMaterial = PartMaterial {
    name: "resin",
    hottest_cure_c: 50.0,
    expansion_per_k: 90e-6,
    shrinkage_pct: 0.0,
    density_g_cm3: Some(1.15),
    filament: None,
    glue: "epoxy",
    inhibition: Some("wash the mould, cure it under UV light, and bake it for 2 h at 50 C"),
};

impl Material {
    /// Returns the properties of this material.
    pub const fn data(self) -> &'static PartMaterial {
        match self {
            Self::Abs => &ABS,
            Self::Petg => &PETG,
            Self::Pla => &PLA,
            Self::Resin => &RESIN,
        }
    }
}
