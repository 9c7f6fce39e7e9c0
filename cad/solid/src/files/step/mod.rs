//! STEP (AP214): one exact solid per part with planes, cylinders, cones, lines and circles, and the
//! assembly.
//!
//! Libraries write arcs as B-splines and add a time stamp (cad/doc/meshes.md, "Files"). A solid of
//! contours at heights needs only a dozen kinds of entity.

mod shell;
mod surface;
mod writer;

use crate::mesh::{Point3, Vector3};
use crate::pose::Pose;
use crate::solid::Solid;

use writer::{Id, StepWriter, list, text};

/// A part with its name.
#[derive(Clone, Copy, Debug)]
pub struct StepPart<'a> {
    /// Name of the product.
    pub name: &'a str,
    /// Exact solid.
    pub solid: &'a Solid,
}

/// Entities that all products of a file refer to.
struct Contexts {
    units: Id,
    product_context: Id,
    definition_context: Id,
}

/// A product: its definition, its shape and the frame of that shape.
struct Product {
    definition: Id,
    representation: Id,
    frame: Id,
}

/// Returns the STEP file of one part, moved by `shift_mm`: the frame of its mesh on the print bed.
pub fn step_part(part: StepPart<'_>, shift_mm: Vector3) -> String {
    let mut out = StepWriter::shifted(shift_mm);
    let contexts = contexts(&mut out);
    solid_product(&mut out, &contexts, part);
    out.file(part.name)
}

/// Returns the STEP file of the assembly `name`: each part once, in its pose.
pub fn step_assembly(name: &str, parts: &[(StepPart<'_>, Pose)]) -> String {
    let mut out = StepWriter::default();
    let contexts = contexts(&mut out);
    let origin = out.origin();
    let frames: Vec<Id> = parts.iter().map(|(_, pose)| frame(&mut out, *pose)).collect();
    let items: Vec<Id> = std::iter::once(origin).chain(frames.iter().copied()).collect();
    let representation =
        out.add(&format!("SHAPE_REPRESENTATION('{}',{},{})", text(name), list(&items), contexts.units));
    let root = product(&mut out, &contexts, name, representation, origin);
    for (i, ((part, _), frame)) in parts.iter().zip(&frames).enumerate() {
        let child = solid_product(&mut out, &contexts, *part);
        place(&mut out, i + 1, part.name, &root, &child, *frame);
    }
    out.file(name)
}

fn frame(out: &mut StepWriter, pose: Pose) -> Id {
    let at = Point3::new(0.0, 0.0, pose.z_mm);
    let turn = if pose.flipped { -1.0 } else { 1.0 };
    out.placement(at, Vector3::z() * turn, Vector3::x() * turn)
}

fn contexts(out: &mut StepWriter) -> Contexts {
    let application = out.add("APPLICATION_CONTEXT('automotive design')");
    out.add(&format!(
        "APPLICATION_PROTOCOL_DEFINITION('international standard','automotive_design',2000,{application})"
    ));
    let product_context = out.add(&format!("PRODUCT_CONTEXT('',{application},'mechanical')"));
    let definition_context =
        out.add(&format!("PRODUCT_DEFINITION_CONTEXT('part definition',{application},'design')"));
    let length = out.add("(LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT(.MILLI.,.METRE.))");
    let angle = out.add("(NAMED_UNIT(*) PLANE_ANGLE_UNIT() SI_UNIT($,.RADIAN.))");
    let solid_angle = out.add("(NAMED_UNIT(*) SI_UNIT($,.STERADIAN.) SOLID_ANGLE_UNIT())");
    let uncertainty = out.add(&format!(
        "UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(1.E-7),{length},'distance_accuracy_value','')"
    ));
    let units = out.add(&format!(
        "(GEOMETRIC_REPRESENTATION_CONTEXT(3) GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT(({uncertainty})) \
         GLOBAL_UNIT_ASSIGNED_CONTEXT(({length},{angle},{solid_angle})) REPRESENTATION_CONTEXT('',''))"
    ));
    Contexts { units, product_context, definition_context }
}

fn solid_product(out: &mut StepWriter, contexts: &Contexts, part: StepPart<'_>) -> Product {
    let brep = shell::manifold_solid(out, part.name, part.solid);
    let frame = out.origin();
    let representation = out.add(&format!(
        "ADVANCED_BREP_SHAPE_REPRESENTATION('{}',({frame},{brep}),{})",
        text(part.name),
        contexts.units
    ));
    product(out, contexts, part.name, representation, frame)
}

fn product(out: &mut StepWriter, contexts: &Contexts, name: &str, representation: Id, frame: Id) -> Product {
    let name = text(name);
    let product = out.add(&format!("PRODUCT('{name}','{name}','',({}))", contexts.product_context));
    out.add(&format!("PRODUCT_RELATED_PRODUCT_CATEGORY('part','',({product}))"));
    let formation = out.add(&format!("PRODUCT_DEFINITION_FORMATION('','',{product})"));
    let definition =
        out.add(&format!("PRODUCT_DEFINITION('design','',{formation},{})", contexts.definition_context));
    let shape = out.add(&format!("PRODUCT_DEFINITION_SHAPE('','',{definition})"));
    out.add(&format!("SHAPE_DEFINITION_REPRESENTATION({shape},{representation})"));
    Product { definition, representation, frame }
}

/// Places `child` in `root`, with its own frame on `frame`.
fn place(out: &mut StepWriter, number: usize, name: &str, root: &Product, child: &Product, frame: Id) {
    let occurrence = out.add(&format!(
        "NEXT_ASSEMBLY_USAGE_OCCURRENCE('{number}','{}','',{},{},$)",
        text(name),
        root.definition,
        child.definition
    ));
    let shape = out.add(&format!("PRODUCT_DEFINITION_SHAPE('placement','',{occurrence})"));
    let transformation = out.add(&format!("ITEM_DEFINED_TRANSFORMATION('','',{},{frame})", child.frame));
    let relationship = out.add(&format!(
        "(REPRESENTATION_RELATIONSHIP('','',{},{}) \
         REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION({transformation}) SHAPE_REPRESENTATION_RELATIONSHIP())",
        child.representation, root.representation
    ));
    out.add(&format!("CONTEXT_DEPENDENT_SHAPE_REPRESENTATION({relationship},{shape})"));
}

#[cfg(test)]
mod step_file;
#[cfg(test)]
mod tests;
