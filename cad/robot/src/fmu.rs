//! A co-simulation unit of FMI 3.0 (<https://fmi-standard.org/docs/3.0/>).

use std::io::{Cursor, Write};

use pinswitch_diagnostic::{Diagnostic, codes};
use zip::write::SimpleFileOptions;

use crate::finger::escaped;
use crate::surface::Surface;

/// Name of the source of the unit.
pub const FMU_SOURCE: &str = "sources/pinswitch.c";
/// Name of the library of the unit, without the ending of the platform.
pub const FMU_LIBRARY: &str = "pinswitch_switch";

/// Returns the files of a unit without a compiled library: description, build description, and C sources.
///
/// The unit has a library after `cc -shared -fPIC` of [`FMU_SOURCE`] into `binaries/x86_64-linux` or the folder of
/// another platform.
pub fn fmu_sources(surface: &Surface) -> Vec<(String, Vec<u8>)> {
    let token = token(surface);
    let description = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>
<fmiModelDescription fmiVersion=\"3.0\" modelName=\"{name}\" instantiationToken=\"{token}\" description=\"Friction switch: tension of the motor and motion in, tension of the load out\" generationTool=\"pinswitch {version}\">
  <CoSimulation modelIdentifier=\"{FMU_LIBRARY}\" canHandleVariableCommunicationStepSize=\"true\"/>
  <DefaultExperiment startTime=\"0\" stopTime=\"1\" stepSize=\"0.001\"/>
  <ModelVariables>
    <Float64 name=\"time\" valueReference=\"0\" causality=\"independent\" variability=\"continuous\"/>
    <Float64 name=\"tension_N\" valueReference=\"1\" causality=\"input\" start=\"0\" description=\"Tension of the motor\"/>
    <Float64 name=\"displacement_m\" valueReference=\"2\" causality=\"input\" start=\"0\" description=\"Displacement of the tendon towards the motor\"/>
    <Float64 name=\"wrap_rad\" valueReference=\"3\" causality=\"input\" start=\"{wrap}\" description=\"Wrap angle; not used by a switch with one wrap angle\"/>
    <Float64 name=\"load_N\" valueReference=\"4\" causality=\"output\" initial=\"calculated\" description=\"Tension on the side of the load\"/>
    <Float64 name=\"friction_N\" valueReference=\"5\" causality=\"output\" initial=\"calculated\" description=\"Tension minus load\"/>
    <Float64 name=\"stiffness_N_m\" valueReference=\"6\" causality=\"parameter\" variability=\"fixed\" start=\"20000\" min=\"1\" description=\"Stiffness of the tendon before it slides\"/>
    <Float64 name=\"dissipated_J\" valueReference=\"7\" causality=\"output\" initial=\"calculated\" description=\"Energy that sliding has dissipated\"/>
  </ModelVariables>
  <ModelStructure>
    <Output valueReference=\"4\"/>
    <Output valueReference=\"5\"/>
    <Output valueReference=\"7\"/>
    <InitialUnknown valueReference=\"4\"/>
    <InitialUnknown valueReference=\"5\"/>
    <InitialUnknown valueReference=\"7\"/>
  </ModelStructure>
</fmiModelDescription>
",
        name = escaped(surface.name()),
        version = env!("CARGO_PKG_VERSION"),
        wrap = surface.wrap_rad().last().copied().unwrap_or_default(),
    );
    let build = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>
<fmiBuildDescription fmiVersion=\"3.0\">
  <BuildConfiguration modelIdentifier=\"{FMU_LIBRARY}\">
    <SourceFileSet language=\"C99\">
      <SourceFile name=\"pinswitch.c\"/>
    </SourceFileSet>
  </BuildConfiguration>
</fmiBuildDescription>
"
    );
    vec![
        ("modelDescription.xml".to_owned(), description.into_bytes()),
        ("sources/buildDescription.xml".to_owned(), build.into_bytes()),
        (FMU_SOURCE.to_owned(), include_bytes!("fmu.c").to_vec()),
        ("sources/surface.h".to_owned(), header(surface, &token).into_bytes()),
    ]
}

/// Returns the text that identifies the tensions of a unit: FNV-1a of the table.
fn token(surface: &Surface) -> String {
    let hash = surface.to_csv().bytes().fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
    });
    format!("pinswitch-{hash:016x}")
}

/// Returns the tensions as C.
fn header(surface: &Surface, token: &str) -> String {
    let row = |values: &[f64]| values.iter().map(|v| format!("{v:?}")).collect::<Vec<_>>().join(", ");
    let table = |rows: &[Vec<f64>]| {
        rows.iter().map(|values| format!("    {{{}}}", row(values))).collect::<Vec<_>>().join(",\n")
    };
    format!(
        "/* Tensions of a friction switch. Angles in rad, forces in N. */
#define TOKEN \"{token}\"
#define WRAPS {}
#define LOADS {}
static const double wrap_rad[WRAPS] = {{{}}};
static const double load_n[LOADS] = {{{}}};
static const double eccentric_n[WRAPS][LOADS] = {{
{}
}};
static const double concentric_n[WRAPS][LOADS] = {{
{}
}};
",
        surface.wrap_rad().len(),
        surface.load_n().len(),
        row(surface.wrap_rad()),
        row(surface.load_n()),
        table(surface.eccentric_n()),
        table(surface.concentric_n()),
    )
}

/// Packs the files of a unit. The same files give the same bytes.
///
/// # Errors
/// A [`Diagnostic`] if a file cannot be packed.
pub fn zip_fmu(files: &[(String, Vec<u8>)]) -> Result<Vec<u8>, Diagnostic> {
    let mut archive = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for (name, bytes) in files {
        let options = SimpleFileOptions::default().last_modified_time(zip::DateTime::default());
        archive
            .start_file(name.as_str(), options)
            .map_err(|e| Diagnostic::from_error(codes::INTERNAL_ERROR, e))?;
        archive.write_all(bytes).map_err(|e| Diagnostic::from_error(codes::INTERNAL_ERROR, e))?;
    }
    archive.finish().map(Cursor::into_inner).map_err(|e| Diagnostic::from_error(codes::INTERNAL_ERROR, e))
}

#[cfg(test)]
mod tests {
    use super::*;
    use pinswitch_friction::{Contact, PinPattern, Substrate, predict, published};

    #[test]
    fn units_are_packed_reproducibly() {
        let contact =
            Contact::new(Substrate::Silicone, PinPattern::even(3, 0.3), published::wrap_angle_rad()).unwrap();
        let surface = Surface::new("a<b", vec![(1.1, predict(&contact, &[5.0, 20.0]))]).unwrap();
        let files = fmu_sources(&surface);
        let description = String::from_utf8(files[0].1.clone()).unwrap();
        assert!(description.contains("modelName=\"a&lt;b\""));
        assert!(description.contains(&token(&surface)));
        assert_eq!(zip_fmu(&files).unwrap(), zip_fmu(&fmu_sources(&surface)).unwrap());
        assert_ne!(token(&surface), token(&surface.drawn(1.0)));
    }
}
