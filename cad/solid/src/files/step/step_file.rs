//! A reader of the STEP files that this crate writes, for tests only: it computes topology,
//! geometry and volume from the text alone.
//!
//! It depends on the standard library only, so that it shares no code with the writer, and an error
//! there cannot cancel itself here. `tests/harness` includes this file, too. It supports the kinds
//! of entity that the writer uses, walls about vertical axes, and refuses everything else.

// Only tests read with it; the bytes that the writer makes do not depend on these functions.
#![allow(clippy::disallowed_methods)]

use std::collections::BTreeMap;

/// Largest distance, mm, between coordinates that must agree.
const SAME_MM: f64 = 1e-7;

type Vec3 = [f64; 3];

/// A parameter of an entity.
#[derive(Clone, Debug, PartialEq)]
enum Value {
    Id(u64),
    Real(f64),
    Text(String),
    Word(String),
    List(Vec<Value>),
}

/// The parameters of an entity, by its type; a complex entity has several types.
type Entity = BTreeMap<String, Vec<Value>>;

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

/// A solid in its place in an assembly.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct StepPlacement {
    /// Name of the solid.
    pub(crate) name: String,
    /// Origin and directions of the x and z axes of its frame.
    pub(crate) origin_mm: Vec3,
    pub(crate) x: Vec3,
    pub(crate) z: Vec3,
}

/// A frame: its origin, and the directions of its axes.
#[derive(Clone, Copy)]
struct Frame {
    origin: Vec3,
    x: Vec3,
    z: Vec3,
}

/// An edge along a loop, from its first to its last point.
#[derive(Clone, Copy)]
struct LoopEdge {
    /// Numbers of the edge and of its vertices.
    edge: u64,
    vertices: [u64; 2],
    ends: [Vec3; 2],
    arc: Option<LoopArc>,
}

/// The arc of an edge: centre, radius, first angle, and signed angle about +z.
#[derive(Clone, Copy)]
struct LoopArc {
    centre: Vec3,
    radius: f64,
    start: f64,
    sweep: f64,
}

/// The surface of a face.
enum Surface {
    Plane(Frame),
    Cylinder(Frame, f64),
    Cone(Frame, f64, f64),
    Spline(Box<Spline>),
}

/// A rational B-spline surface.
struct Spline {
    degrees: [usize; 2],
    knots: [Vec<f64>; 2],
    poles: Vec<Vec<Vec3>>,
    weights: Vec<Vec<f64>>,
}

impl StepFile {
    /// Parses a file. Every reference must resolve.
    pub(crate) fn parse(text: &str) -> Result<Self, String> {
        let data = text
            .strip_prefix("ISO-10303-21;\nHEADER;")
            .and_then(|rest| rest.strip_suffix("ENDSEC;\nEND-ISO-10303-21;\n"))
            .and_then(|rest| rest.split_once("\nDATA;\n"))
            .ok_or("the file does not have the sections of an exchange file")?
            .1;
        let mut entities = BTreeMap::new();
        let mut parser = Parser { rest: data };
        while parser.space().starts_with('#') {
            let Value::Id(id) = parser.value()? else { return Err("expected an entity".to_owned()) };
            parser.expect('=')?;
            let entity = parser.entity()?;
            parser.expect(';')?;
            if entities.insert(id, entity).is_some() {
                return Err(format!("#{id} occurs twice"));
            }
        }
        if !parser.space().is_empty() {
            return Err(format!("expected an entity, found {:.40}", parser.rest));
        }
        let file = Self { entities };
        file.entities.values().flat_map(BTreeMap::values).flatten().try_for_each(|v| file.resolves(v))?;
        Ok(file)
    }

    fn resolves(&self, value: &Value) -> Result<(), String> {
        match value {
            Value::Id(id) if !self.entities.contains_key(id) => Err(format!("#{id} does not exist")),
            Value::List(list) => list.iter().try_for_each(|v| self.resolves(v)),
            _ => Ok(()),
        }
    }

    /// The solids of the file, each of them checked: a closed, oriented shell with its edges on its
    /// faces.
    pub(crate) fn solids(&self) -> Result<Vec<StepSolid>, String> {
        self.of_type("MANIFOLD_SOLID_BREP").map(|(_, p)| self.solid(p)).collect()
    }

