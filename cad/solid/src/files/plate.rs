//! Layout of parts on print beds: rows (shelves), first fit by decreasing depth, on as many beds as
//! necessary.

use nalgebra::Vector2;

use crate::mesh::{Mesh, Point3, Vector3};

/// Gap between parts, mm: room for the brim and skirt of a slicer.
pub const PART_GAP_MM: f64 = 6.0;
/// Margin along the edges of a bed, mm: for clips, and because beds are not flat there.
pub const BED_EDGE_MM: f64 = 3.0;
/// Step in the search for the smallest square, mm.
const STEP_MM: f64 = 5.0;
/// Rounding of the length of a row, mm.
const ROUNDING_MM: f64 = 1e-9;

/// The place of a part on a print bed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// Index of the plate.
    pub plate: usize,
    /// Whether the part is rotated by 90 degrees counter-clockwise about the vertical before it is
    /// moved.
    pub is_turned: bool,
    /// Translation, mm, in whole micrometres across the bed.
    pub shift: Vector3,
}

impl Placement {
    /// Returns the mesh in its place; the corner of the bed is the origin.
    pub fn apply(&self, mesh: Mesh) -> Mesh {
        if !self.is_turned {
            return mesh.translated(self.shift);
        }
        let turned = mesh.positions.iter().map(|p| Point3::new(-p.y, p.x, p.z)).collect();
        Mesh::new(turned, mesh.triangles).translated(self.shift)
    }
}

/// Lower and upper corner of a bounding box.
pub type Box3 = (Point3, Point3);

/// Returns the side of the smallest square bed for a part of this bounding box, mm.
pub fn needed_bed_mm((low, high): &Box3) -> f64 {
    (high.x - low.x).max(high.y - low.y) + 2.0 * BED_EDGE_MM
}

/// Returns places for parts of these bounding boxes on square beds of `bed_mm`, in their order.
///
/// Parts are on z = 0, [`PART_GAP_MM`] apart and [`BED_EDGE_MM`] from the edges; those of a plate
/// are centred on its bed. The same boxes get the same places. A part larger than the bed
/// ([`needed_bed_mm`]) is alone on it and extends over its edges.
pub fn lay_out(boxes: &[Box3], bed_mm: f64) -> Vec<Placement> {
    let footprints: Vec<Footprint> = boxes.iter().map(Footprint::of).collect();
    let free_mm = bed_mm - 2.0 * BED_EDGE_MM;
    let widest = footprints.iter().map(|f| f.width_mm).fold(0.0, f64::max);
    // Parts of a single plate are in the smallest square: short moves of the nozzle, and a legible
    // picture.
    let compact = (0u32..)
        .map(|step| widest + f64::from(step) * STEP_MM)
        .take_while(|side| *side < free_mm)
        .map(|side| shelved(&footprints, side))
        .find(|spots| spots.iter().all(|s| s.plate == 0));
    let spots = compact.unwrap_or_else(|| shelved(&footprints, free_mm));
    let plates = spots.iter().map(|s| s.plate + 1).max().unwrap_or(0);
    let corners: Vec<Vector2<f64>> =
        (0..plates).map(|plate| corner(&footprints, &spots, plate, bed_mm)).collect();
    let place = |((f, spot), (low, high)): ((&Footprint, &Spot), &Box3)| {
        let at = corners[spot.plate] + spot.at;
        // The corner of the part that becomes the lower left one.
        let from = if f.is_turned { Vector2::new(-high.y, low.x) } else { Vector2::new(low.x, low.y) };
        let micrometres = (at - from).map(|v| (v * 1e3).round() / 1e3);
        let shift = Vector3::new(micrometres.x, micrometres.y, -low.z);
        Placement { plate: spot.plate, is_turned: f.is_turned, shift }
    };
    footprints.iter().zip(&spots).zip(boxes).map(place).collect()
}

/// The footprint of a part, with its longer side across the bed.
struct Footprint {
    width_mm: f64,
    depth_mm: f64,
    is_turned: bool,
}

