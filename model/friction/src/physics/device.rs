//! A switch of any layout, from physics: its state at a load, and its curve with a band.

use nalgebra::{Matrix3, Vector3};
use statrs::distribution::{ContinuousCDF, StudentsT};

use super::equilibrium::Supports;
use super::fit::PUBLISHED_FIT;
use super::grid::Grid;
use super::hypotheses::STIFF_N_MM2;
use super::march::{Slide, Sliding, pins_alone_exponent, polygon_turns_rad, slide};
use super::{Bed, Constants, OutsidePins, PhysicsError};
use crate::published;
use crate::trust::EXTRAPOLATED_SPREAD;
use crate::{Contact, Direction, FrictionCurve, Law, Substrate, SwitchState, Trust, capstan_tension_n};

/// Elements over the wrap: sixteen times as many move the friction of the published layouts by less than 0.1 % (a
/// test).
const ELEMENTS: usize = 60;
/// Share of cases that a band should hold.
const CONFIDENCE: f64 = 0.95;
/// Step of a logarithm for the sensitivities.
const STEP: f64 = 1e-3;
/// The most of the wrap that lay outside the outermost pins of a measured layout, a side: three-single.
const WIDEST_FREE_SPAN_RAD: f64 = 0.3495;

/// Contact, bed and constants: all that the friction of a switch depends on.
///
/// ```
/// use pinswitch_friction::physics::{Constants, PhysicsSwitch};
/// use pinswitch_friction::{Contact, PinPattern, Substrate, published};
///
/// let uneven = PinPattern::new(vec![-0.35, 0.0, 0.2]);
/// let contact = Contact::new(Substrate::Silicone, uneven, published::wrap_angle_rad())?;
/// let switch = PhysicsSwitch::new(&contact, Constants::published());
/// let states = switch.states(&[10.0, 50.0])?;
/// assert!(states[0].silicone_share < states[1].silicone_share, "the pins sink as load grows");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct PhysicsSwitch {
    contact: Contact,
    bed: Bed,
    constants: Constants,
    grid: Grid,
}

/// States at the load before, from which the next search starts.
#[derive(Default)]
struct Nearby {
    eccentric: Option<Sliding>,
    concentric: Option<Sliding>,
}

impl PhysicsSwitch {
    /// The switch of `contact` on the bed that the contact carries, with these constants of the published bed.
    pub fn new(contact: &Contact, constants: Constants) -> Self {
        Self::with_elements(contact, *contact.bed(), constants, ELEMENTS)
    }

    /// The same with another bed and another number of elements over the wrap.
    pub fn with_elements(contact: &Contact, bed: Bed, constants: Constants, elements: usize) -> Self {
        let grid = Grid::new(contact.wrap_rad(), contact.pins().angles_rad(), &bed, elements);
        Self { contact: contact.clone(), bed, constants, grid }
    }

    /// The same switch with other constants.
    #[must_use]
    pub fn with_constants(&self, constants: Constants) -> Self {
        Self { constants, ..self.clone() }
    }

    /// States at `loads_n` newtons; ascending loads are fastest.
    ///
    /// # Errors
    /// [`PhysicsError`] if a load's equilibrium is not found.
    pub fn states(&self, loads_n: &[f64]) -> Result<Vec<SwitchState>, PhysicsError> {
        Ok(self.points(loads_n)?.iter().map(|p| p.state).collect())
    }

    /// Friction at one load in newtons.
    ///
    /// # Errors
    /// [`PhysicsError`] if the equilibrium is not found.
    pub fn friction_n(&self, load_n: f64) -> Result<f64, PhysicsError> {
        self.point_from(load_n, &mut Nearby::default()).map(|p| p.state.friction_n)
    }

    /// The loaded tendon sliding in one direction.
    pub(super) fn sliding(
        &self,
        load_n: f64,
        direction: Direction,
        start: Option<&Sliding>,
    ) -> Result<Sliding, PhysicsError> {
        let flush_force_n = self.constants.flush_force_n * self.bed.flush_force_ratio();
        let supports = Supports { grid: &self.grid, bed: &self.bed, flush_force_n };
        let (constants, wrap_rad) = (&self.constants, self.contact.wrap_rad());
        slide(Slide { supports, constants, wrap_rad, load_n, direction }, start)
    }

    /// Angles between which the silicone can touch.
    pub(super) fn silicone_rad(&self) -> (f64, f64) {
        let touched = || self.grid.angle_rad.iter().zip(&self.grid.silicone_mm).filter(|(_, w)| **w > 0.0);
        let angle = |node: Option<(&f64, &f64)>| node.map_or(0.0, |(angle, _)| *angle);
        (angle(touched().next()), angle(touched().next_back()))
    }

