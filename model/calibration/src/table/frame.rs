//! Quantities of a whole session: conditions, reference values, and scaled covariates of rows.

use std::collections::BTreeMap;

use pinswitch_friction::{Substrate, published};
use serde::{Deserialize, Serialize};

use super::change::Change;
use super::substrate_word::substrate_word;
use super::{Labels, PlateauRow, Sweep};

/// A condition: substrate and pins.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Condition {
    /// What the tendon touches; `None` for `plain`.
    #[serde(rename = "surface", with = "crate::table::substrate_word")]
    pub substrate: Option<Substrate>,
    /// Occupied grooves, ascending.
    pub pins: Vec<usize>,
    /// Index among the devices (pins on silicone); `None` for other conditions.
    pub device: Option<usize>,
    /// Wrap angle in radians; 1 for `plain`, whose exponent is free.
    pub wrap_rad: f64,
    /// Weight `w = n/30` of eq. 4 (`model/doc/friction-laws.md`).
    pub weight: f64,
    /// Mean deflection angle of the tendon at a pin in radians, `a/n`; zero without pins.
    pub turn_rad: f64,
    /// `sum theta_i^1.5` over the pins in rad^1.5 (`model/doc/friction-laws.md`); zero without
    /// pins.
    pub ploughing: f64,
}

impl Condition {
    /// Returns the unevenness of the deflection angles: the mean of `theta_i^1.5` over that of
    /// equal angles. It is 1 if all are equal, zero without pins, and distinguishes layouts with
    /// equal numbers of pins.
    pub fn turn_unevenness(&self) -> f64 {
        let n = self.pins.len() as f64;
        if self.turn_rad > 0.0 { self.ploughing / (n * libm::pow(self.turn_rad, 1.5)) } else { 0.0 }
    }

    pub(crate) fn new(
        substrate: Option<Substrate>,
        pins: &[usize],
        wrap_angle_deg: f64,
        device: Option<usize>,
    ) -> Self {
        Self::with_wrap_rad(substrate, pins, wrap_rad(substrate, wrap_angle_deg), device)
    }

    fn with_wrap_rad(substrate: Option<Substrate>, pins: &[usize], wrap: f64, device: Option<usize>) -> Self {
        let n = pins.len() as f64;
        let ploughing = Self::ploughing_sum(pins, wrap);
        Self {
            substrate,
            pins: pins.to_vec(),
            device,
            wrap_rad: wrap,
            weight: (n / 30.0).min(1.0),
            turn_rad: if pins.is_empty() { 0.0 } else { wrap / n },
            ploughing,
        }
    }

    /// Returns `sum theta_i^1.5` over occupied grooves within a wrap in radians
    /// (`model/doc/friction-laws.md`).
    pub(crate) fn ploughing_sum(pins: &[usize], wrap: f64) -> f64 {
        let pitch: Vec<f64> = pins
            .windows(2)
            .map(|w| (w[1] - w[0]) as f64 * published::GROOVE_PITCH_DEG.to_radians())
            .collect();
        // Inner pins deflect the tendon by half of both neighbouring pitches; the end pins by half
        // a pitch and half of the wrap that the pitches leave (`model/doc/friction-laws.md`).
        let outside = (wrap - pitch.iter().sum::<f64>()).max(0.0) / 2.0;
        let half = |i: Option<usize>| i.and_then(|i| pitch.get(i)).map_or(outside, |p| p / 2.0);
        (0..pins.len()).map(|i| libm::pow(half(i.checked_sub(1)) + half(Some(i)), 1.5)).sum()
    }

    /// Returns the name: `silicone`, `abs 5;8;11`, `silicone 5;8;11 at 90 deg`.
    pub fn name(&self) -> String {
        format!("{} {}", substrate_word(self.substrate), self.layout()).trim_end().to_owned()
    }

