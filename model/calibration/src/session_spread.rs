//! What the fitted sessions drew for themselves, and another one draws again: the spread of predictions for a new session.

use crate::model::Model;
use crate::table::{Frame, Point};

/// Times of the fitted session at which its drift is evaluated.
const DRIFT_TIMES: usize = 24;

/// Returns the root mean square of the drift of the fitted session about its mean, in newtons at each point.
pub(crate) fn drift_n(model: &Model, points: &[Point], mean_n: &[f64]) -> Vec<f64> {
    let Frame { travel_time_s, travel_share, session_s, .. } = &model.frame;
    let stride = (travel_time_s.len() / DRIFT_TIMES).max(1);
    let times: Vec<(f64, f64)> = travel_time_s
        .iter()
        .zip(travel_share)
        .step_by(stride)
        .map(|(time_s, travel)| (time_s / session_s, *travel))
        .collect();
    let at =
        |(time, travel): (f64, f64)| move |p: &Point| Point { time, travel, is_new_session: false, ..*p };
    root_mean_square_n(model, points, mean_n, times.into_iter().map(at))
}

/// Returns the root mean square by which the levels of the fitted sessions differ from the one that another session is expected
/// to have, in newtons at each point of another session; zero at those of a fitted one.
pub(crate) fn levels_of_sessions_n(model: &Model, points: &[Point], expected_n: &[f64]) -> Vec<f64> {
    let of =
        |session: usize| move |p: &Point| Point { session_group: p.session_group.or(Some(session)), ..*p };
    root_mean_square_n(model, points, expected_n, (0..model.frame.sessions.len()).map(of))
}

/// Returns the root mean square of the changes of a prediction by changes of its points.
fn root_mean_square_n<C: Fn(&Point) -> Point>(
    model: &Model,
    points: &[Point],
    expected_n: &[f64],
    changes: impl ExactSizeIterator<Item = C>,
) -> Vec<f64> {
    let count = changes.len().max(1) as f64;
    let mut squares = vec![0.0; points.len()];
    for change in changes {
        let changed_n = model.predict(&points.iter().map(change).collect::<Vec<_>>());
        let differences = changed_n.iter().zip(expected_n).map(|(a, b)| (a - b).powi(2));
        squares.iter_mut().zip(differences).for_each(|(sum, square)| *sum += square);
    }
    squares.iter().map(|sum| (sum / count).sqrt()).collect()
}