impl Footprint {
    fn of((low, high): &Box3) -> Self {
        let (x, y) = (high.x - low.x, high.y - low.y);
        Self { width_mm: x.max(y), depth_mm: x.min(y), is_turned: y > x }
    }
}

/// The lower left corner of a footprint, relative to that of all parts of its plate.
#[derive(Clone, Copy)]
struct Spot {
    plate: usize,
    at: Vector2<f64>,
}

/// A row of parts.
struct Shelf {
    plate: usize,
    y_mm: f64,
    depth_mm: f64,
    used_mm: f64,
}

/// Spots in rows on plates of `side_mm`, first fit by decreasing depth.
fn shelved(footprints: &[Footprint], side_mm: f64) -> Vec<Spot> {
    let mut order: Vec<usize> = (0..footprints.len()).collect();
    let size = |i: usize| (footprints[i].depth_mm, footprints[i].width_mm);
    order.sort_by(|a, b| {
        let ((depth_a, width_a), (depth_b, width_b)) = (size(*a), size(*b));
        depth_b.total_cmp(&depth_a).then(width_b.total_cmp(&width_a))
    });
    let mut spots = vec![Spot { plate: 0, at: Vector2::zeros() }; footprints.len()];
    let mut shelves: Vec<Shelf> = Vec::new();
    for i in order {
        let (depth_mm, width_mm) = size(i);
        let has_room = |s: &Shelf| s.used_mm + PART_GAP_MM + width_mm <= side_mm + ROUNDING_MM;
        let shelf = match shelves.iter_mut().find(|s| has_room(s)) {
            Some(shelf) => {
                shelf.used_mm += PART_GAP_MM;
                shelf
            }
            None => {
                shelves.push(new_shelf(&shelves, depth_mm, side_mm));
                let last = shelves.len() - 1;
                &mut shelves[last]
            }
        };
        spots[i] = Spot { plate: shelf.plate, at: Vector2::new(shelf.used_mm, shelf.y_mm) };
        shelf.used_mm += width_mm;
    }
    spots
}

/// A new row on the first plate with room for it, or on a new plate.
fn new_shelf(shelves: &[Shelf], depth_mm: f64, side_mm: f64) -> Shelf {
    let plates = shelves.iter().map(|s| s.plate + 1).max().unwrap_or(0);
    let top = |plate: usize| {
        let rows = shelves.iter().filter(|s| s.plate == plate);
        rows.map(|s| s.y_mm + s.depth_mm + PART_GAP_MM).fold(0.0, f64::max)
    };
    let plate = (0..plates).find(|plate| top(*plate) + depth_mm <= side_mm + ROUNDING_MM).unwrap_or(plates);
    Shelf { plate, y_mm: top(plate), depth_mm, used_mm: 0.0 }
}