    /// The places of the solids of an assembly, in the order of the file.
    pub(crate) fn placements(&self) -> Result<Vec<StepPlacement>, String> {
        let shapes = self.of_type("CONTEXT_DEPENDENT_SHAPE_REPRESENTATION");
        shapes.map(|(_, p)| self.placement(p)).collect()
    }

    fn of_type(&self, name: &'static str) -> impl Iterator<Item = (u64, &Vec<Value>)> {
        self.entities.iter().filter_map(move |(id, entity)| Some((*id, entity.get(name)?)))
    }

    /// The parameters of an entity of one of these types, with that type.
    fn get<'a>(&self, id: u64, types: &[&'a str]) -> Result<(&'a str, &[Value]), String> {
        let entity = &self.entities[&id];
        let found = types.iter().find_map(|name| Some((*name, entity.get(*name)?.as_slice())));
        found.ok_or_else(|| format!("#{id} is {:?}, not one of {types:?}", entity.keys()))
    }

    fn only(&self, id: u64, name: &str) -> Result<&[Value], String> {
        self.get(id, &[name]).map(|(_, parameters)| parameters)
    }

    fn placement(&self, shape: &[Value]) -> Result<StepPlacement, String> {
        let occurrence = id(&self.only(id(&shape[1])?, "PRODUCT_DEFINITION_SHAPE")?[2])?;
        let occurrence_name = text(&self.only(occurrence, "NEXT_ASSEMBLY_USAGE_OCCURRENCE")?[1])?;
        let relationship = id(&shape[0])?;
        let child = id(&self.only(relationship, "REPRESENTATION_RELATIONSHIP")?[2])?;
        let transformation =
            id(&self.only(relationship, "REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION")?[0])?;
        let frames = self.only(transformation, "ITEM_DEFINED_TRANSFORMATION")?;
        let representation = self.only(child, "ADVANCED_BREP_SHAPE_REPRESENTATION")?;
        let items = list(&representation[1])?;
        let own = self.frame(id(&frames[2])?)?;
        if id(&items[0])? != id(&frames[2])? || own.origin != [0.0; 3] || own.z != [0.0, 0.0, 1.0] {
            return Err(format!("{occurrence_name}: the transformation is not from the frame of the part"));
        }
        let name = text(&self.only(id(&items[1])?, "MANIFOLD_SOLID_BREP")?[0])?;
        if name != occurrence_name {
            return Err(format!("{occurrence_name} places {name}"));
        }
        let frame = self.frame(id(&frames[3])?)?;
        Ok(StepPlacement { name, origin_mm: frame.origin, x: frame.x, z: frame.z })
    }

    fn solid(&self, brep: &[Value]) -> Result<StepSolid, String> {
        let name = text(&brep[0])?;
        self.has_millimetres()?;
        let shell = id(&brep[1])?;
        let faces = list(&self.only(shell, "CLOSED_SHELL")?[1])?;
        let mut uses: BTreeMap<u64, Vec<[u64; 2]>> = BTreeMap::new();
        let (mut loops, mut volume_mm3, mut has_splines) = (0, 0.0, false);
        for face in faces {
            let face = id(face)?;
            let parameters = self.only(face, "ADVANCED_FACE")?;
            let bounds: Vec<Vec<LoopEdge>> =
                list(&parameters[1])?.iter().map(|b| self.bound(id(b)?)).collect::<Result<_, _>>()?;
            loops += bounds.len();
            for edge in bounds.iter().flatten() {
                uses.entry(edge.edge).or_default().push(edge.vertices);
            }
            let surface = self.surface(id(&parameters[2])?)?;
            let sense = if flag(&parameters[3])? { 1.0 } else { -1.0 };
            let integral = face_integral(&surface, sense, &bounds);
            volume_mm3 += integral.map_err(|e| format!("{name}, face #{face}: {e}"))?;
            has_splines |= matches!(surface, Surface::Spline(_));
        }
        for (edge, directions) in &uses {
            if !matches!(directions[..], [[a, b], [c, d]] if a == d && b == c) {
                return Err(format!(
                    "{name}: edge #{edge} has {} faces, or equal directions",
                    directions.len()
                ));
            }
        }
        let vertices: std::collections::BTreeSet<u64> = uses.values().flatten().flatten().copied().collect();
        // Euler-Poincaré: vertices - edges + 2 faces - loops = 2 - 2 genus.
        let positive = vertices.len() + 2 * faces.len();
        let twice = (2 + uses.len() + loops).checked_sub(positive);
        let genus = twice.filter(|n| n % 2 == 0).ok_or(format!("{name}: the shell is not one surface"))? / 2;
        Ok(StepSolid { name, faces: faces.len(), genus, volume_mm3, has_splines })
    }

    /// Every context of the file counts in millimetres and radians.
    fn has_millimetres(&self) -> Result<(), String> {
        let mut contexts = self.of_type("GLOBAL_UNIT_ASSIGNED_CONTEXT").peekable();
        if contexts.peek().is_none() {
            return Err("the file has no units".to_owned());
        }
        let word = |w: &str| Value::Word(w.to_owned());
        for (_, parameters) in contexts {
            let units = list(&parameters[0])?.iter().map(id).collect::<Result<Vec<_>, _>>()?;
            let length = self.only(units[0], "SI_UNIT")?;
            let angle = self.only(units[1], "SI_UNIT")?;
            if length != [word("MILLI"), word("METRE")] || angle != [word("$"), word("RADIAN")] {
                return Err(format!("units are {length:?} and {angle:?}"));
            }
        }
        Ok(())
    }

    /// The edges of a bound, each of which must start where the one before ends.
    fn bound(&self, bound: u64) -> Result<Vec<LoopEdge>, String> {
        let (_, parameters) = self.get(bound, &["FACE_OUTER_BOUND", "FACE_BOUND"])?;
        if !flag(&parameters[2])? {
            return Err(format!("#{bound} is reversed, which the writer never does"));
        }
        let edges = list(&self.only(id(&parameters[1])?, "EDGE_LOOP")?[1])?;
        let edges: Vec<LoopEdge> = edges.iter().map(|e| self.loop_edge(id(e)?)).collect::<Result<_, _>>()?;
        for (edge, next) in edges.iter().zip(edges.iter().cycle().skip(1)) {
            if edge.vertices[1] != next.vertices[0] {
                return Err(format!("#{bound}: edge #{} does not meet #{}", edge.edge, next.edge));
            }
        }
        Ok(edges)
    }

    fn loop_edge(&self, oriented: u64) -> Result<LoopEdge, String> {
        let parameters = self.only(oriented, "ORIENTED_EDGE")?;
        let (edge, along) = (id(&parameters[3])?, flag(&parameters[4])?);
        let curve = self.only(edge, "EDGE_CURVE")?;
        let mut vertices = [id(&curve[1])?, id(&curve[2])?];
        let mut ends = [self.vertex(vertices[0])?, self.vertex(vertices[1])?];
        let mut arc = self.arc(id(&curve[3])?, flag(&curve[4])?, ends)?;
        if !along {
            vertices.reverse();
            ends.reverse();
            arc = arc.map(|a| LoopArc { start: a.start + a.sweep, sweep: -a.sweep, ..a });
        }
        Ok(LoopEdge { edge, vertices, ends, arc })
    }

    fn vertex(&self, vertex: u64) -> Result<Vec3, String> {
        self.point(id(&self.only(vertex, "VERTEX_POINT")?[1])?)
    }

    /// The arc between two points of a circle, or `None` for a line through them.
    fn arc(&self, curve: u64, forward: bool, ends: [Vec3; 2]) -> Result<Option<LoopArc>, String> {
        let (kind, parameters) = self.get(curve, &["LINE", "CIRCLE"])?;
        if kind == "LINE" {
            let from = self.point(id(&parameters[1])?)?;
            let vector = self.only(id(&parameters[2])?, "VECTOR")?;
            let along = self.direction(id(&vector[1])?)?;
            let off = |p: Vec3| norm(cross(minus(p, from), along));
            let is_forward = dot(minus(ends[1], ends[0]), along) > 0.0;
            if off(ends[0]).max(off(ends[1])) > SAME_MM || is_forward != forward {
                return Err(format!("line #{curve} misses its ends, or runs from the last to the first"));
            }
            return Ok(None);
        }
        let (frame, radius) = (self.frame(id(&parameters[1])?)?, real(&parameters[2])?);
        if frame.z != [0.0, 0.0, 1.0] {
            return Err(format!("circle #{curve} is not about +z"));
        }
        let angle = |p: Vec3| f64::atan2(p[1] - frame.origin[1], p[0] - frame.origin[0]);
        let off = |p: Vec3| {
            let from = minus(p, frame.origin);
            (f64::hypot(from[0], from[1]) - radius).abs().max(from[2].abs())
        };
        if !(radius > 0.0 && off(ends[0]).max(off(ends[1])) <= SAME_MM) {
            return Err(format!("circle #{curve} of radius {radius} misses its ends"));
        }
        let (start, end) = (angle(ends[0]), angle(ends[1]));
        let turn = if forward { end - start } else { start - end }.rem_euclid(std::f64::consts::TAU);
        let sweep = if forward { turn } else { -turn };
        Ok(Some(LoopArc { centre: frame.origin, radius, start, sweep }))
    }

    fn surface(&self, surface: u64) -> Result<Surface, String> {
        let types = ["PLANE", "CYLINDRICAL_SURFACE", "CONICAL_SURFACE", "B_SPLINE_SURFACE_WITH_KNOTS"];
        let (kind, parameters) = self.get(surface, &types)?;
        Ok(match kind {
            "PLANE" => Surface::Plane(self.frame(id(&parameters[1])?)?),
            "CYLINDRICAL_SURFACE" => {
                Surface::Cylinder(self.frame(id(&parameters[1])?)?, real(&parameters[2])?)
            }
            "CONICAL_SURFACE" => {
                let (radius, half_angle) = (real(&parameters[2])?, real(&parameters[3])?);
                Surface::Cone(self.frame(id(&parameters[1])?)?, radius, half_angle)
            }
            _ => Surface::Spline(Box::new(self.spline(&self.entities[&surface], parameters)?)),
        })
    }

    fn spline(&self, entity: &Entity, with_knots: &[Value]) -> Result<Spline, String> {
        // A rational surface is a complex entity; a plain one has all parameters in one list, after
        // its name.
        let (shape, knots) = match entity.get("B_SPLINE_SURFACE") {
            Some(shape) => (&shape[..3], &with_knots[..4]),
            None => (&with_knots[1..4], &with_knots[8..12]),
        };
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
        let count = |v: &Value| real(v).map(|n| n as usize);
        let knots_of = |multiplicities: &Value, values: &Value| -> Result<Vec<f64>, String> {
            let pairs = list(multiplicities)?.iter().zip(list(values)?);
            let repeated = pairs.map(|(n, k)| Ok(vec![real(k)?; count(n)?]));
            Ok(repeated.collect::<Result<Vec<_>, String>>()?.concat())
        };
        let poles = rows(&shape[2], |v| self.point(id(v)?))?;
        let weights = match entity.get("RATIONAL_B_SPLINE_SURFACE") {
            Some(weights) => rows(&weights[0], real)?,
            None => poles.iter().map(|row| vec![1.0; row.len()]).collect(),
        };
        let spline = Spline {
            degrees: [count(&shape[0])?, count(&shape[1])?],
            knots: [knots_of(&knots[0], &knots[2])?, knots_of(&knots[1], &knots[3])?],
            poles,
            weights,
        };
        let sizes = [spline.poles.len(), spline.poles[0].len()];
        let fits = |i: usize| spline.knots[i].len() == sizes[i] + spline.degrees[i] + 1;
        if fits(0) && fits(1) { Ok(spline) } else { Err("a spline has a wrong number of knots".to_owned()) }
    }

    fn frame(&self, placement: u64) -> Result<Frame, String> {
        let p = self.only(placement, "AXIS2_PLACEMENT_3D")?;
        let frame = Frame {
            origin: self.point(id(&p[1])?)?,
            z: self.direction(id(&p[2])?)?,
            x: self.direction(id(&p[3])?)?,
        };
        let is_right = dot(frame.x, frame.z).abs() < 1e-9;
        if is_right { Ok(frame) } else { Err(format!("the axes of #{placement} are not orthogonal")) }
    }

    fn point(&self, point: u64) -> Result<Vec3, String> {
        coordinates(&self.only(point, "CARTESIAN_POINT")?[1])
    }

    fn direction(&self, direction: u64) -> Result<Vec3, String> {
        let unit = coordinates(&self.only(direction, "DIRECTION")?[1])?;
        let is_unit = (norm(unit) - 1.0).abs() < 1e-12;
        if is_unit { Ok(unit) } else { Err(format!("#{direction} is not a unit vector")) }
    }
}

