//! Catalogue of structures, for residuals that no effect explains.

use pinswitch_friction::Substrate;

use crate::effects::{Channel, Covariate, Shape, Structure};
use crate::table::{Frame, Point};

/// Shapes that belong together: one, or the sine and cosine of a wave.
pub(crate) type Group = Vec<Structure>;

/// Returns the distinct values of a covariate over the points, ascending, merged within
/// `tolerance`.
fn levels(points: &[Point], of: impl Fn(&Point) -> f64, tolerance: f64) -> Vec<f64> {
    let mut values: Vec<f64> = points.iter().map(of).collect();
    values.sort_by(f64::total_cmp);
    values.dedup_by(|a, b| (*a - *b).abs() < tolerance);
    values
}

/// Returns the share of the variance of one covariate that is explained by the levels of another.
fn follows(
    points: &[Point],
    what: impl Fn(&Point) -> f64,
    of: impl Fn(&Point) -> f64,
    tolerance: f64,
) -> bool {
    levels(points, &of, 1e-6).iter().all(|level| {
        let at: Vec<f64> = points.iter().filter(|p| (of(p) - level).abs() < 1e-5).map(&what).collect();
        at.iter().copied().fold(f64::NEG_INFINITY, f64::max)
            - at.iter().copied().fold(f64::INFINITY, f64::min)
            < tolerance
    })
}

/// All structures that a table could show, with the values of each shape over its rows if memory
/// permits, since they are scored repeatedly in a search.
#[derive(Debug)]
pub(crate) struct Catalogue {
    /// Frame of the table.
    pub(super) frame: Frame,
    /// The structures.
    pub(crate) groups: Vec<Group>,
    /// Index of the values of each structure of each group.
    course_of: Vec<Vec<usize>>,
    courses: Vec<Vec<f64>>,
}

/// Most stored values: some tens of megabytes.
const MOST_KEPT: usize = 4_000_000;

impl Catalogue {
    /// Builds the catalogue of a table with these points.
    pub(super) fn new(frame: &Frame, points: &[Point]) -> Self {
        let groups = structures_to_try(frame, points);
        let (mut shapes, mut course_of): (Vec<&Shape>, Vec<Vec<usize>>) = (Vec::new(), Vec::new());
        for group in &groups {
            let mut of_group = Vec::new();
            for structure in group {
                // The same shape is used on several consecutive channels.
                let near = shapes.iter().rev().take(2).position(|shape| **shape == structure.form);
                let index = near.map_or(shapes.len(), |back| shapes.len() - 1 - back);
                if near.is_none() {
                    shapes.push(&structure.form);
                }
                of_group.push(index);
            }
            course_of.push(of_group);
        }
        let courses = if shapes.len() * points.len() > MOST_KEPT {
            Vec::new()
        } else {
            shapes.iter().map(|shape| points.iter().map(|p| shape.value(p)).collect()).collect()
        };
        Self { frame: frame.clone(), course_of, courses, groups }
    }

    /// Returns the values of one structure of a group over the points.
    pub(super) fn values(&self, group: usize, place: usize, points: &[Point]) -> std::borrow::Cow<'_, [f64]> {
        match self.courses.get(self.course_of[group][place]) {
            Some(course) => course.into(),
            None => points.iter().map(|p| self.groups[group][place].value(p)).collect::<Vec<_>>().into(),
        }
    }
}

/// Returns all structures that a table of these points could show.
pub(crate) fn structures_to_try(frame: &Frame, points: &[Point]) -> Vec<Group> {
    let mut groups = Vec::new();
    time(&mut groups, frame, points);
    position(&mut groups, points);
    levels_of_conditions(&mut groups, frame, points);
    rates(&mut groups, frame, points);
    groups
}

/// Pushes one group per channel.
fn push(groups: &mut Vec<Group>, covariate: Covariate, channels: &[Channel], form: &Shape) {
    groups.extend(channels.iter().map(|c| vec![Structure { covariate, channel: *c, form: form.clone() }]));
}