    /// Returns the pins, and the wrap angle where it is not the published one: `5;8;11`, `5;8;11 at
    /// 90 deg`.
    pub fn layout(&self) -> String {
        let pins: Vec<String> = self.pins.iter().map(usize::to_string).collect();
        let pins = pins.join(";");
        let usual = wrap_rad(self.substrate, published::WRAP_ANGLE_DEG);
        if (self.wrap_rad - usual).abs() < SAME_WRAP_RAD {
            pins
        } else {
            let degrees = (self.wrap_rad.to_degrees() * 1e4).round() / 1e4;
            format!("{pins} at {degrees} deg").trim_start().to_owned()
        }
    }

    /// Returns whether pins touch the tendon (on `abs` or in a device).
    pub fn has_pins(&self) -> bool {
        !self.pins.is_empty() && self.substrate.is_some()
    }
}

/// Wrap angles in radians closer than this are equal.
const SAME_WRAP_RAD: f64 = 1e-9;

/// Returns the wrap angle in radians; 1 for `plain`, whose exponent is free.
fn wrap_rad(substrate: Option<Substrate>, wrap_angle_deg: f64) -> f64 {
    if substrate.is_none() { 1.0 } else { wrap_angle_deg.to_radians() }
}

/// Conditions and reference values of a session. A model contains them to predict rows of the same
/// rig later.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Frame {
    /// Length of the stroke in millimetres.
    pub stroke_mm: f64,
    /// Time of the last reading in seconds, the unit of the session's time.
    pub session_s: f64,
    /// Geometric mean of the speeds in percent: `v0` of `rate_dependence`.
    pub reference_speed_pct: f64,
    /// Times in seconds, ascending, at which the share of repetitions is tabulated.
    pub travel_time_s: Vec<f64>,
    /// Share of all repetitions made by those times.
    pub travel_share: Vec<f64>,
    /// Highest and lowest declared load in newtons.
    pub load_range_n: (f64, f64),
    /// The conditions, in order of appearance.
    pub conditions: Vec<Condition>,
    /// Names of the sessions in order of appearance; empty with fewer than two.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub sessions: Vec<String>,
    /// Names of the specimens in order of appearance; empty with fewer than two.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub specimens: Vec<String>,
    /// Names of the operators in alphabetical order; empty with fewer than two.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub operators: Vec<String>,
    /// Constants that differ in some sessions or specimens from the last one.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub changes: Vec<Change>,
    /// Whether the wrap angle of `plain` contacts is known, so that they have a friction coefficient in
    /// place of an exponent.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub has_plain_angles: bool,
    /// Mean time and mean travel of the fitted rows, at which a drift acts on a later session: another
    /// session may drift differently.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mean_time: Option<[f64; 2]>,
}

/// Covariates of a row for the friction model.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Point {
    /// Index into [`Frame::conditions`].
    pub condition: usize,
    /// Declared load in newtons.
    pub load_n: f64,
    /// `d`: -1 eccentric, +1 concentric.
    pub sign: f64,
    /// 1 when the loads descend, else 0.
    pub descending: f64,
    /// `ln(v/v0)`.
    pub log_speed: f64,
    /// `ln(dwell / 3 s)`.
    pub log_dwell: f64,
    /// Repetition in its series and direction, from 1.
    pub repetition: f64,
    /// Position over stroke, 0..1.
    pub position: f64,
    /// Time over session, 0..1.
    pub time: f64,
    /// Share of all repetitions made so far, 0..1.
    pub travel: f64,
    /// Load of the previous series of the session in newtons; its own load for the first series.
    pub previous_load_n: f64,
    /// Repetitions made so far in the series, in both directions.
    pub through: f64,
    /// Whether its series is the first of its session.
    pub begins_session: bool,
    /// Speed in percent; the reference speed where the table has 0.
    pub speed_pct: f64,
    /// Pause before the reading in seconds; the published dwell where the table has 0.
    pub dwell_s: f64,
    /// Position in millimetres.
    pub position_mm: f64,
    /// Seconds since the session began.
    pub time_s: f64,
    /// Number of the session, from 1 in the order of the table.
    pub session: f64,
    /// Number of the mount, or its position in the order of the table, from 1.
    pub mount: f64,
    /// Number of the operator, from 1 in the order of [`Frame::operators`]; 1 if there is only one
    /// operator, 0 for an unknown one.
    pub operator: f64,
    /// Whether it belongs to a later session than the fitted one.
    pub is_new_session: bool,
    /// Index of its session in [`Frame::sessions`], if listed.
    pub session_group: Option<usize>,
    /// Index of its specimen in [`Frame::specimens`], if listed.
    pub specimen_group: Option<usize>,
}

