//! A two-link finger with a switch at its joint, for MuJoCo and as URDF.

use pinswitch_diagnostic::{Diagnostic, Location, codes};
use pinswitch_friction::published::GRAVITY_M_S2;
use serde::Serialize;

use crate::surface::Surface;

/// A finger of two links. The proximal link is fixed; the tendon runs over the switch at the joint and flexes the
/// distal link, which gravity extends.
///
/// The paper shows such a finger and prints no dimension of it: every default is assumed. A set with a joint has the
/// dimensions of its parts.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Finger {
    /// Length of the proximal link, mm.
    pub proximal_mm: f64,
    /// Length of the distal link, mm.
    pub distal_mm: f64,
    /// Thickness of both links, mm.
    pub thickness_mm: f64,
    /// Mass of the distal link, g.
    pub distal_mass_g: f64,
    /// Mass at the fingertip, g.
    pub payload_g: f64,
    /// Moment arm of the tendon at the joint, mm: the radius of the switch at the middle of the tendon.
    pub moment_arm_mm: f64,
    /// Least and largest flexion, degrees.
    pub flexion_deg: [f64; 2],
    /// Wrap of the tendon on the switch at these flexions, degrees. Between them it is linear.
    pub wrap_deg: [f64; 2],
}

impl Default for Finger {
    fn default() -> Self {
        Self {
            proximal_mm: 60.0,
            distal_mm: 50.0,
            thickness_mm: 14.0,
            distal_mass_g: 40.0,
            payload_g: 500.0,
            moment_arm_mm: 22.0,
            flexion_deg: [0.0, 89.0],
            wrap_deg: [0.0, 89.0],
        }
    }
}

impl Finger {
    /// Checks every value.
    ///
    /// # Errors
    /// A [`Diagnostic`] of the first value out of its range.
    pub fn check(&self) -> Result<(), Diagnostic> {
        let values = [
            ("proximal_mm", self.proximal_mm, 1.0, 1000.0),
            ("distal_mm", self.distal_mm, 1.0, 1000.0),
            ("thickness_mm", self.thickness_mm, 1.0, 200.0),
            ("distal_mass_g", self.distal_mass_g, 0.1, 100_000.0),
            ("payload_g", self.payload_g, 0.0, 1_000_000.0),
            ("moment_arm_mm", self.moment_arm_mm, 1.0, 200.0),
            ("flexion_deg", self.flexion_deg[0], 0.0, 179.0),
            ("flexion_deg", self.flexion_deg[1], self.flexion_deg[0] + 1.0, 180.0),
            ("wrap_deg", self.wrap_deg[0], 0.0, 540.0),
            ("wrap_deg", self.wrap_deg[1], self.wrap_deg[0], 540.0),
        ];
        match values.iter().find(|(_, value, low, high)| !(low..=high).contains(&value)) {
            None => Ok(()),
            Some((field, value, low, high)) => {
                Err(Diagnostic::new(codes::OUT_OF_RANGE, format!("outside {low} to {high}"))
                    .with_location(Location::field(*field, value.to_string()))
                    .with_help(format!("give a number from {low} to {high}")))
            }
        }
    }

    /// Returns the increase of the wrap per flexion.
    fn wrap_per_flexion(&self) -> f64 {
        (self.wrap_deg[1] - self.wrap_deg[0]) / (self.flexion_deg[1] - self.flexion_deg[0])
    }

    /// Returns the wrap angle at a flexion, both in degrees.
    pub fn wrap_deg_at(&self, flexion_deg: f64) -> f64 {
        self.wrap_deg[0] + self.wrap_per_flexion() * (flexion_deg - self.flexion_deg[0])
    }

    /// Returns the tension that keeps the finger straight without friction, N: the largest of the payload.
    fn heaviest_tension_n(&self) -> f64 {
        let moment_g_mm = self.distal_mass_g * self.distal_mm / 2.0 + self.payload_g * self.distal_mm;
        moment_g_mm * 1e-3 * GRAVITY_M_S2 / self.moment_arm_mm
    }

