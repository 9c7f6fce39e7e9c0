//! Silicones as sold. `cad/doc/process.md` gives the sources.

use super::ROOM_C;
use super::cure::Cure;
use super::material::PartMaterial;
use crate::config::parameter::choice;

choice! {
    /// Silicone of the layer.
    SiliconeProduct {
        /// Sylgard 184 (Dow), the silicone of the paper.
        Sylgard184 = "sylgard-184",
        /// Smooth-Sil 950 (Smooth-On).
        SmoothSil950 = "smooth-sil-950",
        /// Smooth-Sil 940 (Smooth-On).
        SmoothSil940 = "smooth-sil-940",
        /// Dragon Skin 30 (Smooth-On).
        DragonSkin30 = "dragon-skin-30",
        /// Elastosil M 4601 (Wacker).
        ElastosilM4601 = "elastosil-m-4601",
        /// A user-defined silicone.
        Other = "other",
    }
}

/// Properties of an addition-cured silicone.
#[derive(Clone, Debug, PartialEq)]
pub struct Silicone {
    /// Name on its package.
    pub name: &'static str,
    /// Base to curing agent by mass; `None` if it is configured.
    pub mix_ratio: Option<f64>,
    /// Density when cured, g/cm³; `None` if it is configured.
    pub density_g_cm3: Option<f64>,
    /// Pot life at room temperature, min.
    pub pot_life_min: f64,
    /// Hardness after cures at two temperatures: °C and Shore A. Equal for a product with one hardness.
    hardness: [[f64; 2]; 2],
    /// Standard deviation of the hardness between castings, Shore A.
    pub hardness_scatter_shore_a: f64,
    /// Temperatures with the duration of a full cure, ascending: °C and h.
    schedule: &'static [[f64; 2]],
    /// Hottest cure in a mould with data, °C.
    pub hottest_in_mould_c: f64,
    /// Hottest cure with data, °C.
    pub hottest_c: f64,
    /// Thermal expansion, 1/K.
    expansion_per_k: f64,
}

const SYLGARD_184: Silicone = Silicone {
    name: "Sylgard 184",
    mix_ratio: None,
    density_g_cm3: None,
    pot_life_min: 90.0,
    hardness: [[25.0, 44.0], [200.0, 54.0]],
    hardness_scatter_shore_a: 1.6,
    schedule: &[[25.0, 48.0], [60.0, 4.0], [100.0, 7.0 / 12.0], [125.0, 1.0 / 3.0], [150.0, 1.0 / 6.0]],
    hottest_in_mould_c: 150.0,
    hottest_c: 200.0,
    expansion_per_k: 340e-6,
};

/// A product with one hardness that cures at room temperature.
const fn at_room(
    name: &'static str,
    mix_ratio: f64,
    density_g_cm3: f64,
    shore_a: f64,
    pot_life_min: f64,
    schedule: &'static [[f64; 2]],
) -> Silicone {
    Silicone {
        name,
        mix_ratio: Some(mix_ratio),
        density_g_cm3: Some(density_g_cm3),
        pot_life_min,
        hardness: [[25.0, shore_a], [30.0, shore_a]],
        hardness_scatter_shore_a: 2.0,
        schedule,
        hottest_in_mould_c: 30.0,
        hottest_c: 30.0,
        expansion_per_k: 300e-6,
    }
}

const SMOOTH_SIL_950: Silicone = at_room("Smooth-Sil 950", 10.0, 1.24, 50.0, 45.0, &[[25.0, 18.0]]);
const SMOOTH_SIL_940: Silicone = at_room("Smooth-Sil 940", 10.0, 1.18, 40.0, 30.0, &[[25.0, 24.0]]);
const DRAGON_SKIN_30: Silicone = at_room("Dragon Skin 30", 1.0, 1.08, 30.0, 45.0, &[[25.0, 16.0]]);
const ELASTOSIL_M_4601: Silicone = at_room("Elastosil M 4601", 9.0, 1.13, 28.0, 90.0, &[[25.0, 12.0]]);

