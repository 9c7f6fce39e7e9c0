//! Scatter of the threshold from the tolerances of a switch: to first order and by simulated switches, and the tolerances
//! for a wanted scatter.
//!
//! ```
//! use pinswitch_switch::{config::{Configuration, assign}, design::Design, tolerances::Analysis};
//!
//! let mut configuration = Configuration::default();
//! assign(&mut configuration, "layout.pins=[5, 8, 11]")?;
//! let analysis = Analysis::new(&Design::new(configuration)?, &[])?;
//! let layer = analysis.contributions.iter().find(|c| c.link.dimension.as_str() == "layer_thickness").unwrap();
//! assert!(layer.slopes[0] < 0.0, "a thicker layer is softer, and switches at a lower load");
//! let simulated = analysis.simulate(&analysis.process(), 200, 1)?;
//! assert!((simulated.standard_deviation_n / analysis.linear.standard_deviation_n - 1.0).abs() < 0.3);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod allocation;
mod chain;
mod simulation;

use pinswitch_diagnostic::{Diagnostic, Location, codes};
use pinswitch_friction::physics::{Constants, Dimension, MadeDimensions, PhysicsSwitch};
use pinswitch_friction::{Contact, Substrate};
use schemars::JsonSchema;
use serde::Serialize;

use crate::design::Design;
use allocation::{allocate, standard_deviation_n};
pub use chain::{
    ChainDimension, DEVIATIONS_PER_TOLERANCE, Link, SLOT_EXCESS_MM, SourcedTolerance, chain, link,
};
use chain::{Deviations, made};
pub use simulation::Simulated;

/// Half width of the 95 % interval of a normal distribution, in standard deviations.
pub const NORMAL_95: f64 = 1.96;
/// Factor by which the range of loads is wider for made switches than for the design, as in `design`.
const WIDER_RANGE: f64 = 1.5;
/// Step of the derivatives of made dimensions with respect to a deviation, in its unit.
const STEP: f64 = 1e-6;

/// Contribution of a dimension to the variance of the threshold.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Contribution {
    /// The dimension with its tolerances.
    #[serde(flatten)]
    pub link: Link,
    /// Derivative of the threshold with respect to each occurrence, N per unit.
    pub slopes: Vec<f64>,
    /// Share of the variance of the threshold with the tolerances of the process, to first order.
    pub share: f64,
}

/// Scatter of the threshold to first order.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Linear {
    /// Standard deviation, N.
    pub standard_deviation_n: f64,
    /// 2.5 % and 97.5 % quantiles, N.
    pub interval_n: [f64; 2],
}

/// Tolerances for a wanted scatter.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Allocation {
    /// Wanted half width of the 95 % interval, N.
    pub wanted_n: f64,
    /// Half width of the 95 % interval that the best processes reach, N.
    pub best_n: f64,
    /// Tolerance ± of each dimension, in the order of the contributions; `None` if the best processes do not reach the
    /// wanted scatter.
    pub tolerances: Option<Vec<f64>>,
    /// Half width of the 95 % interval with these tolerances, N; that of the best processes without them.
    pub reached_n: f64,
}

/// Scatter of a design's threshold.
#[derive(Clone, Debug)]
pub struct Analysis {
    design: Design,
    switch: PhysicsSwitch,
    range_n: (f64, f64),
    /// Threshold of the nominal switch, N.
    pub threshold_n: f64,
    /// Contributions of the dimensions.
    pub contributions: Vec<Contribution>,
    /// Scatter with the tolerances of the process, to first order.
    pub linear: Linear,
}

/// Returns the threshold of a contact by the physics law in N, if it is among loads of `range_n`.
///
/// # Errors
/// A [`Diagnostic`] if the physics does not converge.
fn threshold_n(switch: &PhysicsSwitch, range_n: (f64, f64)) -> Result<Option<f64>, Diagnostic> {
    switch.threshold_n(range_n).map_err(Diagnostic::from)
}

