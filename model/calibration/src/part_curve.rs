//! Friction curve of a printed part from a calibrated model: includes effects of the switch,
//! excludes those of the rig.

use pinswitch_diagnostic::{Diagnostic, Location, codes};
use pinswitch_friction::{Direction, FrictionCurve, Law, PredictionStatus, Substrate, published};

use crate::model::{Model, Noise, prediction_sd_n};
use crate::model_check::check_friction;
use crate::model_file::ModelFile;
use crate::table::{Frame, Labels, PlateauRow, Point, Sweep, Unknown};

/// Number of repetitions after which all transients have settled.
const SETTLED: u32 = 1000;

/// Converts the rows of a part to points without history, as if each had always been pulled at its
/// load.
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
    /// Checks that the fitted table has what a part touches: the friction of anything else is that of the prior. `file` is
    /// the name of the model in errors.
    ///
    /// # Errors
    /// A [`Diagnostic`] that names the material without a reading.
    pub fn check_materials(
        &self,
        substrate: Substrate,
        has_pins: bool,
        file: &str,
    ) -> Result<(), Diagnostic> {
        let conditions = self.conditions();
        let is_measured = |of: Substrate| conditions.iter().any(|c| c.substrate == Some(of));
        let missing = if substrate == Substrate::Silicone && !is_measured(Substrate::Silicone) {
            "silicone"
        } else if has_pins && conditions.iter().all(|c| c.pins.is_empty()) {
            "pins"
        } else {
            return Ok(());
        };
        let problem =
            format!("no reading of the fitted table is on {missing}, whose friction it does not give");
        Err(Diagnostic::new(codes::MODEL_BEYOND_RIG, problem)
            .with_location(Location::file(file))
            .with_help("measure a switch and calibrate, or use the published constants, without a model"))
    }

    /// Returns the curve of pins in these grooves, numbered from 1, on `substrate` at ascending
    /// `loads_n` in newtons.
    ///
    /// It applies to a slow pull at the reference speed and the paper's wrap angle, without run-in
    /// or drift and with ascending loads. A model of a rig with another wrap angle predicts it as
    /// an unmeasured layout. `file` is the name of the model in errors.
    ///
    /// # Errors
    /// As [`ModelFile::model`] and [`ModelFile::check_materials`], and if the predicted friction is impossible.
    pub fn part_curve(
        &self,
        substrate: Substrate,
        pins: &[usize],
        loads_n: &[f64],
        file: &str,
    ) -> Result<FrictionCurve, Diagnostic> {
        self.check_materials(substrate, !pins.is_empty(), file)?;
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
        // The band is the uncertainty of the model only: half the gap of two independent readings,
        // without their noise.
        let no_noise = Noise::constant(0.0, 0.0);
        let sd = prediction_sd_n(&model, &points, &self.covariance(), no_noise);
        let n = loads_n.len();
        let friction: Vec<f64> = (0..n).map(|i| 0.5 * (tension[n + i] - tension[i])).collect();
        let half: Vec<f64> = (0..n).map(|i| 1.96 * 0.5 * (sd[i] + sd[n + i])).collect();
        let within = loads_n
            .iter()
            .all(|l| *l >= model.frame.load_range_n.0 - 1e-6 && *l <= model.frame.load_range_n.1 + 1e-6);
        let (outside, inside) = self.sides();
        let mut reasons = Vec::new();
        if !measured {
            reasons.push("the layout was not calibrated: its threshold follows the layout law".to_owned());
        }
        if !within {
            reasons.push(format!(
                "some loads are outside the calibrated range of {:.2} to {:.2} N",
                model.frame.load_range_n.0, model.frame.load_range_n.1
            ));
        }
        if !inside.is_empty() {
            let drawn = |id: &str| {
                model.vocabulary.own().any(|own| {
                    own.definition().id == id
                        && own.definition().drawn_from.as_ref().is_some_and(|from| !from.is_empty())
                })
            };
            let names: Vec<String> = inside
                .iter()
                .map(|id| {
                    if drawn(id) {
                        format!("{id} (a formula derived from measured data)")
                    } else {
                        (*id).to_owned()
                    }
                })
                .collect();
            reasons.push(format!("the curve includes effects of the switch: {}", names.join(", ")));
        }
        if !outside.is_empty() {
            reasons.push(format!("the curve excludes effects of the measurement: {}", outside.join(", ")));
        }
        check_friction(loads_n, &friction, &half).map_err(|e| e.or_in_file(file))?;
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

    /// Returns the number of standard normal variates that [`Self::drawn_part`] needs.
    pub fn constants_drawn(&self) -> usize {
        self.covariance().nrows()
    }

    /// Returns friction in newtons and the silicone's share at `loads_n`, as [`Self::part_curve`],
    /// for constants drawn from their covariance with standard normal variates `z`; zeros give the
    /// fitted constants.
    ///
    /// # Errors
    /// As [`ModelFile::model`].
    pub fn drawn_part(
        &self,
        substrate: Substrate,
        pins: &[usize],
        loads_n: &[f64],
        z: &[f64],
        file: &str,
    ) -> Result<(Vec<f64>, Vec<f64>), Diagnostic> {
        let rows: Vec<PlateauRow> = [Direction::Eccentric, Direction::Concentric]
            .iter()
            .flat_map(|d| loads_n.iter().map(|load| self.row(substrate, pins, *load, *d)))
            .collect();
        let known = self.drawn_model(z, file)?;
        let mut frame = known.frame.clone();
        frame.extend(&rows[0]);
        let model = known.in_frame(frame);
        let points = settled_points(&model.frame, &rows);
        let tension = model.predict_part(&points);
        let n = loads_n.len();
        let friction_n = (0..n).map(|i| 0.5 * (tension[n + i] - tension[i])).collect();
        Ok((friction_n, model.silicone_share(&points[..n])))
    }

    /// Returns the names and units of the constants, with their values for constants drawn from their covariance
    /// with standard normal variates `z`, as in [`Self::drawn_part`].
    ///
    /// # Errors
    /// As [`ModelFile::model`].
    pub fn drawn_constants(&self, z: &[f64], file: &str) -> Result<Vec<(String, String, f64)>, Diagnostic> {
        let model = self.drawn_model(z, file)?;
        let named = model.names().into_iter().zip(model.values());
        Ok(named.map(|((name, unit), value)| (name, unit.to_owned(), value)).collect())
    }

    /// Returns the model with constants drawn from their covariance with standard normal variates `z`.
    fn drawn_model(&self, z: &[f64], file: &str) -> Result<Model, Diagnostic> {
        let mut model = self.model(file)?;
        if z.iter().any(|z| *z != 0.0) {
            let covariance = self.covariance();
            let n = covariance.nrows();
            // Eigenvalues rather than a Cholesky factor: confounded constants make the covariance
            // singular.
            let parts = nalgebra::SymmetricEigen::new(covariance);
            for (j, z) in z.iter().take(n).enumerate() {
                let sd = parts.eigenvalues[j].max(0.0).sqrt();
                (0..n).for_each(|i| model.coordinates[i] += parts.eigenvectors[(i, j)] * sd * z);
            }
        }
        Ok(model)
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
            unknown: Unknown::default(),
        }
    }
}