/// The lower left corner of the parts of a plate, so that they are centred on the bed.
fn corner(footprints: &[Footprint], spots: &[Spot], plate: usize, bed_mm: f64) -> Vector2<f64> {
    let ends = footprints.iter().zip(spots).filter(|(_, s)| s.plate == plate);
    let size = ends
        .map(|(f, s)| s.at + Vector2::new(f.width_mm, f.depth_mm))
        .fold(Vector2::zeros(), |a: Vector2<f64>, b| a.sup(&b));
    // A part larger than the bed has no negative coordinates: a 3MF allows none.
    size.map(|side| ((bed_mm - side) / 2.0).max(0.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// A box of this size.
    fn sized([x, y]: [f64; 2], from: f64) -> Box3 {
        (Point3::new(from, -2.0 * from, -1.0), Point3::new(from + x, y - 2.0 * from, 4.0))
    }

    /// The box of a part in its place, from its mesh.
    fn placed((low, high): &Box3, place: &Placement) -> Box3 {
        let corners = vec![*low, *high, Point3::new(low.x, high.y, low.z)];
        place.apply(Mesh::new(corners, vec![[0, 1, 2]])).bounds().unwrap()
    }

    fn check(boxes: &[Box3], bed_mm: f64) -> Result<usize, TestCaseError> {
        let places = lay_out(boxes, bed_mm);
        prop_assert_eq!(places.len(), boxes.len());
        let placements: Vec<_> = boxes.iter().zip(&places).map(|(b, p)| (placed(b, p), p.plate)).collect();
        for (i, ((low, high), plate)) in placements.iter().enumerate() {
            let within = |v: f64| v >= BED_EDGE_MM - 2e-3 && v <= bed_mm - BED_EDGE_MM + 2e-3;
            prop_assert!(
                within(low.x) && within(low.y) && within(high.x) && within(high.y),
                "{:?} {:?}",
                low,
                high
            );
            prop_assert!(low.z == 0.0);
            for ((other_low, other_high), other_plate) in &placements[..i] {
                let gap = PART_GAP_MM - 2e-3;
                let apart = low.x - other_high.x >= gap
                    || other_low.x - high.x >= gap
                    || low.y - other_high.y >= gap
                    || other_low.y - high.y >= gap;
                prop_assert!(plate != other_plate || apart, "{:?}", placements);
            }
        }
        let plates = placements.iter().map(|(_, plate)| plate + 1).max().unwrap_or(0);
        prop_assert!((0..plates).all(|plate| placements.iter().any(|(_, p)| *p == plate)), "an empty plate");
        Ok(plates)
    }

    proptest! {
        #[test]
        fn parts_have_gaps_and_margins(
            sizes in prop::collection::vec([1.0..120.0f64, 1.0..120.0f64], 0..30),
            from in -200.0..200.0f64,
            bed in 126.0..400.0f64,
        ) {
            let boxes: Vec<_> = sizes.iter().map(|s| sized(*s, from)).collect();
            let plates = check(&boxes, bed)?;
            // With the gaps, shelves fill at least a quarter of all beds except the last two.
            let covered: f64 = sizes.iter().map(|[x, y]| (x + PART_GAP_MM) * (y + PART_GAP_MM)).sum();
            let free = bed - 2.0 * BED_EDGE_MM + PART_GAP_MM;
            prop_assert!((plates as f64) <= 2.0 + 4.0 * covered / (free * free), "{} plates for {}", plates, covered);
        }
    }

    #[test]
    fn one_plate_is_centred() {
        let boxes = [[60.0, 20.0], [20.0, 60.0], [30.0, 30.0]].map(|s| sized(s, 7.0));
        assert_eq!(check(&boxes, 250.0).unwrap(), 1);
        let places = lay_out(&boxes, 250.0);
        assert_eq!(places.iter().map(|p| p.is_turned).collect::<Vec<_>>(), [false, true, false]);
        let all = boxes.iter().zip(&places).map(|(b, p)| placed(b, p));
        let (low, high) = all.reduce(|a, b| (a.0.inf(&b.0), a.1.sup(&b.1))).unwrap();
        let middle = nalgebra::center(&low, &high);
        assert!((middle.x - 125.0).abs() < 2e-3 && (middle.y - 125.0).abs() < 2e-3, "{middle}");
        // Nearly square.
        assert!(high.x - low.x <= 70.0 && high.y - low.y <= 90.0, "{low} {high}");
    }

    #[test]
    fn an_exact_fit_is_used() {
        let part = sized([94.0, 94.0], 0.0);
        assert!((needed_bed_mm(&part) - 100.0).abs() < 1e-9);
        assert_eq!(check(&[part, part], 100.0).unwrap(), 2);
        // Four of 44 mm with a gap fill it, too.
        assert_eq!(check(&[sized([44.0, 44.0], 0.0); 5], 100.0).unwrap(), 2);
        // One that is too large is alone, in positive coordinates.
        let places = lay_out(&[sized([120.0, 5.0], 0.0), part], 100.0);
        assert_ne!(places[0].plate, places[1].plate);
        assert!(places.iter().all(|p| p.shift.x >= 0.0));
    }
}