impl Analysis {
    /// Analyses a design, with measured tolerances instead of those of the process for some dimensions.
    ///
    /// # Errors
    /// A [`Diagnostic`] if the design does not switch within its loads, or if the physics does not converge.
    pub fn new(design: &Design, measured: &[(ChainDimension, f64)]) -> Result<Self, Diagnostic> {
        let contact = design.contact();
        let f = &design.configuration().friction;
        let range_n = (f.load_min_n.max(f64::MIN_POSITIVE.sqrt()), f.load_max_n);
        let switch = PhysicsSwitch::new(contact, Constants::published());
        let threshold_n = threshold_n(&switch, range_n)?.ok_or_else(|| does_not_switch(contact, range_n))?;
        let mut links = chain(design);
        for (dimension, tolerance) in measured {
            for link in links.iter_mut().filter(|link| link.dimension == *dimension) {
                link.process = SourcedTolerance { plus_minus: *tolerance, source: "measured" };
                link.best.plus_minus = link.best.plus_minus.min(*tolerance);
                link.drawing = link.drawing.min(*tolerance);
            }
        }
        let slopes = slopes(design, &switch, &links, threshold_n)?;
        let squares: Vec<f64> = slopes.iter().map(|all| square(all)).collect();
        let process: Vec<f64> = links.iter().map(|link| link.process.plus_minus).collect();
        let standard_deviation_n = standard_deviation_n(&squares, &process);
        let contributions = links.into_iter().zip(slopes).map(|(link, slopes)| {
            let own = square(&slopes).sqrt() * link.process.plus_minus / DEVIATIONS_PER_TOLERANCE;
            let share = if standard_deviation_n > 0.0 { (own / standard_deviation_n).powi(2) } else { 0.0 };
            Contribution { link, slopes, share }
        });
        let half_n = NORMAL_95 * standard_deviation_n;
        Ok(Self {
            design: design.clone(),
            switch,
            range_n: (range_n.0 / WIDER_RANGE, range_n.1 * WIDER_RANGE),
            threshold_n,
            contributions: contributions.collect(),
            linear: Linear { standard_deviation_n, interval_n: [threshold_n - half_n, threshold_n + half_n] },
        })
    }

    /// Returns the tolerances of the process, in the order of the contributions.
    pub fn process(&self) -> Vec<f64> {
        self.contributions.iter().map(|c| c.link.process.plus_minus).collect()
    }

    /// Returns the standard deviation of the threshold with these tolerances in N, to first order.
    pub fn standard_deviation_n(&self, tolerances: &[f64]) -> f64 {
        standard_deviation_n(&self.squares(), tolerances)
    }

    fn squares(&self) -> Vec<f64> {
        self.contributions.iter().map(|c| square(&c.slopes)).collect()
    }

    fn links(&self) -> Vec<Link> {
        self.contributions.iter().map(|c| c.link).collect()
    }

    /// Allots the cheapest tolerances with which 95 % of the switches are within `wanted_n` newtons of the nominal
    /// threshold.
    pub fn allocate(&self, wanted_n: f64) -> Allocation {
        let (links, squares) = (self.links(), self.squares());
        let best: Vec<f64> = links.iter().map(|link| link.best.plus_minus).collect();
        let best_n = NORMAL_95 * standard_deviation_n(&squares, &best);
        let tolerances = allocate(&links, &squares, wanted_n / NORMAL_95);
        let reached_n = tolerances.as_ref().map_or(best_n, |t| NORMAL_95 * standard_deviation_n(&squares, t));
        Allocation { wanted_n, best_n, tolerances, reached_n }
    }

    /// Simulates switches with these tolerances, in the order of the contributions.
    ///
    /// # Errors
    /// A [`Diagnostic`] if fewer than two of the switches have a threshold.
    pub fn simulate(&self, tolerances: &[f64], draws: usize, seed: u64) -> Result<Simulated, Diagnostic> {
        let sd: Vec<f64> = tolerances.iter().map(|t| t / DEVIATIONS_PER_TOLERANCE).collect();
        simulation::simulate(draws, seed, |random| {
            let mut deviations = Deviations::zero(&self.links());
            for (i, sd) in sd.iter().enumerate() {
                deviations.of_mut(i).iter_mut().for_each(|by| *by = sd * random());
            }
            self.made_threshold_n(&made(&self.design, &deviations))
        })
    }

