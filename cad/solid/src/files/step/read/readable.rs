//! What truck can follow, asked one entity at a time: of what it cannot, it would write to the terminal, and go on
//! without.

use std::collections::BTreeSet;

use ruststep::ast::DataSection;
use ruststep::tables::{EntityTable, IntoOwned};
use truck_stepio::r#in::{SurfaceAny, Table, VertexPointHolder, alias::Surface};

/// Truck's table of a section. An entity that it cannot take is not in it.
pub(super) fn table_of(section: &DataSection) -> Table {
    let mut table = Table::default();
    for instance in &section.entities {
        // What is missing is found out by the faces that lack it.
        let _ = table.push_instance(instance);
    }
    table
}

/// Faces, edges and corners of which truck has no surface, no curve or no point.
pub(super) fn unreadable(table: &Table) -> BTreeSet<u64> {
    let mut found = BTreeSet::new();
    for (id, edge) in &table.edge_curve {
        let curve = edge.clone().into_owned(table).ok().and_then(|e| e.parse_curve3d().ok());
        if curve.is_none() {
            found.insert(*id);
        }
    }
    for (id, face) in &table.face_surface {
        let surface: Option<SurfaceAny> = face.face_geometry.clone().into_owned(table).ok();
        if surface.and_then(|s| Surface::try_from(&s).ok()).is_none() {
            found.insert(*id);
        }
    }
    let is_lost = |id: &u64| EntityTable::<VertexPointHolder>::get_owned(table, *id).is_err();
    found.extend(table.vertex_point.keys().copied().filter(is_lost));
    found
}