/// The integral of `z n_z` over a face, with `n` its outward normal: summed over all faces, the
/// volume of the solid.
///
/// Checks that the loops are on the surface and run counter-clockwise about the outward normal,
/// holes clockwise.
fn face_integral(surface: &Surface, sense: f64, bounds: &[Vec<LoopEdge>]) -> Result<f64, String> {
    let samples = |edge: &LoopEdge| (0..5).map(|k| edge.point(f64::from(k) / 4.0)).collect::<Vec<_>>();
    let mut points = bounds.iter().flatten().flat_map(samples);
    if let Some(off) = points.find(|p| !surface.contains(*p)) {
        return Err(format!("an edge at {off:?} leaves the surface"));
    }
    let outline = &bounds[0];
    for (i, edges) in bounds.iter().enumerate() {
        let polygon: Vec<Vec3> =
            edges.iter().flat_map(|e| (0..8).map(|k| e.point(f64::from(k) / 8.0))).collect();
        let turn = dot(area_vector(&polygon), surface.normal(outline)) * sense;
        if (turn > 0.0) != (i == 0) {
            return Err("a loop runs against the outward normal".to_owned());
        }
    }
    match surface {
        // Its normal is horizontal.
        Surface::Cylinder(..) => Ok(0.0),
        Surface::Plane(frame) if frame.z[2].abs() > 1.0 - 1e-12 => {
            Ok(frame.origin[2] * bounds.iter().flatten().map(LoopEdge::swept).sum::<f64>())
        }
        Surface::Plane(_) => bounds.iter().map(|edges| polygon_integral(edges)).sum(),
        Surface::Cone(..) => cone_integral(outline),
        Surface::Spline(spline) => spline.check_boundary(outline).map(|()| sense * spline.integral()),
    }
}

