//! Built parts: meshes without copies, and the files of a set.

use std::sync::Arc;

use numpy::ndarray::ArrayView2;
use numpy::{PyArray2, PyArrayMethods};
use pinswitch::diagnostic::{Diagnostic, codes};
use pinswitch::solid::mesh::{Mesh, Point3};
use pinswitch::solid::render::{Body, View, render};
use pinswitch::switch::built::{Built, BuiltPart};
use pinswitch::switch::formats::{default_names, named};
use pinswitch::switch::prediction::Prediction;
use pinswitch::switch::set::Set;
use pinswitch::switch::{documents::SourceEntry, feasibility, output::BuildError};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

use crate::config::Configuration;
use crate::curve::Curve;
use crate::error::{OrRaise, exception, json};
use crate::task;

/// Vertices and triangles.
type MeshArrays<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<u32>>);

/// A built switch.
#[pyclass(module = "pinswitch._pinswitch", frozen)]
pub(crate) struct Parts {
    built: Arc<Built>,
}

impl Parts {
    fn part(&self, py: Python<'_>, name: &str) -> PyResult<&BuiltPart> {
        let all = self.built.printed();
        all.iter().find(|part| part.part().name == name).ok_or_else(|| {
            let names: Vec<&str> = all.iter().map(|part| part.part().name.as_str()).collect();
            let problem = format!("no part has the name {name:?}");
            exception(
                py,
                Diagnostic::new(codes::UNKNOWN_WORD, problem)
                    .with_help(format!("the parts are {}", names.join(", "))),
            )
        })
    }
}

/// Returns a read-only array over memory that `owner` keeps alive.
fn borrowed<'py, T: numpy::Element>(
    values: ArrayView2<'_, T>,
    owner: &Bound<'py, Parts>,
) -> Bound<'py, PyArray2<T>> {
    // SAFETY: `owner` owns the memory through an `Arc` that it never replaces, and the built switch is immutable. The
    // array keeps a reference to `owner`, and is not writable.
    #[allow(unsafe_code)]
    unsafe {
        let array = PyArray2::borrow_from_array(&values, owner.clone().into_any());
        array.readwrite().make_nonwriteable();
        array
    }
}

#[pymethods]
impl Parts {
    /// Returns the names of the printed parts.
    #[getter]
    fn names(&self) -> Vec<String> {
        self.built.printed().iter().map(|part| part.part().name.clone()).collect()
    }

    /// Returns vertices (n, 3) in mm and triangles (m, 3) of the print mesh of a part, over the memory of the mesh.
    fn mesh<'py>(slf: &Bound<'py, Self>, name: &str) -> PyResult<MeshArrays<'py>> {
        let py = slf.py();
        let mesh = &slf.get().part(py, name)?.print_mesh;
        let failed = |_| exception(py, Diagnostic::new(codes::INTERNAL_ERROR, "the mesh is not an array"));
        // SAFETY: a point is three numbers without padding (`repr(C)` over `[f64; 3]`).
        #[allow(unsafe_code)]
        let numbers: &[f64] =
            unsafe { std::slice::from_raw_parts(mesh.positions.as_ptr().cast(), 3 * mesh.positions.len()) };
        let vertices = ArrayView2::from_shape((mesh.positions.len(), 3), numbers).map_err(failed)?;
        let triangles = ArrayView2::from_shape((mesh.triangles.len(), 3), mesh.triangles.as_flattened());
        Ok((borrowed(vertices, slf), borrowed(triangles.map_err(failed)?, slf)))
    }

    /// Returns the measured properties of the mesh of a part as JSON.
    fn facts(&self, py: Python<'_>, name: &str) -> PyResult<String> {
        json(py, &self.part(py, name)?.facts)
    }

    /// Returns the binary STL of a part.
    fn stl<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyBytes>> {
        let bytes = self
            .part(py, name)?
            .stl()
            .map_err(|e| Diagnostic::from_error(codes::INTERNAL_ERROR, e))
            .or_raise(py)?;
        Ok(PyBytes::new(py, &bytes))
    }

    /// Returns the warnings of the design.
    fn warnings(&self) -> Vec<String> {
        self.built.design().warnings().iter().map(ToString::to_string).collect()
    }

    /// Returns an animated PNG of the assembly that turns once.
    fn turning<'py>(
        &self,
        py: Python<'py>,
        width: u32,
        height: u32,
        frames: u32,
    ) -> PyResult<Bound<'py, PyBytes>> {
        let built = Arc::clone(&self.built);
        let png = task::run(py, None, move |_| turning_png(&built, width, height, frames.max(1)))?;
        Ok(PyBytes::new(py, &png.map_err(|e| Diagnostic::from_error(codes::INTERNAL_ERROR, e)).or_raise(py)?))
    }

    /// Makes the files of a set, by name; without formats, those of `pinswitch generate`.
    #[pyo3(signature = (curve, formats, source))]
    fn files<'py>(
        &self,
        py: Python<'py>,
        curve: PyRef<'_, Curve>,
        formats: Option<Vec<String>>,
        source: String,
    ) -> PyResult<Bound<'py, PyDict>> {
        let built = Arc::clone(&self.built);
        // With the other laws as `pinswitch generate` draws them.
        let prediction = Prediction::with_curve(built.design(), curve.curve().clone());
        let set = task::run(py, None, move |_| -> Result<Set, Diagnostic> {
            let names: Vec<&str> = match &formats {
                Some(all) => all.iter().map(String::as_str).collect(),
                None => default_names(),
            };
            let set = Set::new(&built, &prediction, &named(&names)?)?;
            Ok(set.made_from(SourceEntry::new(source))?)
        })?;
        let files = PyDict::new(py);
        for file in set.or_raise(py)?.files {
            files.set_item(file.name, PyBytes::new(py, &file.bytes))?;
        }
        Ok(files)
    }
}