    /// Returns the MuJoCo model. `surface_file` is the name of the table of the switch, for the host.
    ///
    /// The tendon has a constant moment arm; its actuator pulls with `ctrl` newtons. MuJoCo itself adds no friction.
    ///
    /// # Errors
    /// As [`Self::check`].
    pub fn mjcf(&self, surface: &Surface, surface_file: &str) -> Result<String, Diagnostic> {
        self.check()?;
        let metres = |mm: f64| format!("{:.6}", mm * 1e-3);
        let kilograms = |g: f64| format!("{:.6}", g * 1e-3);
        let (proximal, distal) = (metres(self.proximal_mm), metres(self.distal_mm));
        let (half, arm) = (metres(self.thickness_mm / 2.0), metres(self.moment_arm_mm));
        let most_n =
            (4.0 * self.heaviest_tension_n()).max(1.25 * surface.load_n().last().copied().unwrap_or(1.0));
        let payload = if self.payload_g > 0.0 {
            format!(
                "        <geom name=\"payload\" type=\"sphere\" pos=\"{distal} 0 0\" size=\"0.012\" mass=\"{}\" rgba=\"0.2 0.4 0.8 1\"/>\n",
                kilograms(self.payload_g)
            )
        } else {
            String::new()
        };
        Ok(format!(
            "<mujoco model=\"{name} finger\">
  <!-- A finger with a friction switch at its joint. The friction is added by a host: pinswitch.mujoco reads the
       numbers below and the table. Dimensions in m, masses in kg; the paper prints no dimension of its finger. -->
  <option timestep=\"0.001\" gravity=\"0 0 -{GRAVITY_M_S2}\"/>
  <custom>
    <text name=\"pinswitch.flexor\" data=\"{file}\"/>
    <numeric name=\"pinswitch.flexor.wrap\" data=\"{start:.9} {slope:.9}\"/>
  </custom>
  <worldbody>
    <light pos=\"0 -0.3 0.5\" dir=\"0 0.5 -1\"/>
    <camera name=\"side\" pos=\"{proximal} -0.3 0.02\" xyaxes=\"1 0 0 0 0 1\"/>
    <body name=\"proximal\">
      <geom type=\"capsule\" fromto=\"0 0 0 {proximal} 0 0\" size=\"{half}\" mass=\"0.05\" rgba=\"0.7 0.7 0.7 1\" contype=\"0\" conaffinity=\"0\"/>
      <geom name=\"switch\" type=\"cylinder\" pos=\"{proximal} 0 0\" euler=\"90 0 0\" size=\"{arm} {half}\" mass=\"0.01\" rgba=\"0.9 0.7 0.2 0.5\" contype=\"0\" conaffinity=\"0\"/>
      <body name=\"distal\" pos=\"{proximal} 0 0\">
        <joint name=\"flexion\" type=\"hinge\" axis=\"0 -1 0\" range=\"{low} {high}\" limited=\"true\"/>
        <geom type=\"capsule\" fromto=\"0 0 0 {distal} 0 0\" size=\"{half}\" mass=\"{mass}\" rgba=\"0.5 0.5 0.5 1\" contype=\"0\" conaffinity=\"0\"/>
{payload}        <site name=\"tip\" pos=\"{distal} 0 0\" size=\"0.003\"/>
      </body>
    </body>
  </worldbody>
  <tendon>
    <fixed name=\"flexor\">
      <joint joint=\"flexion\" coef=\"-{arm}\"/>
    </fixed>
  </tendon>
  <actuator>
    <!-- ctrl is the tension of the motor in N. -->
    <motor name=\"motor\" tendon=\"flexor\" gear=\"-1\" ctrllimited=\"true\" ctrlrange=\"0 {most_n:.3}\"/>
  </actuator>
  <sensor>
    <tendonpos name=\"length\" tendon=\"flexor\"/>
    <jointpos name=\"angle\" joint=\"flexion\"/>
  </sensor>
</mujoco>
",
            name = escaped(surface.name()),
            file = escaped(surface_file),
            start = self.wrap_deg_at(0.0).to_radians(),
            slope = self.wrap_per_flexion() / (self.moment_arm_mm * 1e-3),
            low = self.flexion_deg[0],
            high = self.flexion_deg[1],
            mass = kilograms(self.distal_mass_g),
        ))
    }