impl SiliconeProduct {
    /// Returns the properties of this product; `None` for a user-defined one.
    pub const fn data(self) -> Option<&'static Silicone> {
        match self {
            Self::Sylgard184 => Some(&SYLGARD_184),
            Self::SmoothSil950 => Some(&SMOOTH_SIL_950),
            Self::SmoothSil940 => Some(&SMOOTH_SIL_940),
            Self::DragonSkin30 => Some(&DRAGON_SKIN_30),
            Self::ElastosilM4601 => Some(&ELASTOSIL_M_4601),
            Self::Other => None,
        }
    }

    /// Returns a product that has this hardness when cured at room temperature, within its scatter.
    pub fn for_hardness(shore_a: f64) -> Option<Self> {
        use crate::config::Choice;
        Self::NAMES.iter().map(|(product, _)| *product).find(|product| {
            product
                .data()
                .is_some_and(|s| (s.hardness_shore_a(ROOM_C) - shore_a).abs() <= s.hardness_scatter_shore_a)
        })
    }
}

impl Silicone {
    /// Returns the Shore A hardness after a cure at this temperature, linear between the two measured ones.
    pub fn hardness_shore_a(&self, temperature_c: f64) -> f64 {
        let [[from_c, soft], [to_c, hard]] = self.hardness;
        let share = ((temperature_c - from_c) / (to_c - from_c)).clamp(0.0, 1.0);
        soft + share * (hard - soft)
    }

    /// Returns the temperature of a post-cure, °C, that gives a layer this hardness after a cure at `from_c`: `from_c` where
    /// no post-cure is needed. `None` if the layer is too hard already, or remains too soft, by more than the scatter.
    pub fn cure_for(&self, shore_a: f64, from_c: f64) -> Option<f64> {
        let [[low_c, soft], [high_c, hard]] = self.hardness;
        let now = self.hardness_shore_a(from_c);
        if (shore_a - now).abs() <= 0.5 * self.hardness_scatter_shore_a || soft == hard || shore_a < now {
            return ((shore_a - now).abs() <= self.hardness_scatter_shore_a).then_some(from_c);
        }
        if shore_a > hard {
            return (shore_a - hard <= self.hardness_scatter_shore_a).then_some(high_c);
        }
        Some(low_c + (high_c - low_c) * (shore_a - soft) / (hard - soft))
    }

    /// Returns the full cure at this temperature. Durations between those of the schedule follow Arrhenius: their logarithm
    /// is linear in the inverse of the absolute temperature. They are rounded up, to 5 min or half an hour.
    pub fn cure_at(&self, temperature_c: f64) -> Cure {
        let above = self.schedule.iter().position(|[t, _]| *t >= temperature_c);
        let last = self.schedule.len() - 1;
        let hours = match above {
            Some(0) => self.schedule[0][1],
            None => self.schedule[last][1],
            Some(i) => {
                let ([t0, h0], [t1, h1]) = (self.schedule[i - 1], self.schedule[i]);
                let inverse = |t: f64| 1.0 / (t + 273.15);
                let share = (inverse(temperature_c) - inverse(t0)) / (inverse(t1) - inverse(t0));
                libm::exp(libm::log(h0) + share * (libm::log(h1) - libm::log(h0)))
            }
        };
        let step = if hours < 1.0 { 1.0 / 12.0 } else { 0.5 };
        Cure { temperature_c, hours: (hours / step - 1e-9).ceil() * step }
    }

    /// Returns the linear shrinkage of a layer, per cent of the cavity, after a cure at this temperature in a mould of
    /// `material`: silicone sets at that temperature, and contracts more than the mould when both cool.
    pub fn shrinkage_pct(&self, temperature_c: f64, material: &PartMaterial) -> f64 {
        100.0 * (self.expansion_per_k - material.expansion_per_k) * (temperature_c - ROOM_C).max(0.0)
    }

    /// Returns the temperature, °C, of the cure after which a layer shrinks by this much: the inverse of
    /// [`Silicone::shrinkage_pct`].
    pub fn temperature_of_shrinkage_c(&self, shrinkage_pct: f64, material: &PartMaterial) -> f64 {
        ROOM_C + shrinkage_pct / (100.0 * (self.expansion_per_k - material.expansion_per_k))
    }
}
