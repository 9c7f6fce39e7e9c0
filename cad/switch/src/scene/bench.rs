//! The bodies that pictures of steps show, each with its name, in its place.

use crate::built::Built;
use crate::design::Design;
use crate::hardware::hardware;
use crate::parts::{Role, cast};
use pinswitch_solid::mesh::{Mesh, Vector3};
use pinswitch_solid::profile::ChordTolerance;

/// A group of bodies with a common frame. Steps of one bench build on each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Bench {
    /// Bodies next to each other: coupon, cut pins, a separate guide pulley.
    Loose,
    /// The mould, on its base.
    Mould,
    /// The shell with what is fixed to it first, in the frame of the assembly.
    Shell,
    /// The switch, in the frame of the assembly.
    Switch,
}

/// A body in its place.
#[derive(Clone, Debug)]
pub struct Item {
    /// Name: that of the part, the bought body, or the silicone in the mould.
    pub name: String,
    /// Mesh in the frame of its bench.
    pub mesh: Mesh,
    /// Colour.
    pub colour: [u8; 3],
    /// Whether it keeps its full colour once it is in place.
    pub is_silicone: bool,
    /// Whether it is put in from the right side, at larger z.
    pub from_right: bool,
}

/// Name of the coupon on the bench of loose bodies.
pub(crate) const COUPON: &str = "coupon";
/// Name of the separate guide pulley.
pub(crate) const GUIDE_PULLEY: &str = "guide-pulley";
/// Begin of the names of cut pins.
pub(crate) const CUT_PIN: &str = "cut-pin";
/// Chord tolerance of the meshes of pictures, mm: less than the width of a pixel of the largest ones.
const PICTURE_MM: f64 = 0.02;
/// Distance of cut pins from each other, mm.
const CUT_APART_MM: f64 = 5.0;

const SILICONE: [u8; 3] = [104, 182, 224];
const SHELL: [u8; 3] = [142, 160, 184];
const PROXY: [u8; 3] = [226, 206, 122];
const PIN: [u8; 3] = [206, 72, 52];
const TENDON: [u8; 3] = [38, 128, 96];
const MOUNT: [u8; 3] = [146, 118, 190];

pub(super) const fn colour(role: Role) -> [u8; 3] {
    match role {
        Role::Layer => SILICONE,
        Role::Shell => SHELL,
        Role::Proxy => PROXY,
        Role::Pin { .. } => PIN,
        Role::Tendon => TENDON,
        Role::Mount | Role::DistalLink => MOUNT,
        other => other.colour(),
    }
}

/// All bodies that the steps of a set show.
#[derive(Clone, Debug)]
pub struct Bodies {
    loose: Vec<Item>,
    mould: Vec<Item>,
    switch: Vec<Item>,
}

impl Bodies {
    /// Collects the bodies of a set.
    pub fn new(built: &Built) -> Self {
        Self { loose: loose(built), mould: mould(built), switch: switch(built) }
    }

    /// Returns the bodies of a bench.
    pub fn on(&self, bench: Bench) -> &[Item] {
        match bench {
            Bench::Loose => &self.loose,
            Bench::Mould => &self.mould,
            Bench::Shell | Bench::Switch => &self.switch,
        }
    }

    /// Returns the names on a bench that are `stem` or begin with `stem-` and a number.
    pub fn names(&self, bench: Bench, stem: &str) -> Vec<String> {
        let is_numbered = |name: &str| {
            let number = name.strip_prefix(stem).and_then(|rest| rest.strip_prefix('-'));
            number.is_some_and(|n| n.parse::<usize>().is_ok())
        };
        let wanted = self.on(bench).iter().filter(|i| i.name == stem || is_numbered(&i.name));
        wanted.map(|i| i.name.clone()).collect()
    }

    /// Returns the body of a bench with this name.
    pub fn find(&self, bench: Bench, name: &str) -> Option<&Item> {
        self.on(bench).iter().find(|item| item.name == name)
    }
}

/// The tolerance of the design, if that is not finer than pictures need.
fn picture_tolerance(design: &Design) -> ChordTolerance {
    let usual = ChordTolerance::new(PICTURE_MM).ok();
    usual.filter(|usual| usual.mm() > design.tolerance().mm()).unwrap_or(design.tolerance())
}

fn switch(built: &Built) -> Vec<Item> {
    let design = built.design();
    let tolerance = picture_tolerance(design);
    let made = built.assembly().filter_map(|body| {
        let mesh = body.part.pose?.apply(body.part.solid.mesh(tolerance).ok()?);
        let role = body.part.role;
        Some(Item {
            name: body.part.name.clone(),
            mesh,
            colour: colour(role),
            is_silicone: role == Role::Layer,
            from_right: true,
        })
    });
    let bought = hardware(design).into_iter().filter_map(|body| {
        let mesh = body.solid.mesh(tolerance).ok()?;
        let colour = body.kind.colour();
        Some(Item { name: body.name, mesh, colour, is_silicone: false, from_right: body.from_right })
    });
    made.chain(bought).collect()
}

fn mould(built: &Built) -> Vec<Item> {
    let design = built.design();
    let printed = built.printed().iter().filter(|p| p.part().role == Role::Mould);
    let tolerance = picture_tolerance(design);
    let parts = printed.filter_map(|p| {
        let mesh = p.part().solid.mesh(tolerance).ok()?;
        // A tray has no other parts, and is in its own frame.
        let mesh = match p.part().tool_pose {
            Some(pose) => pose.apply(mesh),
            None => mesh,
        };
        Some(Item {
            name: p.part().name.clone(),
            mesh,
            colour: Role::Mould.colour(),
            is_silicone: false,
            from_right: true,
        })
    });
    let parts: Vec<Item> = parts.collect();
    if parts.is_empty() {
        return parts;
    }
    let silicone = cast(design).into_iter().filter_map(|(name, solid)| {
        let mesh = solid.mesh(tolerance).ok()?;
        Some(Item { name, mesh, colour: SILICONE, is_silicone: true, from_right: true })
    });
    parts.into_iter().chain(silicone).collect()
}

fn loose(built: &Built) -> Vec<Item> {
    let accessories = built.printed().iter().filter(|p| p.part().role == Role::Accessory);
    let mut items: Vec<Item> = accessories
        .map(|p| Item {
            name: p.part().name.clone(),
            mesh: p.print_mesh.clone(),
            colour: Role::Accessory.colour(),
            is_silicone: false,
            from_right: true,
        })
        .collect();
    let pins: Vec<_> = built.reference().iter().filter(|b| matches!(b.part.role, Role::Pin { .. })).collect();
    let spares = built.design().configuration().pins.spares;
    if let Some(first) = pins.first()
        && let Some((low, high)) = first.mesh.bounds()
    {
        let middle = nalgebra::center(&low, &high).coords;
        for i in 0..pins.len() + spares {
            let place = Vector3::new(i as f64 * CUT_APART_MM, 0.0, 0.0);
            let mesh = first.mesh.clone().translated(place - middle);
            items.push(Item {
                name: format!("{CUT_PIN}-{}", i + 1),
                mesh,
                colour: PIN,
                is_silicone: false,
                from_right: true,
            });
        }
    }
    items
}
