//! Reads binary STL, many facets at a time.

use std::io::Read;

use super::facets::Facets;
use crate::parallel;

/// Bytes before the first facet: 80 of text, then the number of facets.
pub(super) const HEADER: usize = 84;
/// Bytes of a facet: its normal, three corners and two unused bytes.
pub(super) const RECORD: usize = 50;
/// Facets that are read at a time, 3 MB: enough work for several threads.
pub(super) const RECORDS_PER_READ: usize = 1 << 16;

/// Reads `count` facets of a binary STL of `length` bytes.
///
/// Corners are merged in two steps: first within some thousand facets, on several threads with
/// tables that fit into the processor's caches, then the remaining sixth of them in one table.
pub(super) fn read_binary(source: &mut impl Read, count: u64, length: u64) -> std::io::Result<Facets> {
    let mut header = [0; HEADER];
    source.read_exact(&mut header)?;
    let mut left = usize::try_from(count).unwrap_or(usize::MAX);
    // Never more capacity than the file can fill, whatever its header announces.
    let most = left.min(usize::try_from(length / RECORD as u64).unwrap_or(usize::MAX));
    let mut facets = Facets::default();
    let mut buffer = vec![0; RECORD * RECORDS_PER_READ.min(most)];
    while left > 0 {
        let count = left.min(RECORDS_PER_READ);
        buffer.resize(RECORD * count, 0);
        source.read_exact(&mut buffer)?;
        for part in
            parallel::in_chunks(count, |range| merged(&buffer[RECORD * range.start..RECORD * range.end]))
        {
            facets.append(part);
        }
        left -= count;
        if left > 0 {
            facets.reserve(most - facets.len());
        }
    }
    Ok(facets)
}

/// The facets of some records, with their corners merged.
fn merged(records: &[u8]) -> Facets {
    let mut facets = Facets::with_capacity(records.len() / RECORD);
    for record in records.chunks_exact(RECORD) {
        let (numbers, _) = record.as_chunks();
        let at = |i: usize| {
            let [x, y, z] = [numbers[i], numbers[i + 1], numbers[i + 2]];
            [f32::from_le_bytes(x), f32::from_le_bytes(y), f32::from_le_bytes(z)]
        };
        facets.add(at(0), [at(3), at(6), at(9)]);
    }
    facets
}

/// The number of facets in the header of a binary STL; `None` if `header` is too short.
pub(super) fn announced(header: &[u8]) -> Option<u32> {
    let count = header.get(HEADER - 4..HEADER)?.try_into().ok()?;
    Some(u32::from_le_bytes(count))
}