/// The integral over a plane polygon, in triangles from its first corner.
fn polygon_integral(edges: &[LoopEdge]) -> Result<f64, String> {
    if edges.iter().any(|e| e.arc.is_some()) {
        return Err("an arc in a slanted plane is not supported".to_owned());
    }
    let first = edges[0].ends[0];
    let triangle = |e: &LoopEdge| {
        let [p, q] = e.ends;
        cross(minus(p, first), minus(q, first))[2] / 2.0 * (first[2] + p[2] + q[2]) / 3.0
    };
    Ok(edges.iter().map(triangle).sum())
}

/// The integral over a cone between two arcs: `-sweep ∫ z r dr`, a polynomial of degree two for
/// Simpson's rule.
fn cone_integral(outline: &[LoopEdge]) -> Result<f64, String> {
    let arcs: Vec<LoopArc> = outline.iter().filter_map(|e| e.arc).collect();
    let [a, b] = arcs[..] else { return Err("a cone without two arcs is not supported".to_owned()) };
    let (lower, upper) = if a.centre[2] < b.centre[2] { (a, b) } else { (b, a) };
    if (lower.sweep + upper.sweep).abs() > 1e-9 {
        return Err("the arcs of a cone have different angles".to_owned());
    }
    let at = |share: f64| {
        let mix = |x: f64, y: f64| x + (y - x) * share;
        mix(lower.centre[2], upper.centre[2]) * mix(lower.radius, upper.radius)
    };
    let mean = (at(0.0) + 4.0 * at(0.5) + at(1.0)) / 6.0;
    Ok(-lower.sweep * (upper.radius - lower.radius) * mean)
}

