//! Concatenation of the tables of several sessions.

use std::collections::BTreeSet;

use super::columns::LABELS;
use super::plateau_table::PlateauTable;
use super::row_cells::RowCells;
use super::table_error::TableError;

/// Column with the name of the session.
const SESSION: &str = LABELS[0];

impl PlateauTable {
    /// Joins named tables. The rows of a table without a column `session` form a session of the
    /// table's name. Columns that a table lacks are empty in its rows.
    ///
    /// # Errors
    /// [`TableError::Session`] if two tables contain rows of one session, since their times and
    /// series would be mixed up. [`TableError::Copied`] if a table contains most readings of
    /// another one, since readings that are counted twice look more certain than they are.
    pub fn joined(tables: Vec<(Self, String)>) -> Result<Self, TableError> {
        let mut sessions: Vec<(String, String)> = Vec::new();
        refuse_copies(&tables)?;
        let mut all = Self { rows: Vec::new(), header: Vec::new(), cells: Vec::new() };
        for (mut table, file) in tables {
            if !table.header.iter().any(|name| name == SESSION) {
                table.header.push(SESSION.to_owned());
                table.cells.iter_mut().for_each(|cells| cells.push(&file));
                table.rows.iter_mut().for_each(|row| row.labels.session.clone_from(&file));
            }
            let own: BTreeSet<&String> = table.rows.iter().map(|r| &r.labels.session).collect();
            for session in own {
                if let Some((_, other)) = sessions.iter().find(|(known, _)| known == session) {
                    let (session, other) = (session.clone(), other.clone());
                    return Err(TableError::Session { file, other, session });
                }
            }
            let own: BTreeSet<String> = table.rows.iter().map(|r| r.labels.session.clone()).collect();
            sessions.extend(own.into_iter().map(|session| (session, file.clone())));
            for name in &table.header {
                if !all.header.contains(name) {
                    all.header.push(name.clone());
                    all.cells.iter_mut().for_each(|cells| cells.push(""));
                }
            }
            let places: Vec<Option<usize>> =
                all.header.iter().map(|name| table.header.iter().position(|own| own == name)).collect();
            all.cells.extend(table.cells.iter().map(|cells| {
                let cell = |place: &Option<usize>| place.map_or("", |i| cells.get(i));
                places.iter().map(cell).collect::<RowCells>()
            }));
            all.rows.extend(table.rows);
        }
        Ok(all)
    }
}

/// Share of the shorter table's readings that only a copy shares with another table. A coarse load
/// cell repeats some readings by chance.
const COPIED: f64 = 0.8;
/// Fewest readings for which the share is conclusive.
const LEAST_READINGS: usize = 8;

fn refuse_copies(tables: &[(PlateauTable, String)]) -> Result<(), TableError> {
    let readings = |table: &PlateauTable| -> BTreeSet<[u64; 3]> {
        table.rows.iter().map(|r| [r.time_s, r.load_n, r.force_n].map(f64::to_bits)).collect()
    };
    let sets: Vec<BTreeSet<[u64; 3]>> = tables.iter().map(|(table, _)| readings(table)).collect();
    for (i, own) in sets.iter().enumerate() {
        for (j, other) in sets[..i].iter().enumerate() {
            let both = own.intersection(other).count();
            let shorter = own.len().min(other.len());
            // A file that is given twice is reported by its session.
            let is_another = tables[i].1 != tables[j].1;
            if is_another && shorter >= LEAST_READINGS && both as f64 >= COPIED * shorter as f64 {
                let [file, other] = [i, j].map(|at| tables[at].1.clone());
                return Err(TableError::Copied { file, other, rows: both });
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEADER: &str = "series,substrate,pins,sweep,load_mass_g,load_N,speed_pct,dwell_s,direction,repetition,position_mm,time_s,force_N";

    fn table(header: &str, cells: &str) -> PlateauTable {
        let text = format!("{header}\n1,silicone,,up,0,10,50,3,eccentric,1,12.7,4.5,9.6{cells}\n");
        PlateauTable::read(text.as_bytes(), "t.csv").unwrap()
    }

    #[test]
    fn files_are_sessions_by_default() {
        let first = table(&format!("{HEADER},room"), ",cold");
        let second = table(&format!("{HEADER},session,mount"), ",tuesday,2");
        let all =
            PlateauTable::joined(vec![(first.clone(), "a.csv".into()), (second, "b.csv".into())]).unwrap();
        let sessions: Vec<_> = all.rows.iter().map(|r| r.labels.session.as_str()).collect();
        assert_eq!(sessions, ["a.csv", "tuesday"]);
        let text = all.with_columns(&[], &[], 1);
        let lines: Vec<_> = text.lines().collect();
        assert_eq!(lines[0], format!("{HEADER},room,session,mount"));
        assert!(lines[1].ends_with(",9.6,cold,a.csv,") && lines[2].ends_with(",9.6,,tuesday,2"), "{text}");
        let twice = PlateauTable::joined(vec![(first.clone(), "a.csv".into()), (first, "a.csv".into())]);
        let error = twice.unwrap_err().to_string();
        assert!(error.contains("a.csv") && error.contains("session"), "{error}");
    }

    #[test]
    fn a_copied_table_is_refused() {
        let of = |rows: Vec<crate::table::PlateauRow>| {
            PlateauTable::read(PlateauTable::write(&rows).as_bytes(), "t.csv").unwrap()
        };
        let joined = |first: PlateauTable, second: PlateauTable| {
            PlateauTable::joined(vec![(first, "a.csv".into()), (second, "b.csv".into())])
        };
        let rows = crate::test_session::session(1);
        let part = rows[..rows.len() / 2].to_vec();
        for (first, second) in
            [(rows.clone(), rows.clone()), (part.clone(), rows.clone()), (rows.clone(), part)]
        {
            let error = joined(of(first), of(second)).unwrap_err();
            let TableError::Copied { file, other, .. } = &error else { panic!("{error}") };
            assert_eq!((file.as_str(), other.as_str()), ("b.csv", "a.csv"));
        }
        // Another day of the same protocol, with a load cell that resolves 0.05 N.
        let coarse = |seed: u64| {
            let mut rows = crate::test_session::session(seed);
            rows.iter_mut().for_each(|r| r.force_n = (20.0 * r.force_n).round() / 20.0);
            of(rows)
        };
        assert!(joined(coarse(1), coarse(2)).is_ok());
    }
}