impl Point {
    /// Returns whether two rows differ at most in repetition, position, time and order.
    pub(crate) fn has_setting_of(&self, other: &Point) -> bool {
        self.has_contact_of(other)
            && self.load_n == other.load_n
            && self.sign == other.sign
            && self.descending == other.descending
            && self.log_speed == other.log_speed
            && self.log_dwell == other.log_dwell
            && self.session == other.session
            && self.mount == other.mount
            && self.operator == other.operator
    }

    /// Returns whether two rows have the same contact before any effect.
    pub(crate) fn has_contact_of(&self, other: &Point) -> bool {
        self.condition == other.condition
            && self.session_group == other.session_group
            && self.specimen_group == other.specimen_group
    }
}

impl Frame {
    /// Whether all contacts are `plain`: the rig has neither silicone nor pins.
    pub fn is_plain(&self) -> bool {
        self.conditions.iter().all(|condition| condition.substrate.is_none())
    }

    /// Returns the frame of a table.
    pub fn new(rows: &[PlateauRow]) -> Self {
        let max = |f: fn(&PlateauRow) -> f64| rows.iter().map(f).fold(0.0f64, f64::max);
        let furthest = max(|r| r.position_mm);
        let speeds: Vec<f64> = rows.iter().map(|r| r.speed_pct).filter(|v| *v > 0.0).map(libm::log).collect();
        let session_s = session_length_s(rows);
        let begins = begins_s(rows, session_s);
        let mut times: Vec<f64> = rows.iter().map(|r| since(&begins, r)).collect();
        times.sort_by(f64::total_cmp);
        let count = times.len().max(1);
        let stride = (count / 400).max(1);
        let (mut travel_time_s, mut travel_share) = (Vec::new(), Vec::new());
        for (i, t) in times.iter().enumerate() {
            if (i % stride == 0 || i + 1 == count) && travel_time_s.last().is_none_or(|last| t > last) {
                travel_time_s.push(*t);
                travel_share.push(i as f64 / count as f64);
            }
        }
        let mut frame = Self {
            stroke_mm: if furthest > published::STROKE_MM * 1.05 { furthest } else { published::STROKE_MM },
            session_s,
            reference_speed_pct: if speeds.is_empty() {
                1.0
            } else {
                libm::exp(speeds.iter().sum::<f64>() / speeds.len() as f64)
            },
            travel_time_s,
            travel_share,
            load_range_n: (rows.iter().map(|r| r.load_n).fold(f64::INFINITY, f64::min), max(|r| r.load_n)),
            conditions: Vec::new(),
            sessions: several(rows, |labels| &labels.session),
            specimens: several(rows, |labels| &labels.specimen),
            operators: sorted(several(rows, |labels| &labels.operator)),
            changes: Vec::new(),
            has_plain_angles: rows
                .iter()
                .any(|row| row.substrate.is_none() && row.wrap_angle_deg != published::WRAP_ANGLE_DEG),
            mean_time: None,
        };
        for row in rows {
            frame.extend(row);
        }
        let points = frame.points(rows).unwrap_or_default();
        let mean = |of: fn(&Point) -> f64| points.iter().map(of).sum::<f64>() / points.len().max(1) as f64;
        frame.mean_time = Some([mean(|p| p.time), mean(|p| p.travel)]);
        frame
    }

