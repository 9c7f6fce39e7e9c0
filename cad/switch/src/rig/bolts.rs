//! Bolts of the rig: threads and lengths.

use crate::config::{CellKind, DriveKind};
use crate::design::rig::{
    CELL_PLATE_MM, CELL_WALL_MM, DRIVE_DEPTH_MM, DRUM_FACE_MM, DRUM_LENGTH_MM, FOOT_DEPTH_MM, KNOB_LENGTH_MM,
    WASHER_MM,
};
use crate::design::{Design, clearance};
use crate::parts::cell_bolts;

/// Lengths of hexagon bolts, mm (ISO 4014 and ISO 4017).
pub(crate) const BOLT_LENGTHS_MM: [f64; 20] = [
    16.0, 20.0, 25.0, 30.0, 35.0, 40.0, 45.0, 50.0, 55.0, 60.0, 65.0, 70.0, 80.0, 90.0, 100.0, 110.0, 120.0,
    130.0, 140.0, 150.0,
];
/// Height of an M6 nut (ISO 4032), and of an M6 and an M8 nut with a nylon ring (ISO 7040), mm.
pub(crate) const M6_NUT_MM: f64 = 5.2;
const M6_LOCK_NUT_MM: f64 = 8.0;
const M8_LOCK_NUT_MM: f64 = 9.5;
/// Least engagement of the bolt of a cell, in diameters of its thread.
const ENGAGEMENT: f64 = 0.8;

/// Returns the shortest available bolt of at least `least_mm`, or the longest one.
pub(crate) fn bolt_mm(least_mm: f64) -> f64 {
    BOLT_LENGTHS_MM.into_iter().find(|l| *l >= least_mm - 1e-9).unwrap_or(BOLT_LENGTHS_MM[19])
}

/// Bolts of the rig; lengths under their heads, mm.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct RigBolts {
    /// M6, four, through board and feet.
    pub(crate) foot_mm: f64,
    /// Thread and length of the four screws of the splice, if there is one.
    pub(crate) splice: Option<(f64, f64)>,
    /// Thread, number and length of the bolts between cell and cell mount.
    pub(crate) cell: (f64, usize, f64),
    /// Thread of the bolts of the drive: through its eyes, or M6 in the cell mount of a crank.
    pub(crate) drive_thread_mm: f64,
    /// Length of the bolt in the cell mount.
    pub(crate) pin_mm: f64,
    /// Length of the bolt through the foot of the drive: through the rear eye, or the M8 axle of the drum.
    pub(crate) axle_mm: f64,
    /// Length of the M5 locking pin and of the M6 bolt of the knob, with a crank.
    pub(crate) crank_mm: Option<[f64; 2]>,
}

impl RigBolts {
    /// Returns the bolts of a design with a rig.
    pub(crate) fn new(design: &Design) -> Option<Self> {
        let c = design.configuration();
        let layout = design.rig_layout()?;
        let splice = layout.joint.is_some().then(|| {
            let thread = clearance(c.mount.hole_diameter_mm).thread;
            let thread = thread.and_then(|name| name.strip_prefix('M')?.parse().ok()).unwrap_or(3.0);
            (thread, bolt_mm(2.0 * c.mount.plate_mm + thread + 1.0))
        });
        let bolts = cell_bolts(c);
        let thread = bolts.first().map_or(0.0, |b| b.thread_mm);
        let cell = (thread, bolts.len(), bolt_mm(CELL_WALL_MM + WASHER_MM + ENGAGEMENT * thread));
        let packing = layout.packing as f64 * WASHER_MM;
        let (pin, axle, crank_mm) = match c.rig.drive {
            DriveKind::Actuator => {
                let eye = c.rig.clevis_mm + WASHER_MM + M6_LOCK_NUT_MM;
                (CELL_PLATE_MM + packing + eye, DRIVE_DEPTH_MM + WASHER_MM + eye, None)
            }
            DriveKind::Crank => (
                CELL_PLATE_MM + 2.0 * M6_NUT_MM + layout.cell_height_mm,
                DRIVE_DEPTH_MM + WASHER_MM + DRUM_LENGTH_MM + WASHER_MM + M8_LOCK_NUT_MM,
                Some([
                    bolt_mm(DRIVE_DEPTH_MM + WASHER_MM + DRUM_FACE_MM),
                    bolt_mm(DRUM_FACE_MM + WASHER_MM + KNOB_LENGTH_MM + WASHER_MM + M6_LOCK_NUT_MM),
                ]),
            ),
        };
        Some(Self {
            foot_mm: bolt_mm(c.mount.plate_mm + FOOT_DEPTH_MM + 2.0 * WASHER_MM + M6_NUT_MM),
            splice,
            cell,
            drive_thread_mm: c.rig.clevis_pin_mm,
            pin_mm: bolt_mm(pin),
            axle_mm: bolt_mm(axle),
            crank_mm,
        })
    }

    /// Returns whether the cell is held by socket screws, which fit between the walls of its mount.
    pub(crate) fn has_socket_screws(design: &Design) -> bool {
        design.configuration().rig.cell == CellKind::Bar
    }
}
