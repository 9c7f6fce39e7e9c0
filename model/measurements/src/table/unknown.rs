//! Quantities of a plateau table that a laboratory may not have.

use super::row::{PlateauRow, Sweep};

/// A column whose cells may be empty, and which may be absent.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Optional {
    /// `sweep`.
    Sweep,
    /// `load_mass_g`.
    LoadMass,
    /// `speed_pct`.
    Speed,
    /// `dwell_s`.
    Dwell,
    /// `repetition`.
    Repetition,
    /// `position_mm`.
    Position,
    /// `time_s`.
    Time,
}

impl Optional {
    /// All optional columns, in the order of the table.
    pub const ALL: [Self; 7] =
        [Self::Sweep, Self::LoadMass, Self::Speed, Self::Dwell, Self::Repetition, Self::Position, Self::Time];

    /// Returns the name of the column.
    pub fn column(self) -> &'static str {
        match self {
            Self::Sweep => "sweep",
            Self::LoadMass => "load_mass_g",
            Self::Speed => "speed_pct",
            Self::Dwell => "dwell_s",
            Self::Repetition => "repetition",
            Self::Position => "position_mm",
            Self::Time => "time_s",
        }
    }

    /// Sets the field of a row to the neutral value of an unknown quantity: zero, repetition 1, or
    /// ascending loads.
    fn neutralize(self, row: &mut PlateauRow) {
        match self {
            Self::Sweep => row.sweep = Sweep::Up,
            Self::LoadMass => row.load_mass_g = 0.0,
            Self::Speed => row.speed_pct = 0.0,
            Self::Dwell => row.dwell_s = 0.0,
            Self::Repetition => row.repetition = 1,
            Self::Position => row.position_mm = 0.0,
            Self::Time => row.time_s = 0.0,
        }
    }
}

/// The quantities that a row lacks; their fields have neutral values.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Unknown(u8);

impl Unknown {
    /// Adds a quantity.
    #[must_use]
    pub fn with(self, quantity: Optional) -> Self {
        Self(self.0 | 1 << quantity as u8)
    }

    /// Whether the row lacks a quantity.
    pub fn contains(self, quantity: Optional) -> bool {
        self.0 & (1 << quantity as u8) != 0
    }
}

/// Returns rows in which each optional quantity is known in all of them or in none, and the
/// quantities that at least one row lacks.
///
/// A covariate that some rows lack cannot be compared between rows: it gets its neutral value in
/// all of them, and so varies in none.
pub fn with_complete_columns(rows: &[PlateauRow]) -> (Vec<PlateauRow>, Vec<Optional>) {
    let lacking: Vec<Optional> = Optional::ALL
        .into_iter()
        .filter(|quantity| rows.iter().any(|row| row.unknown.contains(*quantity)))
        .collect();
    let mut rows = rows.to_vec();
    for row in &mut rows {
        for quantity in &lacking {
            quantity.neutralize(row);
            row.unknown = row.unknown.with(*quantity);
        }
    }
    (rows, lacking)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::PlateauTable;
    use crate::test_session::session;

    #[test]
    fn partly_empty_columns_vary_in_no_row() {
        let mut rows = session(1);
        rows[3].unknown = Unknown::default().with(Optional::Position);
        let (complete, lacking) = with_complete_columns(&rows);
        assert_eq!(lacking, [Optional::Position]);
        assert!(
            complete.iter().all(|row| row.position_mm == 0.0 && row.unknown.contains(Optional::Position))
        );
        assert_eq!(complete[3].time_s, rows[3].time_s);
        assert_eq!(with_complete_columns(&session(1)), (session(1), Vec::new()));
    }

    #[test]
    fn absent_columns_read_and_write_as_absent() {
        let text = "series,substrate,pins,load_N,direction,force_N\na,plain,,10,concentric,12\na,plain,,10,concentric,12\n";
        let table = PlateauTable::read(text.as_bytes(), "t.csv").unwrap();
        assert!(Optional::ALL.iter().all(|quantity| table.rows[0].unknown.contains(*quantity)));
        assert_eq!(
            PlateauTable::write(&table.rows),
            text.replace("10,", "10.0000,").replace(",12\n", ",12.0000\n")
        );
    }

    #[test]
    fn empty_cells_stay_empty() {
        let text = "series,substrate,pins,sweep,load_mass_g,load_N,speed_pct,dwell_s,direction,repetition,position_mm,time_s,force_N\n\
                    a,plain,,,,10.0000,,3,eccentric,1,,5.00,8.0000\na,plain,,up,100,10.0000,50,3,eccentric,2,1.00,,8.0000\n";
        let table = PlateauTable::read(text.as_bytes(), "t.csv").unwrap();
        assert!(
            table.rows[0].unknown.contains(Optional::Speed)
                && !table.rows[0].unknown.contains(Optional::Dwell)
        );
        assert_eq!(PlateauTable::write(&table.rows), text);
    }
}
