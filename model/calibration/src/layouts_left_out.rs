//! Leave-one-layout-out error.

use std::collections::BTreeSet;

use crate::inference::{Model, Weighed, fit};

/// Returns the root mean square error in newtons on layouts that are left out of the fit, with
/// their pins on both substrates, in turn. Friction coefficients and effects come from the other
/// layouts; the layout's own threshold and range, which no other layout determines, are then fitted
/// to it (`model/doc/naming-an-effect.md`). `None` with fewer than two layouts.
pub fn layouts_left_out(model: &Model, weighed: &Weighed<'_>) -> Option<f64> {
    let (data, noise) = (weighed.data, weighed.noise);
    let conditions = &model.frame.conditions;
    let layouts: BTreeSet<&[usize]> =
        conditions.iter().filter(|c| c.has_pins()).map(|c| c.pins.as_slice()).collect();
    if layouts.len() < 2 {
        return None;
    }
    let (mut sum, mut count) = (0.0, 0.0);
    for pins in layouts {
        let inside = |i: usize| conditions[data.points[i].condition].pins == pins;
        let others = fit(model, &Weighed::new(&data.subset(|i| !inside(i)), noise));
        let own: Vec<usize> = conditions
            .iter()
            .filter(|c| c.pins == pins)
            .filter_map(|c| c.device)
            .flat_map(Model::device_constants)
            .collect();
        let hidden = data.subset(inside);
        // The layout's own constants start from the layout law, since the fit of the others did not
        // use its rows.
        let refitted = fit(&others.model.frozen_except(&own), &Weighed::new(&hidden, noise));
        let sound = (0..hidden.points.len()).filter(|i| hidden.is_sound(*i));
        let n: f64 = sound.clone().map(|i| hidden.counts[i]).sum();
        if n > 0.0 {
            let error_n = hidden.root_mean_square_n(sound.map(|i| (i, refitted.residual_n[i])));
            sum += n * error_n * error_n;
            count += n;
        }
    }
    (count > 0.0).then(|| f64::sqrt(sum / count))
}
