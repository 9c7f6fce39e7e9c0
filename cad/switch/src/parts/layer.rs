//! The silicone layer and its rigid proxy, which have one shape (cad/doc/dimensions.md, "Silicone layer").

use super::{Part, Pose, Role, Sector, offset_error};
use crate::config::ConfigError;
use crate::design::Design;
use pinswitch_solid::profile::Contour;
use pinswitch_solid::solid::Solid;

/// Least gap between printed faces that must not touch, mm.
const MIN_AIR_MM: f64 = 0.1;

/// The sector of the layer, without its grooves.
pub(super) fn layer_sector(design: &Design) -> Sector {
    Sector {
        inner_mm: design.shell_radius_mm(),
        outer_mm: design.contact_radius_mm(),
        half_span_rad: design.half_span_rad(),
        end_shift_mm: design.configuration().segment.end_margin_mm,
    }
}

/// The outline: smooth inside, with half-round grooves for the pins outside.
fn outline(design: &Design) -> Contour {
    let groove = design.configuration().segment.groove_radius_mm;
    layer_sector(design).grooved(&design.groove_angles_rad(), groove)
}

fn pose(design: &Design) -> Option<Pose> {
    Some(Pose::upright(design.configuration().silicone.side_clearance_mm))
}

/// The cast layer, as a reference body.
///
/// # Errors
/// None for a valid design.
pub fn silicone_layer(design: &Design) -> Result<Part, ConfigError> {
    let solid = Solid::prism(&outline(design), &[], 0.0, design.layer_width_mm(), 0.0)
        .map_err(offset_error("segment.groove_radius_mm"))?;
    Ok(Part::new("silicone-layer", Role::Layer, solid, pose(design)))
}

/// The outline of the proxy. Its end walls would be thin to print, so its ends reach over the stops if there is space.
fn proxy_outline(design: &Design) -> Contour {
    let c = design.configuration();
    let reach = design.stop_reach_mm();
    let height = design.stops_mm().map_or(0.0, |[_, height]| height);
    let from = design.shell_radius_mm() + height + c.silicone.side_clearance_mm.max(MIN_AIR_MM);
    if reach <= 0.0
        || design.contact_radius_mm() - from < 2.0 * c.print.line_mm + 2.0 * c.print.elephant_foot_mm
    {
        return outline(design);
    }
    layer_sector(design).eared(&design.groove_angles_rad(), c.segment.groove_radius_mm, from, reach)
}

pub(super) fn proxy(design: &Design) -> Result<Part, ConfigError> {
    let chamfer = design.configuration().print.elephant_foot_mm;
    let solid = Solid::prism(&proxy_outline(design), &[], 0.0, design.layer_width_mm(), chamfer)
        .map_err(offset_error("print.elephant_foot_mm"))?;
    Ok(Part::new("proxy", Role::Proxy, solid, pose(design)))
}
