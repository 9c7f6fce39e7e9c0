//! The sentences of a guide that follow from the process: print material, cure, post-cure.

use super::Process;
use crate::config::Configuration;

/// Returns the sentences about material and shrinkage of the printed parts.
pub(crate) fn print_material(c: &Configuration) -> String {
    let material = c.process.material.data();
    let shrinkage = if material.shrinkage_pct > 0.0 {
        format!(
            "Compensate the shrinkage of {} in the slicer ({} % is usual).",
            material.name, material.shrinkage_pct
        )
    } else {
        "The printer compensates the shrinkage of its resin.".to_owned()
    };
    format!("Material: {}. {shrinkage}", material.name)
}

/// Returns the sentences about release agent and what prevents the cure.
pub(crate) fn preparation(c: &Configuration) -> String {
    let material = c.process.material.data();
    let bake = material.inhibition.map_or(String::new(), |inhibition| {
        let (first, rest) = inhibition.split_at(1);
        format!(" {}{rest}: silicone stays tacky on fresh {}.", first.to_uppercase(), material.name)
    });
    format!(
        "Do not use a release agent on {}.{bake} Latex gloves, and modelling clay with sulphur, prevent the cure.",
        material.name
    )
}

/// Returns the step that cures the layer in the mould. It gives no temperature where no cure makes the configured layer.
pub(crate) fn cure(c: &Configuration, process: &Process) -> String {
    let material = process.material;
    let wanted = c.silicone.hardness_shore_a;
    match (process.mould_cure, process.silicone) {
        (Some(cure), _) => {
            let softens = format!("Above {} \u{b0}C the mould softens.", material.hottest_cure_c);
            let shrinkage = if c.mould.shrinkage_pct > 0.0 {
                format!(" The mould compensates the shrinkage of this cure, {} %.", c.mould.shrinkage_pct)
            } else {
                String::new()
            };
            let hardness = match (process.post_cure, process.hardness_shore_a) {
                (None, Some([shore_a, scatter])) => {
                    format!(" The layer then has {shore_a:.0} \u{b1} {scatter:.0} Shore A.")
                }
                _ => String::new(),
            };
            format!("Cure for {cure} in the mould. {softens}{shrinkage}{hardness}")
        }
        (None, Some(_)) => {
            let problems: Vec<String> =
                process.conflicts.iter().map(|c| format!("{}: {}", c.problem, c.help)).collect();
            format!("**No cure makes this layer**: {}.", problems.join("; "))
        }
        (None, None) => format!(
            "Cure as the package of your silicone states, below {} \u{b0}C, at which the mould softens. The predicted curve is for a layer \
             of {wanted} Shore A, and the mould compensates a shrinkage of {} %.",
            material.hottest_cure_c, c.mould.shrinkage_pct
        ),
    }
}

/// Returns the step that cures the layer outside the mould; `None` if the hardness needs none.
pub(crate) fn post_cure(process: &Process) -> Option<String> {
    let cure = process.post_cure?;
    let [shore_a, scatter] = process.hardness_shore_a?;
    Some(format!(
        "Post-cure the layer outside the mould for {cure}, on a flat metal tray. It then has {shore_a:.0} \u{b1} {scatter:.0} Shore A, the \
         hardness behind the predicted curve. Without this step it stays softer."
    ))
}