    /// Returns the threshold of a made switch; `None` without one.
    fn made_threshold_n(&self, dimensions: &MadeDimensions) -> Option<f64> {
        let switch = self.switch.made(dimensions).ok()?;
        switch.threshold_near_n(self.threshold_n, self.range_n).ok().flatten()
    }
}

fn square(slopes: &[f64]) -> f64 {
    slopes.iter().map(|slope| slope * slope).sum()
}

/// Computes the derivative of the threshold with respect to each occurrence of each link, N per unit.
fn slopes(
    design: &Design,
    switch: &PhysicsSwitch,
    links: &[Link],
    threshold_n: f64,
) -> Result<Vec<Vec<f64>>, Diagnostic> {
    let pins = design.contact().all_pins().count();
    let mut dimensions = vec![
        Dimension::Wrap,
        Dimension::ContactRadius,
        Dimension::TendonRadius,
        Dimension::PinDiameter,
        Dimension::GrooveRadius,
        Dimension::Layer,
        Dimension::LayerWidth,
        Dimension::Modulus,
    ];
    dimensions.extend((0..pins).map(Dimension::PinAngle));
    dimensions.extend((0..pins).map(Dimension::PinHeight));
    let of_dimensions = switch.threshold_slopes(threshold_n, &dimensions).map_err(Diagnostic::from)?;
    let slope = |link: usize, occurrence: usize| {
        let moved = |by: f64| {
            let mut deviations = Deviations::zero(links);
            deviations.of_mut(link)[occurrence] = by;
            made(design, &deviations)
        };
        let (less, more) = (moved(-STEP), moved(STEP));
        let by = |dimension: &Dimension| (more.get(*dimension) - less.get(*dimension)) / (2.0 * STEP);
        dimensions.iter().zip(&of_dimensions).map(|(dimension, slope)| slope * by(dimension)).sum()
    };
    Ok(links.iter().enumerate().map(|(i, link)| (0..link.count).map(|k| slope(i, k)).collect()).collect())
}

