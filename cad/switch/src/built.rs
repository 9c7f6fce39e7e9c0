//! Built designs: the solid of each part, its mesh, and the measured properties of the mesh.
//!
//! Every format takes a [`Built`], so that each part is built and meshed once.

use std::sync::OnceLock;

use crate::design::Design;
use crate::output::BuildError;
use crate::parallel::map_each;
use crate::parts::{Part, Role, fit_on_bed, printed, printed_part, reference_bodies};
use pinswitch_diagnostic::{Diagnostic, Location};
use pinswitch_solid::files::stl_bytes;
use pinswitch_solid::mesh::Mesh;
use pinswitch_solid::solid::CapCache;
use pinswitch_solid::validity::{Expectation, MeshFacts, examine};
use pinswitch_solid::verification::{Kernel, Verification, verify};

/// A body with its mesh about the pulley's axis, with its lower end at z = 0.
#[derive(Clone, Debug)]
pub struct MeshedBody {
    /// The body.
    pub part: Part,
    /// Its mesh.
    pub mesh: Mesh,
}

impl MeshedBody {
    fn new(part: Part, design: &Design, caps: &CapCache) -> Result<Self, BuildError> {
        let mesh = part.solid.mesh_with(design.tolerance(), caps);
        let mesh = mesh.map_err(|source| BuildError::Cap { part: part.name.clone(), source })?;
        Ok(Self { part, mesh })
    }
}

/// A printed part, meshed and examined.
#[derive(Clone, Debug)]
pub struct BuiltPart {
    /// The part with its mesh about the pulley's axis.
    pub body: MeshedBody,
    /// The written mesh, on the print bed.
    pub print_mesh: Mesh,
    /// Measured properties of the written mesh.
    pub facts: MeshFacts,
}

impl BuiltPart {
    /// Meshes `part` and validates the mesh, without the search for self-intersections, which vertical walls over valid caps
    /// do not have. `pinswitch check` and the tests include it.
    ///
    /// # Errors
    /// [`BuildError`] if the mesh is not valid.
    pub fn new(part: Part, design: &Design) -> Result<Self, BuildError> {
        Self::with_caps(part, design, &CapCache::new(usize::MAX))
    }

    /// The mesh of this part for another part with the same solid and tolerance.
    fn reused_for(&self, part: Part) -> Self {
        let body = MeshedBody { part: part.known_by(self.part()), mesh: self.body.mesh.clone() };
        Self { body, print_mesh: self.print_mesh.clone(), facts: self.facts.clone() }
    }

    fn with_caps(part: Part, design: &Design, caps: &CapCache) -> Result<Self, BuildError> {
        let body = MeshedBody::new(part, design, caps)?;
        let print_mesh = body.mesh.clone().translated(body.part.print_shift_mm());
        let facts = examined(&body.part, &print_mesh, design)?;
        Ok(Self { body, print_mesh, facts })
    }

    /// The part.
    pub const fn part(&self) -> &Part {
        &self.body.part
    }

    /// The binary STL of the part.
    ///
    /// # Errors
    /// The writer's error; memory does not fail.
    pub fn stl(&self) -> std::io::Result<Vec<u8>> {
        stl_bytes(&self.print_mesh)
    }
}

/// Returns the mesh of `part` on the print bed, which files contain, and its measured properties.
/// Reuses the caps of other parts in `caps`.
///
/// # Errors
/// [`BuildError`] for a part that cannot be built, or whose mesh is invalid.
pub fn examined_print_mesh(
    part: &Part,
    design: &Design,
    caps: &CapCache,
) -> Result<(Mesh, MeshFacts), BuildError> {
    let mesh = part.solid.mesh_with(design.tolerance(), caps);
    let mesh = mesh.map_err(|source| BuildError::Cap { part: part.name.clone(), source })?;
    let mesh = mesh.translated(part.print_shift_mm());
    let facts = examined(part, &mesh, design)?;
    Ok((mesh, facts))
}

/// Returns whether `design` can build and mesh the part or body of this name. A part that `design`
/// does not have counts as built.
pub(crate) fn builds(name: &str, design: &Design, caps: &CapCache) -> bool {
    if let Some(part) = printed_part(name, design) {
        return part.is_ok_and(|part| BuiltPart::with_caps(part, design, caps).is_ok());
    }
    let is_meshed = |part: Part| MeshedBody::new(part, design, caps).is_ok();
    reference_bodies(design)
        .is_ok_and(|bodies| bodies.into_iter().filter(|body| body.name == name).all(is_meshed))
}