impl LoopEdge {
    /// The point at a share of the edge.
    fn point(&self, share: f64) -> Vec3 {
        match &self.arc {
            Some(arc) => {
                let angle = arc.start + arc.sweep * share;
                let [x, y, z] = arc.centre;
                [x + arc.radius * angle.cos(), y + arc.radius * angle.sin(), z]
            }
            None => std::array::from_fn(|i| self.ends[0][i] + (self.ends[1][i] - self.ends[0][i]) * share),
        }
    }

    /// Half of the integral of `x dy - y dx`.
    fn swept(&self) -> f64 {
        let [p, q] = self.ends;
        let bulge = self.arc.map_or(0.0, |a| a.radius.powi(2) * (a.sweep - a.sweep.sin()));
        (p[0] * q[1] - q[0] * p[1] + bulge) / 2.0
    }

    /// The distance of a point from the line or circle of the edge.
    fn distance(&self, p: Vec3) -> f64 {
        match &self.arc {
            Some(arc) => {
                let from = minus(p, arc.centre);
                f64::hypot(f64::hypot(from[0], from[1]) - arc.radius, from[2])
            }
            None => {
                let along = minus(self.ends[1], self.ends[0]);
                norm(cross(minus(p, self.ends[0]), along)) / norm(along)
            }
        }
    }
}