    /// Adds the condition of a row if it is new.
    pub fn extend(&mut self, row: &PlateauRow) {
        if self.condition_of(row).is_none() {
            let device =
                (row.substrate == Some(Substrate::Silicone) && !row.pins.is_empty()).then(|| self.devices());
            let wrap = self.wrap_rad(row);
            self.conditions.push(Condition::with_wrap_rad(row.substrate, &row.pins, wrap, device));
        }
    }

    /// Returns the number of devices.
    pub fn devices(&self) -> usize {
        self.conditions.iter().filter(|c| c.device.is_some()).count()
    }

    /// Returns the index of the condition of a row, if the frame has it.
    pub fn condition_of(&self, row: &PlateauRow) -> Option<usize> {
        let wrap = self.wrap_rad(row);
        self.conditions.iter().position(|c| {
            c.substrate == row.substrate && c.pins == row.pins && (c.wrap_rad - wrap).abs() < SAME_WRAP_RAD
        })
    }

    /// Returns the wrap angle of a row in radians; 1 for `plain` contacts with a free exponent.
    fn wrap_rad(&self, row: &PlateauRow) -> f64 {
        let is_free = row.substrate.is_none() && !self.has_plain_angles;
        if is_free { 1.0 } else { row.wrap_angle_deg.to_radians() }
    }

    /// Returns the rows of a later session as points: drifts have their mean over the fitted session.
    pub(crate) fn points_of_new_session(&self, rows: &[PlateauRow]) -> Option<Vec<Point>> {
        let mut points = self.points(rows)?;
        if let Some([time, travel]) = self.mean_time {
            for point in &mut points {
                (point.time, point.travel, point.is_new_session) = (time, travel, true);
            }
        }
        Some(points)
    }

    /// Returns the rows as points; `None` if the frame lacks the condition of a row.
    pub fn points(&self, rows: &[PlateauRow]) -> Option<Vec<Point>> {
        let begins = begins_s(rows, self.session_s);
        let mut points: Vec<Point> =
            rows.iter().map(|row| self.point(row, since(&begins, row))).collect::<Option<_>>()?;
        // Previous loads follow from the order in time, whatever the order of the table.
        let mut order: Vec<usize> = (0..rows.len()).collect();
        order.sort_by(|a, b| {
            let (a, b) = (&rows[*a], &rows[*b]);
            a.labels.session.cmp(&b.labels.session).then(a.time_s.total_cmp(&b.time_s))
        });
        let mut made: BTreeMap<(&str, &str), (f64, bool, f64)> = BTreeMap::new();
        let mut last: Option<(&str, f64)> = None;
        for i in order {
            let row = &rows[i];
            let session = row.labels.session.as_str();
            let before = last.filter(|(of, _)| *of == session).map(|(_, load)| load);
            let begun = (before.unwrap_or(row.load_n), before.is_none(), 0.0);
            let (previous, first, through) = made.entry((session, row.series.as_str())).or_insert(begun);
            points[i].previous_load_n = *previous;
            points[i].begins_session = *first;
            points[i].through = *through;
            *through += 1.0;
            last = Some((session, row.load_n));
        }
        let (mut sessions, mut mounts) = (BTreeMap::new(), BTreeMap::new());
        for (point, row) in points.iter_mut().zip(rows) {
            point.session = place_of(&mut sessions, row.labels.session.as_str());
            let place = place_of(&mut mounts, row.labels.mount.as_str());
            point.mount = row.labels.mount.parse().ok().filter(|m: &f64| m.is_finite()).unwrap_or(place);
        }
        Some(points)
    }

    /// Returns the numbers of the operators to analyse; empty if there is only one.
    pub(crate) fn operator_numbers(&self) -> std::ops::RangeInclusive<usize> {
        /// Most operators that are analysed individually.
        const MOST: usize = 8;
        1..=self.operators.len().min(MOST)
    }

