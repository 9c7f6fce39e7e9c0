//! A reader of the STEP files that this crate writes, for tests only: it computes topology,
//! geometry and volume from the text alone.
//!
//! It depends on the standard library only and shares no code with the writer, so that an error of
//! the writer cannot cancel itself here. `tests/harness` includes this folder, too. It supports the
//! kinds of entity that the writer uses, with walls about vertical axes, and refuses all others.

// No byte of a written file depends on this reader, so that its sines may differ between platforms.
#![allow(clippy::disallowed_methods)]

mod entity;
mod surface;

use std::collections::{BTreeMap, BTreeSet};

use entity::{
    Entity, Parser, Value, Vec3, coordinates, count, flag, id, list, parameter, real, repeated, rows, text,
};
use surface::{Frame, LoopArc, LoopEdge, SAME_MM, Spline, Surface, cross, dot, face_integral, minus, norm};

pub(crate) use entity::StepError;

/// Largest cosine of the angle between two axes of a frame; 0 if they are orthogonal.
const MAX_COSINE: f64 = 1e-9;
/// Largest error of the length of a unit vector.
const MAX_LENGTH_ERROR: f64 = 1e-12;

/// A parsed file.
pub(crate) struct StepFile {
    entities: BTreeMap<u64, Entity>,
}

/// A closed solid of a file.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct StepSolid {
    pub(crate) name: String,
    pub(crate) faces: usize,
    /// Number of handles: 0 for a ball, 1 for a washer.
    pub(crate) genus: usize,
    pub(crate) volume_mm3: f64,
    /// Whether a face is a B-spline surface.
    pub(crate) has_splines: bool,
}

/// The placement of a solid in an assembly.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct StepPlacement {
    /// Name of the solid.
    pub(crate) name: String,
    /// Origin of its frame.
    pub(crate) origin_mm: Vec3,
    /// Directions of the axes of its frame.
    pub(crate) x: Vec3,
    pub(crate) z: Vec3,
}

impl StepFile {
    /// Parses a file. Every reference must resolve.
    pub(crate) fn parse(text: &str) -> Result<Self, StepError> {
        let data = text
            .strip_prefix("ISO-10303-21;\nHEADER;")
            .and_then(|rest| rest.strip_suffix("ENDSEC;\nEND-ISO-10303-21;\n"))
            .and_then(|rest| rest.split_once("\nDATA;\n"))
            .ok_or("the file does not have the sections of an exchange file")?
            .1;
        let mut entities = BTreeMap::new();
        let mut parser = Parser::new(data);
        while parser.space().starts_with('#') {
            let Value::Id(id) = parser.value()? else { return Err("expected an entity".into()) };
            parser.consume('=')?;
            let entity = parser.entity()?;
            parser.consume(';')?;
            if entities.insert(id, entity).is_some() {
                return Err(format!("#{id} occurs twice").into());
            }
        }
        let rest = parser.space();
        if !rest.is_empty() {
            return Err(format!("expected an entity, found {rest:.40}").into());
        }
        let file = Self { entities };
        file.entities.values().flat_map(BTreeMap::values).flatten().try_for_each(|v| file.resolves(v))?;
        Ok(file)
    }

    /// Checks that every reference in a value names an entity.
    fn resolves(&self, value: &Value) -> Result<(), StepError> {
        match value {
            Value::Id(id) if !self.entities.contains_key(id) => Err(format!("#{id} does not exist").into()),
            Value::List(list) => list.iter().try_for_each(|v| self.resolves(v)),
            _ => Ok(()),
        }
    }

    /// Returns the solids of the file, each with a closed and oriented shell whose edges are on its
    /// faces.
    pub(crate) fn solids(&self) -> Result<Vec<StepSolid>, StepError> {
        self.of_type("MANIFOLD_SOLID_BREP").map(|(_, p)| self.solid(p)).collect()
    }

    /// Returns the placements of the solids of an assembly, in the order of the file.
    pub(crate) fn placements(&self) -> Result<Vec<StepPlacement>, StepError> {
        let shapes = self.of_type("CONTEXT_DEPENDENT_SHAPE_REPRESENTATION");
        shapes.map(|(_, p)| self.placement(p)).collect()
    }

    fn of_type(&self, name: &'static str) -> impl Iterator<Item = (u64, &Vec<Value>)> {
        self.entities.iter().filter_map(move |(id, entity)| Some((*id, entity.get(name)?)))
    }