impl Surface {
    /// Whether a point is on the surface. A spline is compared with its loop instead
    /// ([`Spline::check_boundary`]).
    fn contains(&self, p: Vec3) -> bool {
        let off = match self {
            Self::Plane(frame) => dot(minus(p, frame.origin), frame.z),
            Self::Cylinder(frame, radius) => frame.radial(p).1 - radius,
            Self::Cone(frame, radius, half_angle) => {
                let along = dot(minus(p, frame.origin), frame.z);
                (frame.radial(p).1 - radius - along * half_angle.tan()) * half_angle.cos()
            }
            Self::Spline(_) => 0.0,
        };
        off.abs() <= SAME_MM
    }

    /// The normal of the surface, in the middle of the first arc of a loop.
    fn normal(&self, outline: &[LoopEdge]) -> Vec3 {
        let middle = outline.iter().find(|e| e.arc.is_some()).unwrap_or(&outline[0]).point(0.5);
        match self {
            Self::Plane(frame) => frame.z,
            Self::Cylinder(frame, _) => frame.radial(middle).0,
            Self::Cone(frame, _, half_angle) => {
                let radial = frame.radial(middle).0;
                std::array::from_fn(|i| radial[i] * half_angle.cos() - frame.z[i] * half_angle.sin())
            }
            Self::Spline(spline) => {
                let middle = |k: &[f64]| f64::midpoint(k[0], k[k.len() - 1]);
                let [_, du, dv] = spline.at(middle(&spline.knots[0]), middle(&spline.knots[1]));
                cross(du, dv)
            }
        }
    }
}

impl Frame {
    /// The unit vector from the axis to a point, and its distance.
    fn radial(&self, p: Vec3) -> (Vec3, f64) {
        let from = minus(p, self.origin);
        let along = dot(from, self.z);
        let across: Vec3 = std::array::from_fn(|i| from[i] - along * self.z[i]);
        let distance = norm(across);
        (across.map(|v| v / distance), distance)
    }
}

impl Spline {
    /// Position and both derivatives.
    fn at(&self, u: f64, v: f64) -> [Vec3; 3] {
        let (mut sums, mut weights) = ([[0.0; 3]; 3], [0.0; 3]);
        for (i, row) in self.poles.iter().enumerate() {
            for (j, pole) in row.iter().enumerate() {
                let ([nu, du], [nv, dv]) = (self.basis(0, i, u), self.basis(1, j, v));
                for (k, n) in [nu * nv, du * nv, nu * dv].into_iter().enumerate() {
                    let weight = n * self.weights[i][j];
                    weights[k] += weight;
                    (0..3).for_each(|axis| sums[k][axis] += weight * pole[axis]);
                }
            }
        }
        let position = sums[0].map(|x| x / weights[0]);
        let derivative = |k: usize| -> Vec3 {
            std::array::from_fn(|axis| (sums[k][axis] - weights[k] * position[axis]) / weights[0])
        };
        [position, derivative(1), derivative(2)]
    }

    /// A basis function in one direction and its derivative (Cox, de Boor).
    fn basis(&self, direction: usize, i: usize, t: f64) -> [f64; 2] {
        let (knots, degree) = (&self.knots[direction], self.degrees[direction]);
        let lower = |i: usize| de_boor(knots, degree - 1, i, t);
        let term = |i: usize| {
            let width = knots[i + degree] - knots[i];
            if width > 0.0 { degree as f64 / width * lower(i) } else { 0.0 }
        };
        [de_boor(knots, degree, i, t), term(i) - term(i + 1)]
    }

