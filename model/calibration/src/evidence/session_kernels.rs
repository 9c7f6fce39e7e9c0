//! Kernels over sessions: what differs between days, and what the next one is expected to be like.
//!
//! A new zero of the load cell in each session, a slow trend, another tendon from some session on and one bad day are levels of
//! the same factor. They differ in the level that a new session is expected to have, so each is a form of its own.

use std::rc::Rc;

use nalgebra::DMatrix;
use pinswitch_inference::SessionLevels;

use super::forward::Channel;
use super::structure::Record;
use super::table_kernels::Collector;
use super::variant::BasisOfRows;

/// Most sessions that have levels.
const MOST_SESSIONS: usize = 100;
/// Channels of what a session may draw again, and of the switch.
const MEASURING: &[Channel] = &[Channel::Reading, Channel::Drag, Channel::Gain, Channel::DirectionFriction];
const SWITCH: &[Channel] = &[Channel::Friction, Channel::Pins, Channel::Silicone];

/// A form of the levels with its basis.
type Form = (SessionLevels, BasisOfRows);

impl Collector<'_> {
    /// Adds levels of the sessions, in each form that their number can show.
    pub(super) fn sessions(&mut self) {
        let count = self.rows.points.iter().filter_map(|p| p.session_group).max().map_or(1, |last| last + 1);
        if self.has_levels(2..=MOST_SESSIONS, count) {
            // The one session with a wrong zero may be the last. For the switch a difference of the last session is a change that
            // lasts, and so is the difference of two sessions: mount effects contain the friction that is drawn again.
            self.levels_of_sessions(MEASURING, kinds(count, count));
            let of_switch = if count == 2 { vec![vec![random_walk(count)]] } else { kinds(count, count - 1) };
            self.levels_of_sessions(&[SWITCH, &self.half_loads()].concat(), of_switch);
        }
    }

    fn levels_of_sessions(&mut self, channels: &[Channel], kinds: Vec<Vec<Form>>) {
        let probability = 1.0 / kinds.len() as f64;
        let (mut variants, mut session_levels) = (Vec::new(), Vec::new());
        for kind in kinds {
            let (levels, bases): (Vec<SessionLevels>, Vec<BasisOfRows>) = kind.into_iter().unzip();
            session_levels.extend(levels);
            variants.extend(self.variants(bases, probability));
        }
        for structure in self.add_variants("session", "session", Record::Sessions, channels, variants) {
            structure.session_levels.clone_from(&session_levels);
        }
    }
}

/// Returns the forms of the levels of this many sessions, by kind, without those that fewer than three sessions do not show. One
/// session that differs is among the first ones up to a number.
fn kinds(count: usize, until: usize) -> Vec<Vec<Form>> {
    let independent = basis(count, move |session, column| match session {
        Some(session) => one(session == column),
        None => 1.0 / count as f64,
    });
    let change = |at: usize| {
        let since = move |session: Option<usize>, _| one(session.is_none_or(|session| session >= at));
        (SessionLevels::OneChange(count), basis(1, since))
    };
    let single = |at: usize| {
        let of_one = move |session: Option<usize>, _| one(session == Some(at));
        (SessionLevels::OneSession(count), basis(1, of_one))
    };
    let mut kinds = vec![vec![(SessionLevels::Independent, independent)], vec![random_walk(count)]];
    if count > 2 {
        kinds.push((1..count).map(change).collect());
        kinds.push((1..until).map(single).collect());
    }
    kinds
}

fn random_walk(count: usize) -> Form {
    let steps = basis(count - 1, |session, column| one(session.is_none_or(|session| session > column)));
    (SessionLevels::RandomWalk, steps)
}

/// Returns a basis by its values for the session of a row, which is `None` for a new one.
fn basis(columns: usize, value: impl Fn(Option<usize>, usize) -> f64 + 'static) -> BasisOfRows {
    Rc::new(move |rows| {
        DMatrix::from_fn(rows.len(), columns, |row, column| value(rows.points[row].session_group, column))
    })
}

fn one(is_in: bool) -> f64 {
    f64::from(u8::from(is_in))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evidence::covariates::Covariates;
    use crate::table::Frame;
    use crate::test_session::session;

    /// A new session has the value that its form expects, given those of four sessions.
    #[test]
    fn bases_give_the_expected_level_of_a_new_session() {
        let mut rows: Vec<_> = (0..4).flat_map(|_| session(3).into_iter().take(2)).collect();
        rows.iter_mut().enumerate().for_each(|(i, row)| row.labels.session = format!("day {}", 9 - i / 2));
        let frame = Frame::new(&rows);
        rows[7].labels.session = "another day".to_owned();
        let covariates = Covariates::new(&frame, &rows).unwrap();
        let forms: Vec<_> = kinds(4, 4).into_iter().flatten().collect();
        assert_eq!(forms.len(), 2 + 3 + 3);
        for (levels, basis) in forms {
            let columns = basis(&covariates);
            let coefficients = nalgebra::DVector::from_fn(columns.ncols(), |i, _| [0.5, -0.2, 0.9, 0.1][i]);
            let values = &columns * &coefficients;
            let of = |day: &str| {
                let at = covariates.labels.iter().position(|label| label.session == day).unwrap();
                values[at]
            };
            let known = ["day 9", "day 8", "day 7", "day 6"].map(of);
            let expected = levels.expected(&known);
            assert!((of("another day") - expected).abs() < 1e-12, "{levels:?}: {known:?}");
        }
    }
}
