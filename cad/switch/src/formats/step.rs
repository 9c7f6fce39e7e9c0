//! STEP: one exact solid per printed part, the assembly, and the split mould put together.

use super::{Format, Inclusion};
use crate::built::Built;
use crate::documents::Manifest;
use crate::hardware::hardware;
use crate::output::{OutputFile, SetError};
use crate::parts::Part;
use crate::prediction::Prediction;
use pinswitch_solid::files::{StepPart, step_assembly, step_part};
use pinswitch_solid::pose::Pose;

pub(super) const FORMAT: Format = Format {
    name: "step",
    about: "Exact solids for CAD: one per part, the assembly with its hardware, and the mould put together",
    inclusion: Inclusion::Named,
    make,
};

fn make(built: &Built, _: &Prediction, _: &Manifest) -> Result<Vec<OutputFile>, SetError> {
    fn body(part: &Part) -> StepPart<'_> {
        StepPart { name: &part.name, solid: &part.solid }
    }
    let mut files: Vec<OutputFile> = built
        .printed()
        .iter()
        .map(|p| {
            let part = p.part();
            OutputFile::new(format!("{}.step", part.name), step_part(body(part), part.print_shift_mm()))
        })
        .collect();
    let bought = hardware(built.design());
    let bought = bought.iter().map(|b| (StepPart { name: &b.name, solid: &b.solid }, Pose::upright(0.0)));
    let placed: Vec<_> =
        built.assembly().filter_map(|b| Some((body(&b.part), b.part.pose?))).chain(bought).collect();
    let assembly = step_assembly(&built.design().configuration().switch.name, &placed);
    files.push(OutputFile::new("assembly.step", assembly));
    // The parts of a split mould, which are assembled without the switch.
    let tools: Vec<_> =
        built.printed().iter().filter_map(|p| Some((body(p.part()), p.part().tool_pose?))).collect();
    if !tools.is_empty() {
        files.push(OutputFile::new("mould.step", step_assembly("mould", &tools)));
    }
    Ok(files)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::Configuration;
    use crate::design::Design;

    /// Points of the vertices of a STEP file.
    fn vertices(text: &str) -> Vec<[f64; 3]> {
        let entities: std::collections::BTreeMap<&str, &str> =
            text.lines().filter_map(|line| line.strip_suffix(';')?.split_once('=')).collect();
        let vertex = "VERTEX_POINT('',";
        let of_vertices = entities.values().filter_map(|e| e.strip_prefix(vertex)?.strip_suffix(')'));
        let points = of_vertices.map(|point| {
            let numbers = entities[point].strip_prefix("CARTESIAN_POINT('',(").unwrap();
            let numbers = numbers.strip_suffix("))").unwrap().split(',');
            let numbers: Vec<f64> = numbers.map(|number| number.parse().unwrap()).collect();
            [numbers[0], numbers[1], numbers[2]]
        });
        points.collect()
    }

    #[test]
    fn step_and_stl_have_one_frame() {
        let built = Built::new(Design::new(Configuration::default()).unwrap()).unwrap();
        for part in built.printed() {
            let text =
                step_part(StepPart { name: "x", solid: &part.part().solid }, part.part().print_shift_mm());
            let (low, high) = part.print_mesh.bounds().unwrap();
            let vertices = vertices(&text);
            assert!(vertices.len() > 3);
            let least = vertices.iter().map(|v| v[2]).fold(f64::INFINITY, f64::min);
            assert!(least.abs() < 1e-9 && low.z.abs() < 1e-9, "{}", part.part().name);
            for vertex in vertices {
                let inside = (0..3).all(|k| vertex[k] > low[k] - 1e-6 && vertex[k] < high[k] + 1e-6);
                assert!(inside, "{}: {vertex:?} outside of {low} to {high}", part.part().name);
            }
        }
    }
}
