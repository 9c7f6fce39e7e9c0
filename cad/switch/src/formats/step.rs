//! STEP: one exact solid per printed part, the assembly, and the split mould put together.

use super::{Format, Inclusion};
use crate::built::Built;
use crate::documents::Manifest;
use crate::output::{OutputFile, SetError};
use crate::parts::Part;
use crate::prediction::Prediction;
use pinswitch_solid::files::{StepPart, step_assembly, step_part};

pub(super) const FORMAT: Format = Format {
    name: "step",
    about: "Exact solids for CAD: one per part, the assembly, and the mould put together",
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
        .map(|p| OutputFile::new(format!("{}.step", p.part().name), step_part(body(p.part()))))
        .collect();
    let placed: Vec<_> = built.assembly().filter_map(|b| Some((body(&b.part), b.part.pose?))).collect();
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
