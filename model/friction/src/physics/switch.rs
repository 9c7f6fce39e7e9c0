//! States of a switch with any layout, by the physics, and their sensitivities to the constants.

use nalgebra::Vector4;

use super::constants::Constants;
use super::coupled::{Exponents, MAX_PASSES, Workspace};
use super::equilibrium::Supports;
use super::error::PhysicsError;
use super::grid::{self, Grid};
use super::made::MadeDimensions;
use super::march::{Slide, Sliding, pins_alone_exponent, pins_alone_slope, polygon_turns_rad, slide};
use super::pair::Pair;
use crate::bed::Bed;
use crate::capstan::{Direction, capstan_tension_n};
use crate::contact::{Contact, ContactError};
use crate::pattern::PinPattern;
use crate::substrate::Substrate;
use crate::switch::SwitchState;

/// Derivatives of `ln D` with respect to the logarithms of `kappa`, `mu_s`, `N0` and the foundation stiffness. The last two
/// are proportional to the modulus of the silicone.
pub type Sensitivities = Vector4<f64>;

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
    elements: usize,
    grid: Grid,
    /// Deviation of the height of each pin, mm; empty if all pins are nominal.
    heights_mm: Vec<f64>,
    /// The same of the pins of the grid.
    reached_heights_mm: Vec<f64>,
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
        Self {
            contact: contact.clone(),
            bed,
            constants,
            elements,
            grid,
            heights_mm: Vec::new(),
            reached_heights_mm: Vec::new(),
        }
    }

    /// Returns the same switch as it was made, on as many nodes, so that friction is smooth in the
    /// dimensions.
    ///
    /// # Errors
    /// [`ContactError`] if the wrap is invalid.
    pub fn made(&self, dimensions: &MadeDimensions) -> Result<Self, ContactError> {
        let MadeDimensions { wrap_rad, bed, pin_angles_rad, pin_heights_mm } = dimensions;
        let mut pins: Vec<(f64, f64)> =
            pin_angles_rad.iter().copied().zip(pin_heights_mm.iter().copied()).collect();
        pins.sort_by(|a, b| a.0.total_cmp(&b.0));
        let angles_rad: Vec<f64> = pins.iter().map(|(angle, _)| *angle).collect();
        let grid = self
            .grid
            .moved(*wrap_rad, &angles_rad, bed, self.elements)
            .unwrap_or_else(|| Grid::new(*wrap_rad, &angles_rad, bed, self.elements));
        let end = wrap_rad / 2.0 + grid.reach_rad;
        let contact = Contact::new(self.contact.substrate(), PinPattern::new(angles_rad), *wrap_rad)?;
        Ok(Self {
            contact: contact.with_bed(*bed),
            bed: *bed,
            constants: self.constants,
            elements: self.elements,
            grid,
            reached_heights_mm: pins.iter().filter(|(angle, _)| angle.abs() < end).map(|p| p.1).collect(),
            heights_mm: pins.iter().map(|(_, height)| *height).collect(),
        })
    }

    /// Returns the dimensions of the switch.
    pub(super) fn dimensions(&self) -> MadeDimensions {
        let nominal = MadeDimensions::nominal(&self.contact);
        let pin_heights_mm =
            if self.heights_mm.is_empty() { nominal.pin_heights_mm } else { self.heights_mm.clone() };
        MadeDimensions { bed: self.bed, pin_heights_mm, ..nominal }
    }

    /// Returns the contact.
    pub(super) fn contact(&self) -> &Contact {
        &self.contact
    }

    /// Returns the constants for the published bed.
    pub(super) fn constants(&self) -> &Constants {
        &self.constants
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
        let mut workspace = self.workspace();
        loads_n.iter().map(|load| Ok(self.state_from(*load, workspace.as_mut())?.0)).collect()
    }

    /// Computes the friction at one load, in newtons.
    ///
    /// # Errors
    /// [`PhysicsError`] if the model does not converge.
    pub fn friction_n(&self, load_n: f64) -> Result<f64, PhysicsError> {
        Ok(self.state_from(load_n, self.workspace().as_mut())?.0.friction_n)
    }

    /// Computes the state of the tendon that slides in one direction.
    pub(super) fn sliding(
        &self,
        load_n: f64,
        direction: Direction,
        start: Option<&Sliding>,
    ) -> Result<Sliding, PhysicsError> {
        let (supports, constants, wrap_rad) = (self.supports(), &self.constants, self.contact.wrap_rad());
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

    /// Returns the supports of the tendon.
    pub(super) fn supports(&self) -> Supports<'_> {
        let flush_force_n = self.constants.flush_force_n * self.bed.flush_force_ratio();
        Supports { grid: &self.grid, bed: &self.bed, flush_force_n, heights_mm: &self.reached_heights_mm }
    }

    /// Returns the arrays for the loads of a curve; `None` if its friction has a closed form.
    pub(super) fn workspace(&self) -> Option<Workspace> {
        let is_rigid = self.contact.substrate() == Substrate::Abs;
        let is_bare = self.contact.all_pins().angles_rad().is_empty();
        (!is_rigid && !is_bare).then(|| Workspace::new(&self.supports()))
    }

    /// Computes the friction at one load with this relative error of the exponents.
    #[cfg(test)]
    pub(super) fn precise_friction_n(&self, load_n: f64, exponent_error: f64) -> Result<f64, PhysicsError> {
        let mut workspace = self.workspace();
        workspace.iter_mut().for_each(|workspace| workspace.exponent_error = exponent_error);
        Ok(self.state_from(load_n, workspace.as_mut())?.0.friction_n)
    }

    /// Computes the friction exponents at a load, from the states at the loads before.
    fn exponents(&self, load_n: f64, workspace: Option<&mut Workspace>) -> Result<Exponents, PhysicsError> {
        let wrap_rad = self.contact.wrap_rad();
        if self.contact.substrate() == Substrate::Abs {
            let turns = polygon_turns_rad(self.contact.all_pins().angles_rad(), wrap_rad);
            let kappa = self.constants.kappa_per_sqrt_n * self.bed.ploughing_ratio();
            let pins = DIRECTIONS.map(|direction| pins_alone_exponent(&turns, kappa, load_n, direction));
            return Ok(Exponents { pins: Pair::new(pins), silicone: Pair::both(0.0) });
        }
        let Some(workspace) = workspace.filter(|_| load_n > 0.0) else {
            let silicone = Pair::both(self.constants.mu_silicone * wrap_rad);
            return Ok(Exponents { pins: Pair::both(0.0), silicone });
        };
        if let Some(exponents) = workspace.follow(&self.supports(), &self.constants, wrap_rad, load_n) {
            return Ok(exponents);
        }
        let eccentric = self.sliding(load_n, Direction::Eccentric, None)?;
        let concentric = self.sliding(load_n, Direction::Concentric, None)?;
        workspace.accept(
            load_n,
            [&eccentric.shape.gap_mm, &concentric.shape.gap_mm],
            [&eccentric.tension_n, &concentric.tension_n],
        );
        Ok(Exponents {
            pins: Pair::new([eccentric.pins_exponent, concentric.pins_exponent]),
            silicone: Pair::new([eccentric.silicone_exponent, concentric.silicone_exponent]),
        })
    }

    /// Computes the state at one load, from those at the loads before.
    pub(super) fn state_from(
        &self,
        load_n: f64,
        workspace: Option<&mut Workspace>,
    ) -> Result<(SwitchState, Exponents), PhysicsError> {
        let exponents = self.exponents(load_n, workspace)?;
        let total = exponents.pins + exponents.silicone;
        let eccentric_n = capstan_tension_n(load_n, total.lane(0), Direction::Eccentric);
        let concentric_n = capstan_tension_n(load_n, total.lane(1), Direction::Concentric);
        let both = total.lane(0) + total.lane(1);
        let shared = load_n > 0.0 && both > 0.0;
        let silicone = exponents.silicone.lane(0) + exponents.silicone.lane(1);
        let state = SwitchState {
            load_n,
            eccentric_n,
            concentric_n,
            friction_n: (concentric_n - eccentric_n) / 2.0,
            silicone_share: if shared { silicone / both } else { 0.0 },
        };
        Ok((state, exponents))
    }

    /// Computes the states at `loads_n` newtons, and the [`Sensitivities`] at the loads for which `is_needed` is true; the others are zero.
    /// Ascending loads are fastest.
    ///
    /// A derivative is zero without friction.
    ///
    /// # Errors
    /// [`PhysicsError`] if the model does not converge at a load.
    pub fn states_and_sensitivities(
        &self,
        loads_n: &[f64],
        is_needed: impl Fn(usize) -> bool,
    ) -> Result<(Vec<SwitchState>, Vec<Sensitivities>), PhysicsError> {
        let mut workspace = self.workspace();
        let mut states = Vec::with_capacity(loads_n.len());
        let mut sensitivities = Vec::with_capacity(loads_n.len());
        for (i, load_n) in loads_n.iter().enumerate() {
            let (state, exponents) = self.state_from(*load_n, workspace.as_mut())?;
            states.push(state);
            sensitivities.push(if is_needed(i) && state.friction_n > 0.0 {
                self.sensitivities(&state, &exponents, workspace.as_mut())?
            } else {
                Sensitivities::zeros()
            });
        }
        Ok((states, sensitivities))
    }

    /// Computes the derivatives of `ln D` at the last state.
    fn sensitivities(
        &self,
        state: &SwitchState,
        exponents: &Exponents,
        workspace: Option<&mut Workspace>,
    ) -> Result<Sensitivities, PhysicsError> {
        let wrap_rad = self.contact.wrap_rad();
        let of_exponents = match workspace.filter(|_| state.load_n > 0.0) {
            Some(workspace) => workspace
                .derivatives(&self.supports(), &self.constants, wrap_rad)
                .ok_or(PhysicsError::TensionNotConverged { load_n: state.load_n, iterations: MAX_PASSES })?,
            None if self.contact.substrate() == Substrate::Abs => {
                let turns = polygon_turns_rad(self.contact.all_pins().angles_rad(), wrap_rad);
                let kappa = self.constants.kappa_per_sqrt_n * self.bed.ploughing_ratio();
                let slope = |direction| pins_alone_slope(&turns, kappa, state.load_n, direction);
                [Pair::new(DIRECTIONS.map(slope)), Pair::both(0.0), Pair::both(0.0), Pair::both(0.0)]
            }
            None => [Pair::both(0.0), exponents.silicone, Pair::both(0.0), Pair::both(0.0)],
        };
        let tension = Pair::new([state.eccentric_n, state.concentric_n]);
        let of_friction = of_exponents.map(|by| {
            let [eccentric, concentric] = (tension * by).numbers();
            (eccentric + concentric) / 2.0 / state.friction_n
        });
        Ok(Sensitivities::from(of_friction))
    }
}

/// Both directions of motion, in the order of a [`Pair`].
const DIRECTIONS: [Direction; 2] = [Direction::Eccentric, Direction::Concentric];