    /// Returns the URDF. URDF has no tendons: the joint is a revolute joint, and a comment names the table.
    ///
    /// # Errors
    /// As [`Self::check`].
    pub fn urdf(&self, surface: &Surface, surface_file: &str) -> Result<String, Diagnostic> {
        self.check()?;
        let link = |name: &str, length_mm: f64, mass_g: f64, tip_g: f64| {
            let (length, half) = (length_mm * 1e-3, self.thickness_mm * 1e-3);
            let (rod, tip) = (mass_g * 1e-3, tip_g * 1e-3);
            let mass = rod + tip;
            let centre = (rod * length / 2.0 + tip * length) / mass;
            let along = rod * half * half / 6.0;
            // A rod about its middle, moved to the common centre, and a point.
            let across = rod * length * length / 12.0
                + rod * (centre - length / 2.0) * (centre - length / 2.0)
                + tip * (length - centre) * (length - centre);
            format!(
                "  <link name=\"{name}\">
    <inertial>
      <origin xyz=\"{centre:.6} 0 0\"/>
      <mass value=\"{mass:.6}\"/>
      <inertia ixx=\"{along:.3e}\" iyy=\"{across:.6e}\" izz=\"{across:.6e}\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/>
    </inertial>
    <visual>
      <origin xyz=\"{middle:.6} 0 0\"/>
      <geometry><box size=\"{length:.6} {half:.6} {half:.6}\"/></geometry>
    </visual>
  </link>
",
                middle = length / 2.0,
            )
        };
        let effort = 4.0 * self.heaviest_tension_n() * self.moment_arm_mm * 1e-3;
        Ok(format!(
            "<?xml version=\"1.0\"?>
<!-- A finger with a friction switch at its joint: torque of the joint = {arm:.6} m times the tension after the switch.
     URDF has neither tendons nor friction that depends on load and direction; {file} has the tensions. -->
<robot name=\"{name}\">
{proximal}{distal}  <joint name=\"flexion\" type=\"revolute\">
    <parent link=\"proximal\"/>
    <child link=\"distal\"/>
    <origin xyz=\"{length:.6} 0 0\"/>
    <axis xyz=\"0 -1 0\"/>
    <limit lower=\"{lower:.6}\" upper=\"{upper:.6}\" effort=\"{effort:.6}\" velocity=\"20\"/>
  </joint>
  <transmission name=\"flexor\">
    <type>transmission_interface/SimpleTransmission</type>
    <joint name=\"flexion\"><hardwareInterface>hardware_interface/EffortJointInterface</hardwareInterface></joint>
    <actuator name=\"motor\"><mechanicalReduction>{arm:.6}</mechanicalReduction></actuator>
  </transmission>
</robot>
",
            name = escaped(surface.name()),
            file = escaped(surface_file),
            proximal = link("proximal", self.proximal_mm, self.distal_mass_g, 0.0),
            distal = link("distal", self.distal_mm, self.distal_mass_g, self.payload_g),
            length = self.proximal_mm * 1e-3,
            lower = self.flexion_deg[0].to_radians(),
            upper = self.flexion_deg[1].to_radians(),
            arm = self.moment_arm_mm * 1e-3,
        ))
    }
}

/// Escapes the characters that XML reserves.
pub(crate) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
        .replace("--", "- -")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_out_of_range_are_refused() {
        let error = Finger { moment_arm_mm: 0.0, ..Finger::default() }.check().unwrap_err();
        assert_eq!(error.location().unwrap().field.as_deref(), Some("moment_arm_mm"));
        assert!(Finger { payload_g: f64::NAN, ..Finger::default() }.check().is_err());
        assert_eq!(Finger::default().wrap_deg_at(60.0), 60.0);
    }
}