    /// The integral of `z n_z`, by Gauss's rule of five points on each span.
    fn integral(&self) -> f64 {
        const GAUSS: [(f64, f64); 5] = [
            (-0.906_179_845_938_664, 0.236_926_885_056_189_1),
            (-0.538_469_310_105_683, 0.478_628_670_499_366_5),
            (0.0, 0.568_888_888_888_888_9),
            (0.538_469_310_105_683, 0.478_628_670_499_366_5),
            (0.906_179_845_938_664, 0.236_926_885_056_189_1),
        ];
        let stations = |knots: &[f64]| -> Vec<(f64, f64)> {
            let spans = knots.windows(2).filter(|k| k[1] > k[0]);
            let nodes = |k: &[f64]| {
                let (middle, half) = (f64::midpoint(k[0], k[1]), (k[1] - k[0]) / 2.0);
                GAUSS.map(|(x, w)| (middle + half * x, half * w))
            };
            spans.flat_map(nodes).collect()
        };
        let across = stations(&self.knots[1]);
        let along = stations(&self.knots[0]);
        let value = |(u, wu): &(f64, f64)| -> f64 {
            let inner = across.iter().map(|(v, wv)| {
                let [position, du, dv] = self.at(*u, *v);
                wv * position[2] * cross(du, dv)[2]
            });
            wu * inner.sum::<f64>()
        };
        along.iter().map(value).sum()
    }

    /// The four boundary curves of the surface are the edges of the loop.
    fn check_boundary(&self, outline: &[LoopEdge]) -> Result<(), String> {
        let ends = |k: &[f64]| [k[0], k[k.len() - 1]];
        let ([u0, u1], [v0, v1]) = (ends(&self.knots[0]), ends(&self.knots[1]));
        for k in 0..=16 {
            let share = f64::from(k) / 16.0;
            let (u, v) = (u0 + (u1 - u0) * share, v0 + (v1 - v0) * share);
            for (u, v) in [(u, v0), (u, v1), (u0, v), (u1, v)] {
                let p = self.at(u, v)[0];
                if outline.iter().all(|edge| edge.distance(p) > SAME_MM) {
                    return Err(format!("the boundary of a spline at {p:?} is not an edge"));
                }
            }
        }
        Ok(())
    }
}

fn de_boor(knots: &[f64], degree: usize, i: usize, t: f64) -> f64 {
    let last = knots[knots.len() - 1];
    if degree == 0 {
        let inside = knots[i] <= t && (t < knots[i + 1] || (t == last && knots[i + 1] == last));
        return f64::from(u8::from(inside && knots[i] < knots[i + 1]));
    }
    let share = |from: f64, to: f64, value: f64| if to > from { value / (to - from) } else { 0.0 };
    share(knots[i], knots[i + degree], t - knots[i]) * de_boor(knots, degree - 1, i, t)
        + share(knots[i + 1], knots[i + degree + 1], knots[i + degree + 1] - t)
            * de_boor(knots, degree - 1, i + 1, t)
}

fn area_vector(polygon: &[Vec3]) -> Vec3 {
    let mut sum = [0.0; 3];
    for (p, q) in polygon.iter().zip(polygon.iter().cycle().skip(1)) {
        let c = cross(minus(*p, polygon[0]), minus(*q, polygon[0]));
        (0..3).for_each(|i| sum[i] += c[i] / 2.0);
    }
    sum
}

fn minus(a: Vec3, b: Vec3) -> Vec3 {
    std::array::from_fn(|i| a[i] - b[i])
}

fn dot(a: Vec3, b: Vec3) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