/// Compares the written mesh of `part`, on the print bed, with that of a second kernel.
///
/// # Errors
/// A diagnostic that names the part, the quantity, both values and the bound.
pub fn verified(
    part: &Part,
    print_mesh: &Mesh,
    design: &Design,
    kernel: Kernel,
) -> Result<Verification, Diagnostic> {
    let mesh = print_mesh.clone().translated(-part.print_shift_mm());
    verify(&part.solid, &mesh, design.tolerance(), kernel).map_err(|error| {
        let location = Location { field: Some(part.name.clone()), ..Location::default() };
        Diagnostic::from(error).with_location(location)
    })
}

/// Returns the properties of a valid mesh.
fn examined(part: &Part, print_mesh: &Mesh, design: &Design) -> Result<MeshFacts, BuildError> {
    let expected = Expectation { intersections: false, ..part.expectation(design) };
    let report = examine(print_mesh, &expected);
    match report.faults.into_iter().next() {
        Some(fault) => Err(BuildError::Invalid { part: part.name.clone(), fault }),
        None => Ok(report.facts),
    }
}

/// A design with its printed parts and reference bodies.
///
/// ```
/// use pinswitch_switch::{built::Built, config::Configuration, design::Design};
///
/// let built = Built::new(Design::new(Configuration::default())?)?;
/// let shell = &built.printed()[0];
/// assert_eq!(shell.part().name, "shell");
/// // A mesh and the exact solid agree within the chord tolerance.
/// assert!((shell.facts.volume_mm3 / shell.part().solid.volume_mm3() - 1.0).abs() < 1e-3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Built {
    design: Design,
    printed: Vec<BuiltPart>,
    reference: Vec<MeshedBody>,
    exploded_png: OnceLock<Vec<u8>>,
}

impl Built {
    /// Builds, meshes and validates all parts of a design.
    ///
    /// # Errors
    /// [`BuildError`] of the first part that cannot be built.
    pub fn new(design: Design) -> Result<Self, BuildError> {
        Self::following(design, None, &CapCache::new(usize::MAX))
    }

    /// Builds one design of a series. Reuses unchanged parts of the design `before`, and caps from
    /// `caps`, to which it adds new ones.
    ///
    /// # Errors
    /// As [`Built::new`].
    pub fn following(design: Design, before: Option<&Self>, caps: &CapCache) -> Result<Self, BuildError> {
        let parts = printed(&design)?;
        fit_on_bed(&parts, &design)?;
        let known = before.filter(|before| before.design.tolerance() == design.tolerance());
        let twin = |part: &Part| {
            let is_twin = |b: &&BuiltPart| b.part().name == part.name && b.part().solid == part.solid;
            known?.printed.iter().find(is_twin)
        };
        let made = |part: Part| match twin(&part) {
            Some(twin) => Ok(twin.reused_for(part)),
            None => BuiltPart::with_caps(part, &design, caps),
        };
        let printed = map_each(parts, made).into_iter().collect::<Result<Vec<_>, _>>()?;
        let reference = reference_bodies(&design)?
            .into_iter()
            .map(|part| {
                // Equal solids, such as layer and proxy, are meshed once.
                match printed.iter().find(|p| p.part().solid == part.solid) {
                    Some(twin) => Ok(MeshedBody { part, mesh: twin.body.mesh.clone() }),
                    None => MeshedBody::new(part, &design, caps),
                }
            })
            .collect::<Result<_, _>>()?;
        Ok(Self { design, printed, reference, exploded_png: OnceLock::new() })
    }

    /// Returns the design.
    pub const fn design(&self) -> &Design {
        &self.design
    }

    /// Returns the printed parts, in the order of [`crate::parts::PRINTED_PARTS`].
    pub fn printed(&self) -> &[BuiltPart] {
        &self.printed
    }

    /// Compares the mesh of every printed part with that of a second kernel, in the order of [`Self::printed`].
    ///
    /// # Errors
    /// The first part whose mesh the kernel does not confirm.
    pub fn verified(&self, kernel: Kernel) -> Result<Vec<Verification>, Diagnostic> {
        let parts = self.printed.iter().collect();
        map_each(parts, |p: &BuiltPart| verified(p.part(), &p.print_mesh, &self.design, kernel))
            .into_iter()
            .collect()
    }

    /// Returns layer, pins and tendon.
    pub fn reference(&self) -> &[MeshedBody] {
        &self.reference
    }

    /// The cell of the picture of the exploded assembly.
    pub(crate) const fn exploded_png(&self) -> &OnceLock<Vec<u8>> {
        &self.exploded_png
    }

    /// Returns every body of the assembly, printed ones first. The proxy is included only without a silicone layer.
    pub fn assembly(&self) -> impl Iterator<Item = &MeshedBody> {
        let has_layer = self.reference.iter().any(|b| b.part.role == Role::Layer);
        self.printed
            .iter()
            .map(|p| &p.body)
            .filter(move |b| !(has_layer && b.part.role == Role::Proxy))
            .chain(&self.reference)
            .filter(|b| b.part.pose.is_some())
    }
}