/// Pushes a wave: sine and cosine together.
fn push_wave(
    groups: &mut Vec<Group>,
    covariate: Covariate,
    channels: &[Channel],
    form: impl Fn(u8) -> Shape,
) {
    groups.extend(
        channels.iter().map(|c| {
            [0, 1].map(|quarter| Structure { covariate, channel: *c, form: form(quarter) }).to_vec()
        }),
    );
}

/// Number of repetitions of a lasting memory: more than any series has.
const LASTING: f64 = 1e4;

/// All channels including the gain of the load cell, which may vary with every covariate except the
/// load.
const ALL_AND_GAIN: [Channel; 4] = [Channel::Reading, Channel::Gain, Channel::Drag, Channel::Friction];
const READING_AND_FRICTION: [Channel; 2] = [Channel::Reading, Channel::Friction];
/// Channels on which every shape is tried, including intervals of time.
pub(super) const ALL: [Channel; 3] = [Channel::Reading, Channel::Drag, Channel::Friction];

/// Returns all channels, including those of one material if a condition has it, since another
/// tendon may have less friction on silicone and more on pins.
fn by_material(frame: &Frame) -> Vec<Channel> {
    let mut channels = ALL.to_vec();
    if frame.conditions.iter().any(|c| c.substrate == Some(Substrate::Silicone)) {
        channels.push(Channel::Silicone);
    }
    if frame.conditions.iter().any(crate::table::Condition::has_pins) {
        channels.push(Channel::Pins);
    }
    channels
}

fn time(groups: &mut Vec<Group>, frame: &Frame, points: &[Point]) {
    let mut channels = by_material(frame);
    channels.push(Channel::Gain);
    let mut times: Vec<f64> = points.iter().map(|p| p.time).collect();
    times.sort_by(f64::total_cmp);
    // Sixty places for a step, at equal numbers of rows.
    for i in 3..58 {
        if let Some(at) = times.get(i * times.len() / 60) {
            push(groups, Covariate::Time, &channels, &Shape::TimeStep { at: *at });
        }
    }
    for i in 1..160 {
        let cycles = 0.5 * f64::from(i);
        push_wave(groups, Covariate::Time, &READING_AND_FRICTION, |quarter| Shape::TimeWave {
            cycles,
            quarter,
        });
    }
    for power in 1..=3 {
        push(groups, Covariate::Time, &ALL_AND_GAIN, &Shape::TimePower { power });
    }
}

fn position(groups: &mut Vec<Group>, points: &[Point]) {
    if levels(points, |p| p.position, 1e-3).len() < 6 {
        return;
    }
    for i in 2..48 {
        let cycles = 0.25 * f64::from(i);
        push_wave(groups, Covariate::Position, &ALL_AND_GAIN, |quarter| Shape::PositionWave {
            cycles,
            quarter,
        });
    }
    for i in 0..=20 {
        for width in [0.025, 0.05, 0.1] {
            let at = 0.05 * f64::from(i);
            push(groups, Covariate::Position, &ALL, &Shape::PositionBump { at, width });
        }
    }
    for power in 1..=3 {
        push(groups, Covariate::Position, &ALL_AND_GAIN, &Shape::PositionPower { power });
    }
    for r0 in [0.6, 1.5, 4.0, 10.0] {
        push(groups, Covariate::Repetition, &ALL_AND_GAIN, &Shape::Repetition { r0 });
    }
}