fn cross(a: Vec3, b: Vec3) -> Vec3 {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn norm(a: Vec3) -> f64 {
    dot(a, a).sqrt()
}

fn id(value: &Value) -> Result<u64, String> {
    if let Value::Id(id) = value { Ok(*id) } else { Err(format!("{value:?} is not a reference")) }
}

fn real(value: &Value) -> Result<f64, String> {
    if let Value::Real(x) = value { Ok(*x) } else { Err(format!("{value:?} is not a number")) }
}

fn text(value: &Value) -> Result<String, String> {
    if let Value::Text(text) = value { Ok(text.clone()) } else { Err(format!("{value:?} is not a string")) }
}

fn list(value: &Value) -> Result<&[Value], String> {
    if let Value::List(list) = value { Ok(list) } else { Err(format!("{value:?} is not a list")) }
}

fn flag(value: &Value) -> Result<bool, String> {
    match value {
        Value::Word(word) if word == "T" => Ok(true),
        Value::Word(word) if word == "F" => Ok(false),
        other => Err(format!("{other:?} is not a logical value")),
    }
}

fn coordinates(value: &Value) -> Result<Vec3, String> {
    let numbers = list(value)?.iter().map(real).collect::<Result<Vec<_>, _>>()?;
    numbers.try_into().map_err(|_| "a point does not have three coordinates".to_owned())
}

fn rows<T>(value: &Value, read: impl Fn(&Value) -> Result<T, String>) -> Result<Vec<Vec<T>>, String> {
    list(value)?.iter().map(|row| list(row)?.iter().map(&read).collect()).collect()
}

/// A parser of the data section.
struct Parser<'a> {
    rest: &'a str,
}

impl<'a> Parser<'a> {
    /// The rest after white space.
    fn space(&mut self) -> &'a str {
        self.rest = self.rest.trim_start();
        self.rest
    }

    fn expect(&mut self, c: char) -> Result<(), String> {
        self.rest =
            self.space().strip_prefix(c).ok_or_else(|| format!("expected {c}, found {:.40}", self.rest))?;
        Ok(())
    }

    /// The longest prefix of such characters.
    fn take(&mut self, accepts: impl Fn(char) -> bool) -> &'a str {
        let (taken, rest) = self.rest.split_at(self.rest.find(|c| !accepts(c)).unwrap_or(self.rest.len()));
        self.rest = rest;
        taken
    }

    /// A simple or complex entity.
    fn entity(&mut self) -> Result<Entity, String> {
        let is_complex = self.space().starts_with('(');
        if is_complex {
            self.expect('(')?;
        }
        let mut entity = Entity::new();
        while !entity.is_empty() && !is_complex || !self.space().starts_with(')') {
            let name = self.take(|c| c.is_ascii_uppercase() || c.is_ascii_digit() || c == '_');
            if name.is_empty() {
                return Err(format!("expected an entity, found {:.40}", self.rest));
            }
            let Value::List(parameters) = self.value()? else {
                return Err(format!("{name} has no parameters"));
            };
            entity.insert(name.to_owned(), parameters);
            if !is_complex {
                return Ok(entity);
            }
        }
        self.expect(')').map(|()| entity)
    }

    fn value(&mut self) -> Result<Value, String> {
        let first = self.space().chars().next().ok_or("expected a value, found the end")?;
        match first {
            '#' => {
                self.expect('#')?;
                let digits = self.take(|c| c.is_ascii_digit());
                digits.parse().map(Value::Id).map_err(|_| format!("#{digits} is not a number"))
            }
            '(' => self.list(),
            '\'' => self.string(),
            '$' | '*' => self.expect(first).map(|()| Value::Word(first.to_string())),
            '.' => {
                self.expect('.')?;
                let word = self.take(|c| c.is_ascii_uppercase() || c.is_ascii_digit() || c == '_');
                self.expect('.').map(|()| Value::Word(word.to_owned()))
            }
            c if c.is_ascii_uppercase() => {
                // A typed value, such as LENGTH_MEASURE(1.E-7).
                self.take(|c| c.is_ascii_uppercase() || c == '_');
                self.list()
            }
            _ => {
                let number = self.take(|c| c.is_ascii_digit() || "+-.E".contains(c));
                number.parse().map(Value::Real).map_err(|_| format!("{number:?} is not a number"))
            }
        }
    }

    fn list(&mut self) -> Result<Value, String> {
        self.expect('(')?;
        let mut values = Vec::new();
        while !self.space().starts_with(')') {
            if !values.is_empty() {
                self.expect(',')?;
            }
            values.push(self.value()?);
        }
        self.expect(')').map(|()| Value::List(values))
    }

    fn string(&mut self) -> Result<Value, String> {
        let mut text = String::new();
        loop {
            self.expect('\'')?;
            text += self.take(|c| c != '\'');
            self.expect('\'')?;
            if !self.rest.starts_with('\'') {
                return Ok(Value::Text(text));
            }
            text.push('\'');
        }
    }
}