    fn operator_of(&self, row: &PlateauRow) -> f64 {
        let place = self.operators.iter().position(|name| *name == row.labels.operator);
        if self.operators.is_empty() { 1.0 } else { place.map_or(0.0, |place| (place + 1) as f64) }
    }

    fn point(&self, row: &PlateauRow, time_s: f64) -> Option<Point> {
        let log_ratio = |v: f64, v0: f64| if v > 0.0 && v0 > 0.0 { libm::log(v / v0) } else { 0.0 };
        Some(Point {
            condition: self.condition_of(row)?,
            load_n: row.load_n,
            sign: row.direction.sign(),
            descending: f64::from(u8::from(row.sweep == Sweep::Down)),
            log_speed: log_ratio(row.speed_pct, self.reference_speed_pct),
            log_dwell: log_ratio(row.dwell_s, published::DWELL_S),
            repetition: f64::from(row.repetition),
            position: row.position_mm / self.stroke_mm,
            time: time_s / self.session_s,
            travel: interpolate(&self.travel_time_s, &self.travel_share, time_s),
            previous_load_n: row.load_n,
            through: 0.0,
            begins_session: true,
            speed_pct: if row.speed_pct > 0.0 { row.speed_pct } else { self.reference_speed_pct },
            dwell_s: if row.dwell_s > 0.0 { row.dwell_s } else { published::DWELL_S },
            position_mm: row.position_mm,
            time_s,
            session: 1.0,
            mount: 1.0,
            operator: self.operator_of(row),
            is_new_session: false,
            session_group: self.sessions.iter().position(|name| *name == row.labels.session),
            specimen_group: self.specimens.iter().position(|name| *name == row.labels.specimen),
        })
    }
}

/// Clock time in seconds at the start of each session: zero by default, or the time of the first
/// row if the clock did not start with the session, such as one that shows the time of day.
type Begins<'a> = BTreeMap<&'a str, f64>;

/// Finds the start of each clock. A clock did not start with its session if it begins below zero or
/// above the length of a session.
fn begins_s(rows: &[PlateauRow], session_s: f64) -> Begins<'_> {
    let mut first: Begins<'_> = BTreeMap::new();
    for row in rows {
        let at = first.entry(&row.labels.session).or_insert(row.time_s);
        *at = at.min(row.time_s);
    }
    first.values_mut().for_each(|at| *at = if (0.0..=session_s).contains(at) { 0.0 } else { *at });
    first
}

fn since(begins: &Begins<'_>, row: &PlateauRow) -> f64 {
    row.time_s - begins.get(row.labels.session.as_str()).copied().unwrap_or(0.0)
}

/// Returns the length in seconds of the longest session, from the start of its clock.
fn session_length_s(rows: &[PlateauRow]) -> f64 {
    let mut spans: BTreeMap<&str, (f64, f64)> = BTreeMap::new();
    for row in rows {
        let (first, last) = spans.entry(&row.labels.session).or_insert((row.time_s, row.time_s));
        (*first, *last) = (first.min(row.time_s), last.max(row.time_s));
    }
    let mut longest = spans.values().map(|(first, last)| last - first).fold(1e-9, f64::max);
    // Each iteration may find another session whose clock started with it.
    for _ in 0..=spans.len() {
        let until =
            spans.values().filter(|(first, _)| (0.0..=longest).contains(first)).map(|(_, last)| *last);
        longest = until.fold(longest, f64::max);
    }
    longest
}

/// Returns the labels of some rows in order of appearance; empty if all are equal.
fn several(rows: &[PlateauRow], label: impl Fn(&Labels) -> &String) -> Vec<String> {
    let (of, count) = groups(rows, |row| label(&row.labels).clone());
    let mut names = vec![String::new(); count];
    for (row, group) in rows.iter().zip(of) {
        names[group].clone_from(label(&row.labels));
    }
    if count > 1 { names } else { Vec::new() }
}

/// Sorts names, so that a number means the same operator in the next table.
fn sorted(mut names: Vec<String>) -> Vec<String> {
    names.sort();
    names
}