fn levels_of_conditions(groups: &mut Vec<Group>, frame: &Frame, points: &[Point]) {
    let unit_n = frame.load_range_n.1.max(1e-9);
    let mut sets: Vec<Vec<usize>> = (0..frame.conditions.len()).map(|i| vec![i]).collect();
    for (i, a) in frame.conditions.iter().enumerate() {
        // The same pins on both substrates: a defect of the layout itself.
        let same: Vec<usize> = (0..frame.conditions.len())
            .filter(|j| frame.conditions[*j].pins == a.pins && !a.pins.is_empty())
            .collect();
        if same.len() > 1 && same.first() == Some(&i) {
            sets.push(same);
        }
    }
    if frame.conditions.len() > 1 {
        for conditions in sets {
            push(groups, Covariate::Condition, &ALL, &Shape::ConditionIs { conditions });
        }
        for condition in 0..frame.conditions.len() {
            for power in [1, 2] {
                let form = Shape::ConditionLoad { condition, power, unit_n };
                push(groups, Covariate::Condition, &ALL, &form);
            }
        }
    }
    // With two operators, the second is compared with the first.
    for operator in frame.operator_numbers().skip(usize::from(frame.operators.len() == 2)) {
        // The level of each operator's readings is a random effect from the table's labels.
        push(
            groups,
            Covariate::Condition,
            &[Channel::Friction, Channel::Gain],
            &Shape::OperatorIs { operator },
        );
    }
    let channels = by_material(frame);
    for power in 1..=3 {
        push(groups, Covariate::Load, &channels, &Shape::LoadPower { power, unit_n });
    }
    for power in 0..=3 {
        push(groups, Covariate::Direction, &[Channel::Reading], &Shape::DirectionLoad { power, unit_n });
    }
    push(groups, Covariate::Sweep, &ALL_AND_GAIN, &Shape::Descending);
    for r0 in [3.0, 8.0, 20.0, 60.0, LASTING] {
        push(groups, Covariate::Load, &channels, &Shape::Memory { r0, unit_n });
    }
    let loads = levels(points, |p| p.load_n, 1e-3);
    if loads.len() <= 40 && !follows(points, |p| p.log_speed, |p| p.load_n, 0.01) {
        for load_n in loads {
            push(groups, Covariate::Load, &ALL, &Shape::LoadLevel { load_n, half_width: 1e-3 });
        }
    }
}

/// Returns the values themselves, or thirty values between the extremes if there are more.
fn on_a_grid(values: Vec<f64>) -> Vec<f64> {
    const MOST: usize = 30;
    match (values.first(), values.last()) {
        (Some(first), Some(last)) if values.len() > MOST => {
            (0..MOST).map(|i| first + (last - first) * i as f64 / (MOST - 1) as f64).collect()
        }
        _ => values,
    }
}

fn rates(groups: &mut Vec<Group>, frame: &Frame, points: &[Point]) {
    let mut speeds = levels(points, |p| p.log_speed, 1e-3);
    speeds.retain(|_| frame.reference_speed_pct > 0.0);
    if speeds.len() > 1 {
        // Measured speeds all differ: bumps on a grid as fine as a resonance is wide.
        if speeds.len() <= 30 {
            for log_speed in &speeds {
                let form = Shape::SpeedLevel { log_speed: *log_speed, half_width: 1e-3 };
                push(groups, Covariate::Speed, &ALL, &form);
            }
        }
        for log_speed in on_a_grid(speeds) {
            for width in [0.02, 0.04, 0.08] {
                push(groups, Covariate::Speed, &ALL, &Shape::SpeedBump { log_speed, width });
            }
        }
        for power in 1..=2 {
            push(groups, Covariate::Speed, &ALL_AND_GAIN, &Shape::SpeedPower { power });
        }
    }
    let dwells = levels(points, |p| p.log_dwell, 0.02);
    if dwells.len() > 1 {
        for log_dwell in on_a_grid(dwells) {
            push(groups, Covariate::Dwell, &ALL_AND_GAIN, &Shape::DwellLevel { log_dwell });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_levels_are_merged() {
        let point = |load_n: f64| Point { load_n, ..Point::default() };
        let points = [point(2.0), point(1.0), point(2.0 + 1e-9)];
        assert_eq!(levels(&points, |p| p.load_n, 1e-3), [1.0, 2.0]);
        assert!(follows(&points, |p| p.log_speed, |p| p.load_n, 0.01));
    }
}
