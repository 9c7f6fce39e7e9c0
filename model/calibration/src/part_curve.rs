//! The curve of a printed part by a calibrated model: effects of the switch in, effects of the rig out.

use pinswitch_friction::{Direction, FrictionCurve, Law, PredictionStatus, Substrate, published};

use crate::inference::prediction_sd_n;
use crate::model_check::check_friction;
use crate::model_file::{ModelFile, ModelFileError};
use crate::table::{Frame, Labels, PlateauRow, Point, Sweep};

/// Repetitions after which whatever settles has settled.
const SETTLED: u32 = 1000;

/// The rows of a part as points without a history: each as if it had been pulled at its load all the while.
fn settled_points(frame: &Frame, rows: &[PlateauRow]) -> Vec<Point> {
    let mut points = frame.points(rows).unwrap_or_default();
    for point in &mut points {
        point.through = f64::from(SETTLED);
        point.previous_load_n = point.load_n;
        point.begins_session = false;
    }
    points
}

impl ModelFile {
    /// Curve of pins in these grooves, numbered from 1, on `substrate` at ascending `loads_n`, for a slow first pull at
    /// the reference speed and the paper's wrap angle: no run-in, no drift, loads ascending. A model of a rig with
    /// another wrap angle predicts it as a layout that nobody measured. `file` is the name used in errors.
    ///
    /// # Errors
    /// [`ModelFileError`] as in [`ModelFile::model`].
    pub fn part_curve(
        &self,
        substrate: Substrate,
        pins: &[usize],
        loads_n: &[f64],
        file: &str,
    ) -> Result<FrictionCurve, ModelFileError> {
        let rows: Vec<PlateauRow> = [Direction::Eccentric, Direction::Concentric]
            .iter()
            .flat_map(|d| loads_n.iter().map(|load| self.row(substrate, pins, *load, *d)))
            .collect();
        let known = self.model(file)?;
        let mut frame = known.frame.clone();
        let measured = frame.condition_of(&rows[0]).is_some();
        frame.extend(&rows[0]);
        let model = known.in_frame(frame);
        let points = settled_points(&model.frame, &rows);
        let tension = model.predict_part(&points);
        // Half the gap of two independent readings without their noise; the model's own uncertainty only.
        let silent = crate::inference::Noise::constant(0.0, 0.0);
        let sd = prediction_sd_n(&model, &points, self.covariance(), silent);
        let n = loads_n.len();
        let friction: Vec<f64> = (0..n).map(|i| 0.5 * (tension[n + i] - tension[i])).collect();
        let half: Vec<f64> = (0..n).map(|i| 1.96 * 0.5 * (sd[i] + sd[n + i])).collect();
        let within = loads_n
            .iter()
            .all(|l| *l >= model.frame.load_range_n.0 - 1e-6 && *l <= model.frame.load_range_n.1 + 1e-6);
        let (outside, inside) = self.sides();
        let mut reasons = Vec::new();
        if !measured {
            reasons.push(
                "the layout was not among the conditions calibrated: its switch follows the layout law"
                    .to_owned(),
            );
        }
        if !within {
            reasons.push(format!(
                "loads reach beyond those calibrated, {:.2} to {:.2} N",
                model.frame.load_range_n.0, model.frame.load_range_n.1
            ));
        }
        if !inside.is_empty() {
            let drawn = |id: &str| {
                model
                    .vocabulary
                    .own()
                    .any(|own| own.definition().id == id && !own.definition().drawn_from.is_empty())
            };
            let told: Vec<String> = inside
                .iter()
                .map(|id| {
                    if drawn(id) {
                        format!("{id} (a form drawn from measured data)")
                    } else {
                        (*id).to_owned()
                    }
                })
                .collect();
            reasons.push(format!("effects of the switch are in the curve: {}", told.join(", ")));
        }
        if !outside.is_empty() {
            reasons.push(format!("effects of the measurement stay out of it: {}", outside.join(", ")));
        }
        check_friction(loads_n, &friction, &half).map_err(ModelFileError::of(file))?;
        Ok(FrictionCurve {
            law: Law::Calibrated,
            status: if measured && within {
                PredictionStatus::Interpolated
            } else {
                PredictionStatus::Extrapolated
            },
            reasons,
            load_n: loads_n.to_vec(),
            eccentric_n: tension[..n].to_vec(),
            concentric_n: tension[n..].to_vec(),
            band_low_n: friction.iter().zip(&half).map(|(d, h)| (d - h).max(0.0)).collect(),
            band_high_n: friction.iter().zip(&half).map(|(d, h)| d + h).collect(),
            friction_n: friction,
            silicone_share: model.silicone_share(&points[..n]),
        })
    }

    /// How many standard normals draw the constants of [`Self::drawn_part`].
    pub fn constants_drawn(&self) -> usize {
        self.covariance().len()
    }

    /// Friction and the silicone's share at `loads_n`, as in [`Self::part_curve`] but with constants drawn from their
    /// covariance by standard normals `z`; all zero are the fitted ones.
    ///
    /// # Errors
    /// [`ModelFileError`] as in [`ModelFile::model`].
    pub fn drawn_part(
        &self,
        substrate: Substrate,
        pins: &[usize],
        loads_n: &[f64],
        z: &[f64],
        file: &str,
    ) -> Result<(Vec<f64>, Vec<f64>), ModelFileError> {
        let rows: Vec<PlateauRow> = [Direction::Eccentric, Direction::Concentric]
            .iter()
            .flat_map(|d| loads_n.iter().map(|load| self.row(substrate, pins, *load, *d)))
            .collect();
        let mut known = self.model(file)?;
        if z.iter().any(|z| *z != 0.0) {
            let n = self.covariance().len();
            let covariance = nalgebra::DMatrix::from_fn(n, n, |i, j| self.covariance()[i][j]);
            // Eigenvalues rather than a Cholesky root: constants that the data tie together leave it singular.
            let parts = nalgebra::SymmetricEigen::new(covariance);
            for (j, z) in z.iter().take(n).enumerate() {
                let sd = parts.eigenvalues[j].max(0.0).sqrt();
                (0..n).for_each(|i| known.coordinates[i] += parts.eigenvectors[(i, j)] * sd * z);
            }
        }
        let mut frame = known.frame.clone();
        frame.extend(&rows[0]);
        let model = known.in_frame(frame);
        let points = settled_points(&model.frame, &rows);
        let tension = model.predict_part(&points);
        let n = loads_n.len();
        let friction_n = (0..n).map(|i| 0.5 * (tension[n + i] - tension[i])).collect();
        Ok((friction_n, model.silicone_share(&points[..n])))
    }

    fn row(&self, substrate: Substrate, pins: &[usize], load_n: f64, direction: Direction) -> PlateauRow {
        PlateauRow {
            series: "part".to_owned(),
            substrate: Some(substrate),
            pins: pins.to_vec(),
            sweep: Sweep::Up,
            load_mass_g: 0.0,
            load_n,
            speed_pct: self.reference_speed_pct(),
            dwell_s: published::DWELL_S,
            direction,
            repetition: SETTLED,
            position_mm: 0.0,
            time_s: 0.0,
            force_n: 0.0,
            wrap_angle_deg: published::WRAP_ANGLE_DEG,
            labels: Labels::default(),
        }
    }
}