    pub(super) fn angles_rad(&self) -> &[f64] {
        &self.grid.angle_rad
    }

    /// Exponents of pins and silicone in a direction, and the state for the next load.
    fn exponents(
        &self,
        load_n: f64,
        direction: Direction,
        start: &mut Option<Sliding>,
    ) -> Result<Exponent, PhysicsError> {
        let pins = self.contact.pins().angles_rad();
        if self.contact.substrate() == Substrate::Abs {
            let turns = polygon_turns_rad(pins, self.contact.wrap_rad());
            let kappa = self.constants.kappa_per_sqrt_n * self.bed.ploughing_ratio();
            let pins = pins_alone_exponent(&turns, kappa, load_n, direction);
            return Ok(Exponent { pins, silicone: 0.0 });
        }
        if pins.is_empty() || load_n <= 0.0 {
            return Ok(Exponent {
                pins: 0.0,
                silicone: self.constants.mu_silicone * self.contact.wrap_rad(),
            });
        }
        let sliding = self.sliding(load_n, direction, start.as_ref())?;
        let exponent = Exponent { pins: sliding.pins_exponent, silicone: sliding.silicone_exponent };
        *start = Some(sliding);
        Ok(exponent)
    }

    fn point_from(&self, load_n: f64, nearby: &mut Nearby) -> Result<Point, PhysicsError> {
        let eccentric = self.exponents(load_n, Direction::Eccentric, &mut nearby.eccentric)?;
        let concentric = self.exponents(load_n, Direction::Concentric, &mut nearby.concentric)?;
        let total = |x: Exponent| x.pins + x.silicone;
        let eccentric_n = capstan_tension_n(load_n, total(eccentric), Direction::Eccentric);
        let concentric_n = capstan_tension_n(load_n, total(concentric), Direction::Concentric);
        let both = total(eccentric) + total(concentric);
        let shared = load_n > 0.0 && both > 0.0;
        let state = SwitchState {
            load_n,
            eccentric_n,
            concentric_n,
            friction_n: (concentric_n - eccentric_n) / 2.0,
            silicone_share: if shared { (eccentric.silicone + concentric.silicone) / both } else { 0.0 },
        };
        Ok(Point { state, eccentric, concentric })
    }

    fn points(&self, loads_n: &[f64]) -> Result<Vec<Point>, PhysicsError> {
        let mut nearby = Nearby::default();
        loads_n.iter().map(|load| self.point_from(*load, &mut nearby)).collect()
    }

    /// Sensitivities of `ln D` to the logarithms of the constants, load by load; zero where there is no friction. The
    /// exponents are proportional to `kappa` and `mu_s` but for the feedback of tension on shape, which is left out;
    /// the flush force moves the shape, and takes a second curve.
    fn sensitivities(&self, loads_n: &[f64], points: &[Point]) -> Result<Vec<Vector3<f64>>, PhysicsError> {
        let mut at = self.constants.logarithms();
        at[2] += STEP;
        let stiffer = match self.contact.substrate() {
            Substrate::Silicone => self.with_constants(Constants::from_logarithms(&at)).points(loads_n)?,
            Substrate::Abs => points.to_vec(),
        };
        Ok(points
            .iter()
            .zip(&stiffer)
            .map(|(point, stiffer)| {
                let d = point.state.friction_n;
                if d > 0.0 {
                    Vector3::new(
                        point.friction_per_exponent(|x| x.pins) / d,
                        point.friction_per_exponent(|x| x.silicone) / d,
                        (stiffer.state.friction_n / d).ln() / STEP,
                    )
                } else {
                    Vector3::zeros()
                }
            })
            .collect())
    }
}

/// Parts of a friction exponent, `ln(T/F)` without its sign.
#[derive(Clone, Copy, Debug)]
struct Exponent {
    pins: f64,
    silicone: f64,
}

/// A state with the exponents of both directions.
#[derive(Clone, Copy, Debug)]
struct Point {
    state: SwitchState,
    eccentric: Exponent,
    concentric: Exponent,
}

impl Point {
    /// `dD` for a relative change of this part of the exponent: `(F_e x_e + F_c x_c)/2`.
    fn friction_per_exponent(&self, part: impl Fn(&Exponent) -> f64) -> f64 {
        (self.state.eccentric_n * part(&self.eccentric) + self.state.concentric_n * part(&self.concentric))
            / 2.0
    }
}