/// Returns the error of a design whose silicone does not reach half of the friction within its loads.
fn does_not_switch(contact: &Contact, (from, to): (f64, f64)) -> Diagnostic {
    if contact.substrate() != Substrate::Silicone {
        return Diagnostic::new(
            codes::SWITCH_WITHOUT_THRESHOLD,
            "a rigid proxy has no silicone, and does not switch",
        )
        .with_location(Location::field("layout.substrate", contact.substrate().as_str()))
        .with_help("set layout.substrate to silicone");
    }
    if contact.pins().count() == 0 {
        return Diagnostic::new(
            codes::SWITCH_WITHOUT_THRESHOLD,
            "without pins in the wrap, the silicone carries all friction at any load",
        )
        .with_location(Location::field("layout.pins", "[]"))
        .with_help("set layout.pins to grooves within the wrap");
    }
    Diagnostic::new(
        codes::SWITCH_WITHOUT_THRESHOLD,
        format!("the silicone does not reach half of the friction from {from:.2} to {to:.2} N"),
    )
    .with_location(Location::field("friction.load_max_n", to.to_string()))
    .with_help("raise friction.load_max_n, or use fewer pins")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::{Configuration, assign};

    fn three_double() -> Analysis {
        let mut configuration = Configuration::default();
        assign(&mut configuration, "layout.pins=[5, 8, 11]").unwrap();
        Analysis::new(&Design::new(configuration).unwrap(), &[]).unwrap()
    }

    /// Half a tolerance of each occurrence alone moves the threshold as its slope predicts.
    #[test]
    fn slopes_predict_made_thresholds() {
        let analysis = three_double();
        let links = analysis.links();
        for (i, contribution) in analysis.contributions.iter().enumerate() {
            let by = 0.05 * contribution.link.process.plus_minus;
            for (k, slope) in contribution.slopes.iter().enumerate() {
                let moved = |by: f64| {
                    let mut deviations = Deviations::zero(&links);
                    deviations.of_mut(i)[k] = by;
                    analysis.made_threshold_n(&made(&analysis.design, &deviations)).unwrap()
                };
                let difference = (moved(by) - moved(-by)) / (2.0 * by);
                let name = contribution.link.dimension.as_str();
                assert!(
                    (slope - difference).abs() < 0.05 * difference.abs() + 0.02,
                    "{name} {k}: {slope} for {difference}"
                );
            }
        }
        let shares: f64 = analysis.contributions.iter().map(|c| c.share).sum();
        assert!((shares - 1.0).abs() < 1e-9);
    }

    /// With a tenth of the tolerances the threshold is linear in every deviation.
    #[test]
    fn simulation_agrees_where_linear() {
        let analysis = three_double();
        let tolerances: Vec<f64> = analysis.process().iter().map(|t| 0.1 * t).collect();
        let simulated = analysis.simulate(&tolerances, 2000, 7).unwrap();
        let linear_n = analysis.standard_deviation_n(&tolerances);
        let errors = (simulated.standard_deviation_n - linear_n).abs() / simulated.standard_deviation_error_n;
        assert!(errors < 3.0, "{simulated:?} for {linear_n}");
        let errors = (simulated.mean_n - analysis.threshold_n).abs() / simulated.mean_error_n;
        assert!(errors < 3.0, "{simulated:?} for {}", analysis.threshold_n);
        assert_eq!(analysis.simulate(&tolerances, 2000, 7).unwrap(), simulated, "equal seeds, equal draws");
        assert_ne!(analysis.simulate(&tolerances, 2000, 8).unwrap(), simulated);
    }

    /// Heights of pins scatter independently: three pins move the threshold less than one common height.
    #[test]
    fn pin_heights_are_independent() {
        let analysis = three_double();
        let of = |dimension| analysis.contributions.iter().find(|c| c.link.dimension == dimension).unwrap();
        let (each, all) = (of(ChainDimension::PinHeight), of(ChainDimension::GrooveDepth));
        assert_eq!((each.slopes.len(), all.slopes.len()), (3, 1));
        let sum: f64 = each.slopes.iter().sum();
        assert!(
            (sum + all.slopes[0]).abs() < 0.02 * sum,
            "a deeper groove lowers its pin: {each:?}, {all:?}"
        );
        assert!(square(&each.slopes).sqrt() < 0.75 * all.slopes[0].abs());
    }

    #[test]
    fn allotted_tolerances_reach_the_wanted_scatter() {
        let analysis = three_double();
        let process_n = NORMAL_95 * analysis.linear.standard_deviation_n;
        let allocation = analysis.allocate(0.5 * process_n);
        let tolerances = allocation.tolerances.unwrap();
        assert!(allocation.reached_n <= 0.5 * process_n && allocation.reached_n > 0.45 * process_n);
        for (c, t) in analysis.contributions.iter().zip(&tolerances) {
            assert!((c.link.best.plus_minus..=c.link.process.plus_minus).contains(t), "{c:?}: {t}");
        }
        let simulated = analysis.simulate(&tolerances, 2000, 3).unwrap();
        let ratio = NORMAL_95 * simulated.standard_deviation_n / allocation.reached_n;
        assert!((ratio - 1.0).abs() < 0.1, "{ratio}");
        let refused = analysis.allocate(0.01);
        assert!(refused.tolerances.is_none() && refused.best_n > 0.01 && refused.reached_n == refused.best_n);
    }

    #[test]
    fn designs_that_do_not_switch_are_refused() {
        for (assignments, field) in [
            (&["layout.pins=[5, 8, 11]", "layout.substrate=abs"][..], "layout.substrate"),
            (&["layout.pins=[]"][..], "layout.pins"),
            (&["layout.pins=[5, 8, 11]", "friction.load_max_n=10"][..], "friction.load_max_n"),
        ] {
            let mut configuration = Configuration::default();
            assignments.iter().for_each(|one| assign(&mut configuration, one).unwrap());
            let error = Analysis::new(&Design::new(configuration).unwrap(), &[]).unwrap_err();
            assert_eq!(error.location().and_then(|l| l.field.clone()).as_deref(), Some(field));
        }
    }

    /// The threshold is that of the curve, between whose points it is interpolated.
    #[test]
    fn thresholds_agree_with_the_curve() {
        let analysis = three_double();
        let curve = crate::prediction::predicted_curve(&analysis.design);
        let transition = pinswitch_friction::Transition::of(&curve).unwrap();
        assert!((transition.threshold_n - analysis.threshold_n).abs() < 0.01);
    }
}