/// Returns the position of a name among those seen so far, from 1.
fn place_of<'a>(seen: &mut BTreeMap<&'a str, f64>, name: &'a str) -> f64 {
    let next = (seen.len() + 1) as f64;
    *seen.entry(name).or_insert(next)
}

/// Interpolates linearly, with constant ends; `x` ascending.
pub(crate) fn interpolate(x: &[f64], y: &[f64], at: f64) -> f64 {
    let i = x.partition_point(|v| *v <= at);
    match (i.checked_sub(1).and_then(|j| x.get(j).zip(y.get(j))), x.get(i).zip(y.get(i))) {
        (Some((x0, y0)), Some((x1, y1))) => y0 + (y1 - y0) * (at - x0) / (x1 - x0),
        (Some((_, y0)), None) => *y0,
        (None, Some((_, y1))) => *y1,
        (None, None) => 0.0,
    }
}

/// Groups rows by a key, in order of first appearance. Returns the group of each row, and the
/// number of groups.
pub(crate) fn groups<K: Ord>(rows: &[PlateauRow], key: impl Fn(&PlateauRow) -> K) -> (Vec<usize>, usize) {
    let mut seen = BTreeMap::new();
    let number = |row: &PlateauRow| {
        let next = seen.len();
        *seen.entry(key(row)).or_insert(next)
    };
    let of = rows.iter().map(number).collect();
    (of, seen.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The deflection angles at all pins sum to the wrap (`model/doc/friction-laws.md`), so that
    /// `sum theta^1.5` is at most `a sqrt(a)`.
    #[test]
    fn deflection_angles_satisfy_the_vector_balance() {
        let six =
            Condition::new(Some(Substrate::Abs), &[3, 5, 7, 9, 11, 13], published::WRAP_ANGLE_DEG, None);
        let double = Condition::new(Some(Substrate::Abs), &[5, 8, 11], published::WRAP_ANGLE_DEG, None);
        let single = Condition::new(Some(Substrate::Abs), &[6, 8, 10], published::WRAP_ANGLE_DEG, None);
        // kappa = 0.0237 gives the pins-only maxima at +2.7 / -2.5 / -0.3 %
        // (`model/doc/friction-laws.md`).
        let load = published::heaviest_load_n();
        let miss = |c: &Condition, published: f64| {
            100.0 * (load * libm::sinh(0.0237 * load.sqrt() * c.ploughing) / published - 1.0)
        };
        assert!((miss(&six, 3.935) - 2.7).abs() < 0.5, "{}", miss(&six, 3.935));
        assert!((miss(&double, 5.829) + 2.5).abs() < 0.5, "{}", miss(&double, 5.829));
        assert!((miss(&single, 5.893) + 0.3).abs() < 0.5, "{}", miss(&single, 5.893));
    }

    #[test]
    fn another_wrap_angle_is_another_condition() {
        let silicone = |wrap_angle_deg| Condition::new(Some(Substrate::Silicone), &[], wrap_angle_deg, None);
        assert_eq!(silicone(published::WRAP_ANGLE_DEG).name(), "silicone");
        assert_eq!(silicone(95.0).name(), "silicone at 95 deg");
        let plain = Condition::new(None, &[], 95.0, None);
        assert_eq!((plain.name().as_str(), plain.wrap_rad), ("plain", 1.0));
        let mut rows = crate::test_session::session(1);
        rows[0].wrap_angle_deg = 95.0;
        assert_eq!(Frame::new(&rows).conditions.len(), 6);
    }

    #[test]
    fn interpolation_is_constant_outside() {
        assert_eq!(interpolate(&[0.0, 2.0], &[0.0, 1.0], -1.0), 0.0);
        assert_eq!(interpolate(&[0.0, 2.0], &[0.0, 1.0], 1.0), 0.5);
        assert_eq!(interpolate(&[0.0, 2.0], &[0.0, 1.0], 5.0), 1.0);
    }
}
