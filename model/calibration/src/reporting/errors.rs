//! Report of a fitted hypothesis: constants with intervals, and errors on held-out parts of the table.

use std::collections::BTreeMap;

use pinswitch_friction::Substrate;
use pinswitch_inference::{Fit, Member, leave_groups_out};

use crate::evidence::{Evidence, Fitted};
use crate::least_squares::{least_squares, with_rig_terms};
use crate::model::Model;
use crate::report::{Estimate, ModelReport};
use crate::table::{Condition, PlateauRow};

/// Number of parts of the series, and of the loads.
const FOLDS: usize = 4;
/// Two-sided 95 % quantile of the standard normal distribution.
pub(super) const NORMAL_95: f64 = 1.96;

/// Root mean square errors in newtons on rows that are left out of the fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct HeldOut {
    /// Error on each quarter of the series, left out in turn.
    pub(crate) series_n: f64,
    /// Error on each quarter of the loads, left out in turn.
    pub(crate) loads_n: f64,
}

impl HeldOut {
    /// Returns the root mean square of both errors.
    pub(crate) fn both_n(self) -> f64 {
        (0.5 * (self.series_n.powi(2) + self.loads_n.powi(2))).sqrt()
    }
}

/// Returns the held-out errors of a fit, with its members and noise; an error that the table cannot
/// have, for lack of loads, is replaced by the other one. Gross errors do not count.
pub(crate) fn held_out(evidence: &Evidence, fit: &Fit) -> Option<HeldOut> {
    let none = |_| Vec::new();
    let series: Vec<usize> = (0..evidence.series_count()).map(|series| series % FOLDS).collect();
    let of_series = leave_groups_out(evidence.problem(), fit, &series, none)?;
    let series_n = evidence.root_mean_square_n(&of_series);
    let of_load = load_of_series(evidence);
    let mut loads: Vec<u64> = of_load.iter().map(|load| load.to_bits()).collect();
    loads.sort_unstable();
    loads.dedup();
    let loads_n = if loads.len() > FOLDS {
        let fold = |load: &f64| loads.partition_point(|known| *known < load.to_bits()) % FOLDS;
        let groups: Vec<usize> = of_load.iter().map(fold).collect();
        evidence.root_mean_square_n(&leave_groups_out(evidence.problem(), fit, &groups, none)?)
    } else {
        series_n
    };
    Some(HeldOut { series_n, loads_n })
}

/// Returns the load in newtons of each series.
fn load_of_series(evidence: &Evidence) -> Vec<f64> {
    let mut loads = vec![0.0; evidence.series_count()];
    evidence.rows().for_each(|(_, series, point)| loads[series] = point.load_n);
    loads
}

/// Returns the error on layouts that are left out in turn, on both substrates: friction and effects come
/// from the other layouts, and the layout's own threshold, which no other determines, is then fitted
/// to it. `None` with fewer than two layouts.
fn layouts_n(evidence: &Evidence, fit: &Fit, conditions: &[Condition]) -> Option<f64> {
    let mut layouts: Vec<&[usize]> =
        conditions.iter().filter(|c| c.has_pins()).map(|c| c.pins.as_slice()).collect();
    layouts.sort_unstable();
    layouts.dedup();
    if layouts.len() < 2 {
        return None;
    }
    let mut groups = vec![layouts.len(); evidence.series_count()];
    for (_, series, point) in evidence.rows() {
        let pins = &conditions[point.condition].pins;
        groups[series] = layouts.iter().position(|layout| layout == pins).unwrap_or(layouts.len());
    }
    let own = |group: usize| {
        let is_of = |c: &&Condition| layouts.get(group).is_some_and(|layout| *layout == c.pins);
        let devices = conditions.iter().filter(is_of).filter_map(|c| c.device);
        devices.flat_map(|device| evidence.device_constants(device)).collect()
    };
    let mut residuals = leave_groups_out(evidence.problem(), fit, &groups, own)?;
    // Rows without pins belong to no layout.
    for ((_, series, _), residual) in evidence.rows().zip(&mut residuals) {
        if groups[series] == layouts.len() {
            *residual = f64::NAN;
        }
    }
    Some(evidence.root_mean_square_n(&residuals)).filter(|error| error.is_finite())
}

