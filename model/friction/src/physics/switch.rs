//! States of a switch with any layout, by the physics, and their sensitivities to the constants.

use nalgebra::Vector3;

use super::constants::Constants;
use super::equilibrium::Supports;
use super::error::PhysicsError;
use super::grid::{self, Grid};
use super::march::{Slide, Sliding, pins_alone_exponent, polygon_turns_rad, slide};
use crate::bed::Bed;
use crate::capstan::{Direction, capstan_tension_n};
use crate::contact::Contact;
use crate::substrate::Substrate;
use crate::switch::SwitchState;

/// Step of a logarithm for finite differences.
const STEP: f64 = 1e-3;

/// Switch whose friction follows from its contact, bed and material constants.
///
/// ```
/// use pinswitch_friction::physics::{Constants, PhysicsSwitch};
/// use pinswitch_friction::{Contact, PinPattern, Substrate, published};
///
/// let uneven = PinPattern::new(vec![-0.35, 0.0, 0.2]);
/// let contact = Contact::new(Substrate::Silicone, uneven, published::wrap_angle_rad())?;
/// let switch = PhysicsSwitch::new(&contact, Constants::published());
/// let states = switch.states(&[10.0, 50.0])?;
/// assert!(states[0].silicone_share < states[1].silicone_share, "the pins sink as the load grows");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct PhysicsSwitch {
    contact: Contact,
    bed: Bed,
    constants: Constants,
    grid: Grid,
}

/// States at the previous load, from which the next iteration starts.
#[derive(Default)]
struct PreviousStates {
    eccentric: Option<Sliding>,
    concentric: Option<Sliding>,
}

impl PhysicsSwitch {
    /// Creates the switch of `contact` on its bed, with these constants for the published bed.
    pub fn new(contact: &Contact, constants: Constants) -> Self {
        let bed = *contact.bed();
        Self::with_elements(contact, bed, constants, grid::elements(contact.wrap_rad(), &bed))
    }

    /// Creates the switch with another bed and another number of elements over the wrap.
    pub fn with_elements(contact: &Contact, bed: Bed, constants: Constants, elements: usize) -> Self {
        let grid = Grid::new(contact.wrap_rad(), contact.all_pins().angles_rad(), &bed, elements);
        Self { contact: contact.clone(), bed, constants, grid }
    }

    /// Returns the same switch with other constants.
    #[must_use]
    pub fn with_constants(&self, constants: Constants) -> Self {
        Self { constants, ..self.clone() }
    }

    /// Computes the states at `loads_n` newtons; ascending loads are fastest.
    ///
    /// # Errors
    /// [`PhysicsError`] if the model does not converge at a load.
    pub fn states(&self, loads_n: &[f64]) -> Result<Vec<SwitchState>, PhysicsError> {
        Ok(self.points(loads_n)?.iter().map(|p| p.state).collect())
    }

    /// Computes the friction at one load, in newtons.
    ///
    /// # Errors
    /// [`PhysicsError`] if the model does not converge.
    pub fn friction_n(&self, load_n: f64) -> Result<f64, PhysicsError> {
        self.point_from(load_n, &mut PreviousStates::default()).map(|p| p.state.friction_n)
    }

    /// Computes the state of the tendon that slides in one direction.
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

    /// Returns the first and the last angle at which silicone can touch the tendon, in radians.
    pub(super) fn silicone_rad(&self) -> (f64, f64) {
        let nodes = || self.grid.angle_rad.iter().zip(&self.grid.silicone_mm).filter(|(_, w)| **w > 0.0);
        let angle = |node: Option<(&f64, &f64)>| node.map_or(0.0, |(angle, _)| *angle);
        (angle(nodes().next()), angle(nodes().next_back()))
    }

    /// Returns the angles of the pins that the tendon can touch, in radians.
    pub(super) fn pins_rad(&self) -> Vec<f64> {
        self.grid.pins.iter().map(|node| self.grid.angle_rad[*node]).collect()
    }

    /// Returns the angles of the nodes, in radians.
    pub(super) fn angles_rad(&self) -> &[f64] {
        &self.grid.angle_rad
    }

    /// Computes the friction exponents of pins and silicone in a direction, and updates the state
    /// for the next load.
    fn exponents(
        &self,
        load_n: f64,
        direction: Direction,
        start: &mut Option<Sliding>,
    ) -> Result<Exponent, PhysicsError> {
        let pins = self.contact.all_pins().angles_rad();
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

    /// Computes the state at one load, starting from that at the previous load.
    fn point_from(&self, load_n: f64, previous: &mut PreviousStates) -> Result<Point, PhysicsError> {
        let eccentric = self.exponents(load_n, Direction::Eccentric, &mut previous.eccentric)?;
        let concentric = self.exponents(load_n, Direction::Concentric, &mut previous.concentric)?;
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

    /// Computes the states at several loads, each starting from the previous one.
    fn points(&self, loads_n: &[f64]) -> Result<Vec<Point>, PhysicsError> {
        let mut previous = PreviousStates::default();
        loads_n.iter().map(|load| self.point_from(*load, &mut previous)).collect()
    }

    /// Computes friction at `loads_n` newtons, and the sensitivities of `ln D` to the logarithms of
    /// the constants.
    ///
    /// A sensitivity is zero without friction. The exponents are proportional to `kappa` and
    /// `mu_s`; the feedback of the tension on the shape is neglected. The flush force changes the
    /// shape, and needs a second curve.
    pub(crate) fn friction_and_sensitivities(
        &self,
        loads_n: &[f64],
    ) -> Result<(Vec<f64>, Vec<Vector3<f64>>), PhysicsError> {
        let points = self.points(loads_n)?;
        let mut at = self.constants.logarithms();
        at[2] += STEP;
        let stiffer = match self.contact.substrate() {
            Substrate::Silicone => self.with_constants(Constants::from_logarithms(&at)).points(loads_n)?,
            Substrate::Abs => points.clone(),
        };
        let sensitivities = points
            .iter()
            .zip(&stiffer)
            .map(|(point, stiffer)| {
                let d = point.state.friction_n;
                if d > 0.0 {
                    Vector3::new(
                        point.friction_per_exponent(|x| x.pins) / d,
                        point.friction_per_exponent(|x| x.silicone) / d,
                        libm::log(stiffer.state.friction_n / d) / STEP,
                    )
                } else {
                    Vector3::zeros()
                }
            })
            .collect();
        Ok((points.iter().map(|p| p.state.friction_n).collect(), sensitivities))
    }
}

/// Parts of a friction exponent `|ln(T/F)|`.
#[derive(Clone, Copy, Debug)]
struct Exponent {
    pins: f64,
    silicone: f64,
}

/// State with the exponents of both directions.
#[derive(Clone, Copy, Debug)]
struct Point {
    state: SwitchState,
    eccentric: Exponent,
    concentric: Exponent,
}

impl Point {
    /// Returns the derivative of `D` with respect to a relative change of this part of the
    /// exponents: `(T_e x_e + T_c x_c)/2`.
    fn friction_per_exponent(&self, part: impl Fn(&Exponent) -> f64) -> f64 {
        (self.state.eccentric_n * part(&self.eccentric) + self.state.concentric_n * part(&self.concentric))
            / 2.0
    }
}
