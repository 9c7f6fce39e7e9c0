//! Whether what was found on some layouts holds on another: each layout left out in turn.

use std::collections::BTreeSet;

use crate::inference::{Model, Weighed, fit};

/// Root mean square error in newtons on layouts that the fit did not see. Each layout is left out in turn, with its
/// pins on both substrates; all friction coefficients and effects come from the other layouts, and only the layout's
/// own threshold and range, which no other layout can know, are then fitted to it (`model/doc/naming-an-effect.md`).
/// `None` with fewer than two layouts.
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
        // The layout's own constants start from the layout law: the fit of the others has not seen them.
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
