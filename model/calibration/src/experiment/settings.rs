//! Speeds and dwells to choose from: the usual ones of a rig, and those at which an effect in
//! question is largest or smallest, such as a dip at one speed.

use pinswitch_friction::published;

use super::candidates::{Candidate, alone};
use super::information::Contribution;
use super::rig::RigLimits;
use super::runs::PlannedRun;
use crate::model::Model;
use crate::table::{PlateauRow, Sweep};

/// Most additional settings.
const MORE: usize = 3;
/// Grid points for the additional settings, spaced evenly and by factors.
const GRID: usize = 60;
/// Smallest difference of an effect between an additional setting and the usual ones, as a share of
/// its largest size.
const DIFFERS: f64 = 0.15;

/// Returns speeds in percent.
pub(super) fn speeds_pct(model: &Model, rig: &RigLimits, contributions: &[Contribution]) -> Vec<f64> {
    let set = |run: &mut PlannedRun, speed: f64| run.speed_pct = speed;
    with_extremes(rig.speeds(), rig.speeds_pct, set, model, rig, contributions)
}

/// Returns dwells in seconds.
pub(super) fn dwells_s(model: &Model, rig: &RigLimits, contributions: &[Contribution]) -> Vec<f64> {
    let set = |run: &mut PlannedRun, dwell: f64| run.dwell_s = dwell;
    // A longer dwell costs more time than its information is worth.
    let usual = rig.dwells();
    let longest = usual.iter().copied().fold(rig.dwells_s[0], f64::max);
    with_extremes(usual, [rig.dwells_s[0], longest], set, model, rig, contributions)
}

fn with_extremes(
    usual: Vec<f64>,
    [low, high]: [f64; 2],
    set: impl Fn(&mut PlannedRun, f64),
    model: &Model,
    rig: &RigLimits,
    contributions: &[Contribution],
) -> Vec<f64> {
    if high <= low {
        return usual;
    }
    // To a tenth, as on the run sheet.
    let tenth = |value: f64| (10.0 * value).round() / 10.0;
    let even = |share: f64| tenth(low + share * (high - low));
    let by_factors = |share: f64| tenth(low * libm::pow(high / low, share));
    let shares = (0..=GRID).map(|i| i as f64 / GRID as f64);
    let grid = shares.flat_map(|share| [even(share), by_factors(share)]);
    let grid: Vec<f64> = usual.iter().copied().chain(grid.filter(|v| (low..=high).contains(v))).collect();
    let rows: Vec<PlateauRow> = grid.iter().flat_map(|value| rows_at(*value, &set, rig)).collect();
    let Some(points) = model.frame.points(&rows) else { return usual };
    let each = rows.len() / grid.len();
    let mut settings = usual.clone();
    for contribution in contributions {
        let Some(change) = contribution.of_effect(model, &points) else { continue };
        let sizes: Vec<f64> =
            change.chunks(each.max(1)).map(|at| at.iter().map(|v| v * v).sum::<f64>().sqrt()).collect();
        let by_size = |a: &usize, b: &usize| sizes[*a].total_cmp(&sizes[*b]);
        let extremes = [(0..sizes.len()).max_by(by_size), (0..sizes.len()).min_by(by_size)];
        let largest = sizes.iter().copied().fold(0.0, f64::max);
        for extreme in extremes.into_iter().flatten() {
            let differs = |i: usize| (sizes[extreme] - sizes[i]).abs() > DIFFERS * largest;
            let is_known = settings.contains(&grid[extreme]) || settings.len() == usual.len() + MORE;
            if !is_known && (0..usual.len()).all(differs) {
                settings.push(grid[extreme]);
            }
        }
    }
    settings.sort_by(f64::total_cmp);
    settings
}

/// Returns one row on each contact of the rig, at a load in the middle of its range.
fn rows_at(value: f64, set: &impl Fn(&mut PlannedRun, f64), rig: &RigLimits) -> Vec<PlateauRow> {
    let mut loads = rig.loads_g.clone();
    loads.sort_by(f64::total_cmp);
    let load_mass_g = loads.get(loads.len() / 2).copied().unwrap_or(1000.0);
    let contacts = rig.contacts().into_iter();
    contacts
        .filter_map(|(substrate, pins)| {
            let mut run = PlannedRun {
                substrate,
                pins,
                sweep: Sweep::Up,
                load_mass_g,
                speed_pct: rig.speeds_pct[0].midpoint(rig.speeds_pct[1]),
                dwell_s: published::DWELL_S.clamp(rig.dwells_s[0], rig.dwells_s[1]),
                repetitions: [0, 1],
                mount: 1,
                minutes: 0.0,
                asks: String::new(),
                wrap_angle_deg: rig.other_wrap_deg(),
            };
            set(&mut run, value);
            alone(&Candidate { run, late: false, after_g: None, down_from_g: None }, "1", rig, 0.0).pop()
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::{Vocabulary, effect_named};
    use crate::table::Frame;
    use crate::test_session::session;

    /// A narrow dip of friction at one speed is measured at that speed, a smooth effect at the usual
    /// ones.
    #[test]
    fn dips_add_their_speed() {
        let text = "schema = \"pinswitch.effects/1\"\n[[effect]]\nid = \"dip\"\nside = \"switch\"\ncovariate = \"speed\"\n\
                    acts_on = \"mu\"\ncombine = \"factor\"\nformula = \"-a * exp(-((speed_pct - 47.3)/1.5)^2)\"\n\
                    parameters.a = { size = true, start = 0.2, unit = \"1\" }\n";
        let vocabulary = Vocabulary::built_in().read(text, "dip.toml").unwrap();
        let rig = RigLimits { layouts: vec![vec![5, 8, 11]], ..RigLimits::default() };
        let model = Model::baseline(Frame::new(&session(1))).among(&vocabulary);
        let speeds = |effect, values: &[f64]| {
            let contribution = Contribution::Added { effect, values: values.to_vec() };
            speeds_pct(&model, &rig, &[contribution])
        };
        let with_dip = speeds(vocabulary.named("dip").unwrap(), &[0.2]);
        assert!(with_dip.len() > 3 && with_dip.iter().any(|v| (v - 47.3).abs() < 0.6), "{with_dip:?}");
        assert_eq!(speeds(effect_named("rate_dependence").unwrap(), &[0.2]), [40.0, 55.0, 70.0]);
    }
}