    fn entity(&self, id: u64) -> Result<&Entity, StepError> {
        Ok(self.entities.get(&id).ok_or_else(|| format!("#{id} does not exist"))?)
    }

    /// Returns the first of these types that an entity has, with its parameters.
    fn get<'a>(&self, id: u64, types: &[&'a str]) -> Result<(&'a str, &[Value]), StepError> {
        let entity = self.entity(id)?;
        let typed = types.iter().find_map(|name| Some((*name, entity.get(*name)?.as_slice())));
        Ok(typed.ok_or_else(|| format!("#{id} is {:?}, not one of {types:?}", entity.keys()))?)
    }

    /// Returns the parameters of an entity of this type.
    fn only(&self, id: u64, name: &str) -> Result<&[Value], StepError> {
        self.get(id, &[name]).map(|(_, parameters)| parameters)
    }

    /// Returns one parameter of an entity of this type.
    fn parameter(&self, id: u64, name: &str, index: usize) -> Result<&Value, StepError> {
        parameter(self.only(id, name)?, index)
    }

    fn placement(&self, shape: &[Value]) -> Result<StepPlacement, StepError> {
        let definition = id(parameter(shape, 1)?)?;
        let occurrence = id(self.parameter(definition, "PRODUCT_DEFINITION_SHAPE", 2)?)?;
        let occurrence_name = text(self.parameter(occurrence, "NEXT_ASSEMBLY_USAGE_OCCURRENCE", 1)?)?;
        let relationship = id(parameter(shape, 0)?)?;
        let child = id(self.parameter(relationship, "REPRESENTATION_RELATIONSHIP", 2)?)?;
        let with_transformation = "REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION";
        let transformation = id(self.parameter(relationship, with_transformation, 0)?)?;
        let frame = |index| id(self.parameter(transformation, "ITEM_DEFINED_TRANSFORMATION", index)?);
        let (from, to) = (frame(2)?, frame(3)?);
        let items = list(self.parameter(child, "ADVANCED_BREP_SHAPE_REPRESENTATION", 1)?)?;
        let part = self.frame(from)?;
        if id(parameter(items, 0)?)? != from || part.origin != [0.0; 3] || part.z != [0.0, 0.0, 1.0] {
            let problem = "the transformation is not from the frame of the part";
            return Err(format!("{occurrence_name}: {problem}").into());
        }
        let name = text(self.parameter(id(parameter(items, 1)?)?, "MANIFOLD_SOLID_BREP", 0)?)?;
        if name != occurrence_name {
            return Err(format!("{occurrence_name} places {name}").into());
        }
        let frame = self.frame(to)?;
        Ok(StepPlacement { name, origin_mm: frame.origin, x: frame.x, z: frame.z })
    }

    fn solid(&self, brep: &[Value]) -> Result<StepSolid, StepError> {
        let name = text(parameter(brep, 0)?)?;
        self.has_millimetres()?;
        let shell = id(parameter(brep, 1)?)?;
        let faces = list(self.parameter(shell, "CLOSED_SHELL", 1)?)?;
        let mut uses: BTreeMap<u64, Vec<[u64; 2]>> = BTreeMap::new();
        let (mut loops, mut volume_mm3, mut has_splines) = (0, 0.0, false);
        for face in faces {
            let face = id(face)?;
            let parameters = self.only(face, "ADVANCED_FACE")?;
            let bounds = list(parameter(parameters, 1)?)?;
            let bounds: Vec<Vec<LoopEdge>> =
                bounds.iter().map(|b| self.bound(id(b)?)).collect::<Result<_, StepError>>()?;
            loops += bounds.len();
            for edge in bounds.iter().flatten() {
                uses.entry(edge.edge).or_default().push(edge.vertices);
            }
            let surface = self.surface(id(parameter(parameters, 2)?)?)?;
            let sense = if flag(parameter(parameters, 3)?)? { 1.0 } else { -1.0 };
            let integral = face_integral(&surface, sense, &bounds);
            volume_mm3 += integral.map_err(|e| format!("{name}, face #{face}: {e}"))?;
            has_splines |= matches!(surface, Surface::Spline(_));
        }
        for (edge, directions) in &uses {
            if !matches!(directions[..], [[a, b], [c, d]] if a == d && b == c) {
                let faces = directions.len();
                return Err(format!("{name}: edge #{edge} has {faces} faces, or equal directions").into());
            }
        }
        let vertices: BTreeSet<u64> = uses.values().flatten().flatten().copied().collect();
        // Euler-Poincaré: vertices - edges + 2 faces - loops = 2 - 2 genus.
        let positive = vertices.len() + 2 * faces.len();
        let twice_genus = (2 + uses.len() + loops).checked_sub(positive).filter(|n| n % 2 == 0);
        let twice_genus = twice_genus.ok_or_else(|| format!("{name}: the shell is not one surface"))?;
        Ok(StepSolid { name, faces: faces.len(), genus: twice_genus / 2, volume_mm3, has_splines })
    }

    /// Checks that every context of the file has millimetres and radians as units.
    fn has_millimetres(&self) -> Result<(), StepError> {
        let mut contexts = self.of_type("GLOBAL_UNIT_ASSIGNED_CONTEXT").peekable();
        if contexts.peek().is_none() {
            return Err("the file has no units".into());
        }
        let word = |w: &str| Value::Word(w.to_owned());
        for (_, parameters) in contexts {
            let units = list(parameter(parameters, 0)?)?;
            let unit = |index| self.only(id(parameter(units, index)?)?, "SI_UNIT");
            let (length, angle) = (unit(0)?, unit(1)?);
            if length != [word("MILLI"), word("METRE")] || angle != [word("$"), word("RADIAN")] {
                return Err(format!("units are {length:?} and {angle:?}").into());
            }
        }
        Ok(())
    }

    /// Returns the edges of a bound. Each starts where the previous one ends.
    fn bound(&self, bound: u64) -> Result<Vec<LoopEdge>, StepError> {
        let (_, parameters) = self.get(bound, &["FACE_OUTER_BOUND", "FACE_BOUND"])?;
        if !flag(parameter(parameters, 2)?)? {
            return Err(format!("#{bound} is reversed, which the writer never does").into());
        }
        let edges = list(self.parameter(id(parameter(parameters, 1)?)?, "EDGE_LOOP", 1)?)?;
        let edges: Vec<LoopEdge> =
            edges.iter().map(|e| self.loop_edge(id(e)?)).collect::<Result<_, StepError>>()?;
        for (edge, next) in edges.iter().zip(edges.iter().cycle().skip(1)) {
            if edge.vertices[1] != next.vertices[0] {
                return Err(format!("#{bound}: edge #{} does not meet #{}", edge.edge, next.edge).into());
            }
        }
        Ok(edges)
    }

    fn loop_edge(&self, oriented: u64) -> Result<LoopEdge, StepError> {
        let parameters = self.only(oriented, "ORIENTED_EDGE")?;
        let (edge, along) = (id(parameter(parameters, 3)?)?, flag(parameter(parameters, 4)?)?);
        let curve = self.only(edge, "EDGE_CURVE")?;
        let mut vertices = [id(parameter(curve, 1)?)?, id(parameter(curve, 2)?)?];
        let mut ends = [self.vertex(vertices[0])?, self.vertex(vertices[1])?];
        let mut arc = self.arc(id(parameter(curve, 3)?)?, flag(parameter(curve, 4)?)?, ends)?;
        if !along {
            vertices.reverse();
            ends.reverse();
            arc = arc.map(|a| LoopArc { start: a.start + a.sweep, sweep: -a.sweep, ..a });
        }
        Ok(LoopEdge { edge, vertices, ends, arc })
    }

    fn vertex(&self, vertex: u64) -> Result<Vec3, StepError> {
        self.point(id(self.parameter(vertex, "VERTEX_POINT", 1)?)?)
    }

    /// Returns the arc between two points of a circle, or `None` for a line through them.
    fn arc(&self, curve: u64, forward: bool, ends: [Vec3; 2]) -> Result<Option<LoopArc>, StepError> {
        let (kind, parameters) = self.get(curve, &["LINE", "CIRCLE"])?;
        if kind == "LINE" {
            let from = self.point(id(parameter(parameters, 1)?)?)?;
            let vector = id(parameter(parameters, 2)?)?;
            let along = self.direction(id(self.parameter(vector, "VECTOR", 1)?)?)?;
            let off = |p: Vec3| norm(cross(minus(p, from), along));
            let is_forward = dot(minus(ends[1], ends[0]), along) > 0.0;
            if off(ends[0]).max(off(ends[1])) > SAME_MM || is_forward != forward {
                let problem = "misses its ends, or runs from the last to the first";
                return Err(format!("line #{curve} {problem}").into());
            }
            return Ok(None);
        }
        let frame = self.frame(id(parameter(parameters, 1)?)?)?;
        let radius = real(parameter(parameters, 2)?)?;
        if frame.z != [0.0, 0.0, 1.0] {
            return Err(format!("circle #{curve} is not about +z").into());
        }
        let angle = |p: Vec3| f64::atan2(p[1] - frame.origin[1], p[0] - frame.origin[0]);
        let off = |p: Vec3| {
            let from = minus(p, frame.origin);
            (f64::hypot(from[0], from[1]) - radius).abs().max(from[2].abs())
        };
        if !(radius > 0.0 && off(ends[0]).max(off(ends[1])) <= SAME_MM) {
            return Err(format!("circle #{curve} of radius {radius} misses its ends").into());
        }
        let (start, end) = (angle(ends[0]), angle(ends[1]));
        let turn = if forward { end - start } else { start - end }.rem_euclid(std::f64::consts::TAU);
        let sweep = if forward { turn } else { -turn };
        Ok(Some(LoopArc { centre: frame.origin, radius, start, sweep }))
    }

    fn surface(&self, surface: u64) -> Result<Surface, StepError> {
        let types = ["PLANE", "CYLINDRICAL_SURFACE", "CONICAL_SURFACE", "B_SPLINE_SURFACE_WITH_KNOTS"];
        let (kind, parameters) = self.get(surface, &types)?;
        let frame = || self.frame(id(parameter(parameters, 1)?)?);
        let number = |index| real(parameter(parameters, index)?);
        Ok(match kind {
            "PLANE" => Surface::Plane(frame()?),
            "CYLINDRICAL_SURFACE" => Surface::Cylinder(frame()?, number(2)?),
            "CONICAL_SURFACE" => Surface::Cone(frame()?, number(2)?, number(3)?),
            _ => Surface::Spline(Box::new(self.spline(surface, parameters)?)),
        })
    }

    fn spline(&self, surface: u64, with_knots: &[Value]) -> Result<Spline, StepError> {
        let entity = self.entity(surface)?;
        // A rational surface is a complex entity; a plain one has all parameters in one list, after
        // its name.
        let (shape, first, first_knots) = match entity.get("B_SPLINE_SURFACE") {
            Some(shape) => (shape.as_slice(), 0, 0),
            None => (with_knots, 1, 8),
        };
        let degree = |i: usize| count(parameter(shape, first + i)?);
        let knots = |i: usize| {
            let at = first_knots + i;
            repeated(parameter(with_knots, at)?, parameter(with_knots, at + 2)?)
        };
        let poles = rows(parameter(shape, first + 2)?, |v| self.point(id(v)?))?;
        let weights = match entity.get("RATIONAL_B_SPLINE_SURFACE") {
            Some(weights) => rows(parameter(weights, 0)?, real)?,
            None => poles.iter().map(|row| vec![1.0; row.len()]).collect(),
        };
        Spline::new([degree(0)?, degree(1)?], [knots(0)?, knots(1)?], poles, weights)
    }

    fn frame(&self, placement: u64) -> Result<Frame, StepError> {
        let reference = |index| id(self.parameter(placement, "AXIS2_PLACEMENT_3D", index)?);
        let frame = Frame {
            origin: self.point(reference(1)?)?,
            z: self.direction(reference(2)?)?,
            x: self.direction(reference(3)?)?,
        };
        let is_right = dot(frame.x, frame.z).abs() < MAX_COSINE;
        if is_right { Ok(frame) } else { Err(format!("the axes of #{placement} are not orthogonal").into()) }
    }

    fn point(&self, point: u64) -> Result<Vec3, StepError> {
        coordinates(self.parameter(point, "CARTESIAN_POINT", 1)?)
    }

    fn direction(&self, direction: u64) -> Result<Vec3, StepError> {
        let unit = coordinates(self.parameter(direction, "DIRECTION", 1)?)?;
        let is_unit = (norm(unit) - 1.0).abs() < MAX_LENGTH_ERROR;
        if is_unit { Ok(unit) } else { Err(format!("#{direction} is not a unit vector").into()) }
    }
}
