//! STEP: one exact solid per printed part, and the assembly.

use super::{Format, Inclusion};
use crate::built::Built;
use crate::documents::Manifest;
use crate::output::{OutputFile, SetError};
use crate::parts::Part;
use crate::prediction::Prediction;
use pinswitch_solid::files::{StepPart, step_assembly, step_part};

pub(super) const FORMAT: Format = Format {
    name: "step",
    about: "Exact solids for CAD: one per part, and the assembly",
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
    Ok(files)
}