/// Builds and examines every part.
#[pyfunction]
pub(crate) fn build(py: Python<'_>, configuration: PyRef<'_, Configuration>) -> PyResult<Parts> {
    let configuration = configuration.snapshot();
    let built = task::run(py, None, move |_| -> Result<Built, Diagnostic> {
        let design = configuration.design()?;
        feasibility::build(design).map_err(|error| match error {
            BuildError::Configuration(error) => configuration.located(error),
            other => Diagnostic::from(other),
        })
    })?;
    Ok(Parts { built: Arc::new(built.or_raise(py)?) })
}

/// Points of the invisible ring that encloses the assembly.
const RING: u32 = 64;
/// Time of a turn in milliseconds.
const TURN_MS: u32 = 6000;

/// Draws the assembly from all sides.
fn turning_png(built: &Built, width: u32, height: u32, frames: u32) -> Result<Vec<u8>, png::EncodingError> {
    let mut bodies: Vec<Body> = built
        .assembly()
        .filter_map(|body| {
            let mesh = body.part.pose?.apply(body.mesh.clone());
            // The pulley's axis is horizontal, and the grooves are up.
            let positions = mesh.positions.iter().map(|p| Point3::new(p.z, p.x, p.y)).collect();
            Some(Body { mesh: Mesh::new(positions, mesh.triangles), colour: body.part.role.colour() })
        })
        .collect();
    bodies.push(Body { mesh: ring(&bodies), colour: [0, 0, 0] });
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_compression(png::Compression::Balanced);
    encoder.set_animated(frames, 0)?;
    encoder.set_frame_delay(u16::try_from(TURN_MS / frames).unwrap_or(u16::MAX), 1000)?;
    let mut writer = encoder.write_header()?;
    for frame in 0..frames {
        let turn_deg = 30.0 + 360.0 * f64::from(frame) / f64::from(frames);
        writer.write_image_data(&render(&bodies, View { turn_deg, rise_deg: 25.0 }, width, height).pixels)?;
    }
    writer.finish()?;
    Ok(bytes)
}

/// Returns triangles without area around all bodies, so that every view has the same scale and centre.
fn ring(bodies: &[Body]) -> Mesh {
    let points = || bodies.iter().flat_map(|body| &body.mesh.positions);
    let radius = points().map(|p| p.x.hypot(p.y)).fold(0.0, f64::max);
    let ends =
        points().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), p| (low.min(p.z), high.max(p.z)));
    let corners = (0..RING).flat_map(|i| {
        let angle = std::f64::consts::TAU * f64::from(i) / f64::from(RING);
        [ends.0, ends.1].map(|z| Point3::new(radius * angle.cos(), radius * angle.sin(), z))
    });
    Mesh::new(corners.collect(), (0..2 * RING).map(|i| [i, i, i]).collect())
}