/// The curve of `contact` from physics, with constants fitted to the published maxima. The band holds the constants'
/// covariance and the model's own error: for a published condition the scatter of the fit, for any other the error of
/// layouts left out.
///
/// # Errors
/// [`PhysicsError`] if a load's equilibrium is not found.
pub fn physics_curve(contact: &Contact, loads_n: &[f64]) -> Result<FrictionCurve, PhysicsError> {
    let fit = &PUBLISHED_FIT;
    let switch = PhysicsSwitch::new(contact, fit.constants());
    let points = switch.points(loads_n)?;
    let slopes = switch.sensitivities(loads_n, &points)?;
    let states: Vec<SwitchState> = points.iter().map(|p| p.state).collect();
    let (trust, mut reasons) = crate::trust::trust(contact);
    let own = if trust == Trust::Published { fit.scatter } else { fit.left_out_rms };
    // Outside what was measured every law is a guess to 40 % (`model/doc/friction-laws.md`): how stiffness and
    // ploughing follow the materials is assumed, and no measured layout comes near.
    let guess = if trust == Trust::Extrapolated { (1.0 + EXTRAPOLATED_SPREAD).ln() } else { 0.0 };
    let covariance = Matrix3::from_row_slice(&fit.covariance.concat());
    let quantile =
        StudentsT::new(0.0, 1.0, fit.freedom).map_or(2.78, |t| t.inverse_cdf(0.5 + CONFIDENCE / 2.0));
    let half: Vec<f64> = slopes
        .iter()
        .map(|g| {
            (quantile.powi(2) * ((g.transpose() * covariance * g)[(0, 0)] + own * own) + guess * guess).sqrt()
        })
        .collect();
    let mut band_low_n: Vec<f64> = states.iter().zip(&half).map(|(s, h)| s.friction_n * (-h).exp()).collect();
    let mut band_high_n: Vec<f64> = states.iter().zip(&half).map(|(s, h)| s.friction_n * h.exp()).collect();
    if let Some(outside) = open_span_rad(contact) {
        // The rival that contradicts one fact only, see `hypotheses`.
        let on_silicone = Bed {
            outside: OutsidePins::OnSilicone,
            softening: 0.0,
            bending_n_mm2: STIFF_N_MM2,
            ..*contact.bed()
        };
        let rival =
            PhysicsSwitch::with_elements(contact, on_silicone, fit.constants(), ELEMENTS).states(loads_n)?;
        for (i, state) in rival.iter().enumerate() {
            band_low_n[i] = band_low_n[i].min(state.friction_n * (-half[i]).exp());
            band_high_n[i] = band_high_n[i].max(state.friction_n * half[i].exp());
        }
        reasons.push(format!(
            "{:.1} deg of the wrap lie outside the outermost pin, more than in any measured layout; whether the tendon \
             touches silicone there is open, and the band covers both",
            outside.to_degrees()
        ));
    }
    reasons.extend(unexplained(contact));
    let column = |f: fn(&SwitchState) -> f64| states.iter().map(f).collect::<Vec<_>>();
    Ok(FrictionCurve {
        law: Law::Physics,
        trust,
        reasons,
        load_n: column(|s| s.load_n),
        eccentric_n: column(|s| s.eccentric_n),
        concentric_n: column(|s| s.concentric_n),
        friction_n: column(|s| s.friction_n),
        band_low_n,
        band_high_n,
        silicone_share: column(|s| s.silicone_share),
    })
}

/// The widest span between an end of the wrap and the outermost pin, if no measured layout had one as wide.
fn open_span_rad(contact: &Contact) -> Option<f64> {
    if contact.substrate() == Substrate::Abs {
        return None;
    }
    let (first, last) = (contact.pins().angles_rad().first()?, contact.pins().angles_rad().last()?);
    let half = contact.wrap_rad() / 2.0;
    let outside = (first + half).max(half - last);
    (outside > WIDEST_FREE_SPAN_RAD).then_some(outside)
}

/// What the physics is known not to explain of a published condition.
fn unexplained(contact: &Contact) -> Option<String> {
    let layout = contact.published_layout().filter(|_| contact.substrate() == Substrate::Silicone)?;
    let wrap = published::wrap_angle_rad();
    (contact.departures().is_empty() && layout.pins == 3 && (contact.wrap_rad() - wrap).abs() < 1e-6).then(|| {
        format!(
            "physics gives three-double and three-single nearly the same maximum; {:.2} and {:.2} N were measured",
            published::LAYOUTS[1].device_max_n,
            published::LAYOUTS[2].device_max_n
        )
    })
}