/// Returns the held-out error in newtons of robust least squares on the parts of the series.
pub(crate) fn least_squares_n(evidence: &Evidence, rows: &[PlateauRow], model: &Model) -> Option<f64> {
    let all: Vec<_> = evidence.rows().collect();
    // The fit to all rows is a good start for the parts.
    let baseline = {
        let points: Vec<_> = all.iter().map(|(.., point)| **point).collect();
        let readings: Vec<f64> = all.iter().map(|(row, ..)| rows[*row].force_n).collect();
        least_squares(&with_rig_terms(model), &points, &readings)
    };
    let mut residuals = vec![f64::NAN; all.len()];
    for fold in 0..FOLDS.min(evidence.series_count()) {
        let is_out = |series: usize| series % FOLDS == fold;
        let seen: Vec<_> = all.iter().filter(|(_, series, _)| !is_out(*series)).collect();
        if seen.len() < baseline.values().len() {
            return None;
        }
        let points: Vec<_> = seen.iter().map(|(.., point)| **point).collect();
        let readings: Vec<f64> = seen.iter().map(|(row, ..)| rows[*row].force_n).collect();
        let fitted = least_squares(&baseline, &points, &readings);
        for (residual, (row, series, point)) in residuals.iter_mut().zip(&all) {
            if is_out(*series) {
                let predicted = fitted.predict(std::slice::from_ref(*point));
                *residual = rows[*row].force_n - predicted.first().copied().unwrap_or(f64::NAN);
            }
        }
    }
    Some(evidence.root_mean_square_n(&residuals)).filter(|error| error.is_finite())
}

/// Returns the report of a fit.
pub(crate) fn model_report(evidence: &Evidence, fit: &Fit, fitted: &Fitted, held: HeldOut) -> ModelReport {
    ModelReport {
        rmse_n: evidence.root_mean_square_n(&evidence.residuals_n(fitted)),
        heldout_rmse_n: held.both_n(),
        heldout_series_rmse_n: held.series_n,
        heldout_loads_rmse_n: held.loads_n,
        heldout_layouts_rmse_n: layouts_n(evidence, fit, &fitted.model.frame.conditions),
        parameters: parameters(evidence, fit, fitted),
    }
}

/// Returns the constants with 95 % intervals. The interval of a size is that of the mixture over all
/// hypotheses with the effect, if the fit is the best one.
fn parameters(evidence: &Evidence, fit: &Fit, fitted: &Fitted) -> BTreeMap<String, Estimate> {
    let model = &fitted.model;
    let conditions = &model.frame.conditions;
    let is_used = |name: &str| match name {
        "mu_p" => conditions.iter().any(Condition::has_pins),
        "mu_s" => conditions.iter().any(|c| c.substrate == Some(Substrate::Silicone)),
        _ => true,
    };
    let mut parameters = BTreeMap::new();
    for (i, (name, unit)) in model.names().into_iter().enumerate().filter(|(_, (name, _))| is_used(name)) {
        let value = model.value(i).0;
        // The posterior is normal in the coordinate, which keeps a bounded constant within its bounds.
        let reach = NORMAL_95 * fitted.covariance[(i, i)].max(0.0).sqrt();
        let ci95 = [-reach, reach].map(|step| model.value_at(i, model.coordinates[i] + step).0);
        parameters.insert(name, Estimate { value, ci95, unit: unit.to_owned() });
    }
    let is_best = evidence.posterior().window.first().is_some_and(|best| best.hypothesis == fit.hypothesis);
    for member in fit.hypothesis.members().filter(|_| is_best) {
        let Member::Effect(effect) = member else { continue };
        let Some((name, ci95)) = evidence.size_interval(effect) else { continue };
        if let Some(estimate) = parameters.get_mut(&name) {
            // The value of the model is in the interval of the mixture, or close to it.
            estimate.ci95 = [ci95[0].min(estimate.value), ci95[1].max(estimate.value)];
        }
    }
    parameters
}
