//! Entities of a STEP file (ISO 10303-21).

use std::fmt::Write as _;

use crate::mesh::{Point3, Vector3};
use crate::profile::Point2;

/// The number of an entity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Id(usize);

impl std::fmt::Display for Id {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "#{}", self.0)
    }
}

/// A file under construction: entities in the order of their numbers.
#[derive(Debug, Default)]
pub(super) struct StepWriter {
    data: String,
    last: usize,
    /// Added to every point.
    shift: Vector3,
}

impl StepWriter {
    /// A file in which everything is moved by `shift_mm`.
    pub(super) fn shifted(shift_mm: Vector3) -> Self {
        Self { shift: shift_mm, ..Self::default() }
    }

    /// Adds an entity and returns its number.
    pub(super) fn add(&mut self, entity: &str) -> Id {
        self.last += 1;
        let _ = writeln!(self.data, "#{}={entity};", self.last);
        Id(self.last)
    }

    pub(super) fn point(&mut self, p: Point3) -> Id {
        let p = p + self.shift;
        self.add(&format!("CARTESIAN_POINT('',({},{},{}))", real(p.x), real(p.y), real(p.z)))
    }

    pub(super) fn direction(&mut self, d: Vector3) -> Id {
        self.add(&format!("DIRECTION('',({},{},{}))", real(d.x), real(d.y), real(d.z)))
    }

    /// Adds a right-handed frame at `at` by the directions of its z axis and x axis.
    pub(super) fn placement(&mut self, at: Point3, axis: Vector3, reference: Vector3) -> Id {
        let (at, axis, reference) = (self.point(at), self.direction(axis), self.direction(reference));
        self.add(&format!("AXIS2_PLACEMENT_3D('',{at},{axis},{reference})"))
    }

    /// Adds the frame of the model.
    pub(super) fn origin(&mut self) -> Id {
        self.placement(Point3::origin() - self.shift, Vector3::z(), Vector3::x())
    }

    /// Returns the file, with the name `name`.
    pub(super) fn file(&self, name: &str) -> String {
        // The time stamp is the epoch: with the current time, every run would give other bytes.
        format!(
            "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION(('pinswitch: exact solids of a friction switch'),'2;1');\n\
             FILE_NAME('{}','1970-01-01T00:00:00',(''),(''),'pinswitch {}','pinswitch','');\n\
             FILE_SCHEMA(('AUTOMOTIVE_DESIGN {{ 1 0 10303 214 1 1 1 1 }}'));\nENDSEC;\nDATA;\n{}ENDSEC;\nEND-ISO-10303-21;\n",
            text(name),
            env!("CARGO_PKG_VERSION"),
            self.data
        )
    }
}

/// A point of a contour at a height.
pub(super) fn raised(p: Point2, z_mm: f64) -> Point3 {
    Point3::new(p.x, p.y, z_mm)
}

/// A list of entity numbers, such as `(#1,#2)`.
pub(super) fn list(ids: &[Id]) -> String {
    let all: Vec<String> = ids.iter().map(Id::to_string).collect();
    format!("({})", all.join(","))
}

/// A real number with all digits of a double, and the decimal point that the format requires.
pub(super) fn real(value: f64) -> String {
    // Adding zero turns -0 into +0.
    let shortest = format!("{:?}", value + 0.0);
    match shortest.split_once('e') {
        Some((mantissa, exponent)) if mantissa.contains('.') => format!("{mantissa}E{exponent}"),
        Some((mantissa, exponent)) => format!("{mantissa}.E{exponent}"),
        None => shortest,
    }
}

/// The content of a string: quotes and backslashes doubled, other than printable ASCII as `\X2\`
/// and `\X4\` with the hexadecimal code point (ISO 10303-21, 6.4.3), without control characters.
pub(super) fn text(value: &str) -> String {
    let mut text = String::new();
    for c in value.chars().filter(|c| !c.is_control()) {
        let code = u32::from(c);
        let _ = match c {
            '\'' => write!(text, "''"),
            '\\' => write!(text, r"\\"),
            ' '..='~' => write!(text, "{c}"),
            '\0'..='\u{ffff}' => write!(text, r"\X2\{code:04X}\X0\"),
            _ => write!(text, r"\X4\{code:08X}\X0\"),
        };
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_all_digits_and_a_point() {
        let written: Vec<String> = [0.1, -0.0, 1e-7, 12.0, -2.5e-10, 1e22].map(real).to_vec();
        assert_eq!(written, ["0.1", "0.0", "1.E-7", "12.0", "-2.5E-10", "1.E22"]);
    }

    #[test]
    fn text_cannot_end_its_string() {
        assert_eq!(text("a 'b'\n"), "a ''b''");
        assert_eq!(text(r"\X2\'"), r"\\X2\\''");
        assert_eq!(text("\u{e4}\u{1f600}"), r"\X2\00E4\X0\\X4\0001F600\X0\");
    }
}
