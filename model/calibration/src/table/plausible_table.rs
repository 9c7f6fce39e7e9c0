//! Whether a table's loads and readings can belong together, before anything is fitted to them.

use std::ops::RangeInclusive;

use pinswitch_friction::Direction;
use pinswitch_friction::published::GRAVITY_M_S2;

use super::plateau_table::PlateauTable;
use super::row::PlateauRow;
use super::table_error::TableError;
use crate::median::median;

/// Newtons of reading per newton of load that friction over any wrap, drags and offsets may leave.
const FOLLOWS: RangeInclusive<f64> = 0.2..=5.0;
/// Declared load over the weight of the declared mass: one, with room for hooks and levers.
const WEIGHS: RangeInclusive<f64> = 0.5..=2.0;

impl PlateauTable {
    /// Refuses a table that cannot fix a baseline.
    ///
    /// # Errors
    /// [`TableError::TooFewLoads`] with fewer than two loads above zero, [`TableError::Unrelated`] if the readings do
    /// not follow the loads, [`TableError::LoadUnit`] if loads and masses contradict each other.
    pub fn require_baseline(&self, file: &str) -> Result<(), TableError> {
        let mut loads: Vec<f64> = self.rows.iter().map(|r| r.load_n).filter(|n| *n > 0.0).collect();
        loads.sort_by(f64::total_cmp);
        loads.dedup_by(|a, b| (*a - *b).abs() < 1e-6);
        let needed = 2;
        if loads.len() < needed {
            return Err(TableError::TooFewLoads {
                file: file.to_owned(),
                last_line: self.rows.len() + 1,
                found: loads.len(),
                needed,
            });
        }
        let file = file.to_owned();
        let slopes: Vec<f64> =
            [Direction::Eccentric, Direction::Concentric].into_iter().filter_map(|d| self.slope(d)).collect();
        match (slopes.as_slice(), self.newtons_per_weight()) {
            ([slope, ..], _) if !slopes.iter().any(|s| FOLLOWS.contains(s)) => {
                Err(TableError::Unrelated { file, slope: *slope, bounds: FOLLOWS })
            }
            (_, Some(factor)) if !WEIGHS.contains(&factor) => {
                Err(TableError::LoadUnit { file, factor, bounds: WEIGHS })
            }
            _ => Ok(()),
        }
    }

    /// Declared load over what `load_mass_g` weighs, on the heaviest quarter of the rows, where a hook adds little;
    /// `None` where no mass is given.
    fn newtons_per_weight(&self) -> Option<f64> {
        let mut rows: Vec<&PlateauRow> = self.rows.iter().collect();
        rows.sort_by(|a, b| b.load_n.total_cmp(&a.load_n));
        let weight_n = |r: &PlateauRow| r.load_mass_g * 1e-3 * GRAVITY_M_S2;
        let mut factors: Vec<f64> = rows[..rows.len().div_ceil(4)]
            .iter()
            .filter(|r| r.load_mass_g > 0.0)
            .map(|r| r.load_n / weight_n(r))
            .collect();
        (!factors.is_empty()).then(|| median(&mut factors))
    }

    /// Newtons of reading per newton of load in one direction, from the medians of the lightest and the heaviest
    /// quarter of its rows; `None` if their loads are too alike to tell.
    fn slope(&self, direction: Direction) -> Option<f64> {
        let of = self.rows.iter().filter(|r| r.direction == direction);
        let mut rows: Vec<(f64, f64)> = of.map(|r| (r.load_n, r.force_n)).collect();
        rows.sort_by(|a, b| a.0.total_cmp(&b.0));
        let quarter = rows.len().div_ceil(4);
        let (light, heavy) = (&rows[..quarter], &rows[rows.len() - quarter..]);
        let middle = |of: &[(f64, f64)], value: fn(&(f64, f64)) -> f64| {
            median(&mut of.iter().map(value).collect::<Vec<_>>())
        };
        let step_n = middle(heavy, |r| r.0) - middle(light, |r| r.0);
        let told = step_n > 0.3 * middle(heavy, |r| r.0);
        told.then(|| (middle(heavy, |r| r.1) - middle(light, |r| r.1)) / step_n)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEADER: &str = "series,substrate,pins,sweep,load_mass_g,load_N,speed_pct,dwell_s,direction,repetition,position_mm,time_s,force_N";
    const LINE: &str = "0,silicone,,up,251.2,3.0766,47,3,eccentric,1,6.93,3.5,2.3157";

    #[test]
    fn one_load_or_readings_that_do_not_follow_it_fix_no_baseline() {
        let checked = |from: &str, to: &str| {
            let other = LINE.replacen("3.5", "7", 1).replacen(from, to, 1);
            let text = format!("{HEADER}\n{LINE}\n{other}\n");
            PlateauTable::read(text.as_bytes(), "t.csv").unwrap().require_baseline("t.csv")
        };
        assert!(matches!(checked("2.3157", "2.4"), Err(TableError::TooFewLoads { found: 1, .. })));
        assert!(matches!(checked("3.0766", "0"), Err(TableError::TooFewLoads { found: 1, .. })));
        let heavier = |reading: &str| {
            checked(
                "251.2,3.0766,47,3,eccentric,1,6.93,7,2.3157",
                &format!("800,9,47,3,eccentric,1,6.93,7,{reading}"),
            )
        };
        for (reading, slope) in [("2.3157", "0.00"), ("-6", "-1.40"), ("6000", "1012.54")] {
            let error = heavier(reading).unwrap_err().to_string();
            assert!(error.contains(&format!("changes by {slope} N")), "{error}");
        }
        assert!(heavier("7.1").is_ok());
        let grams =
            checked("251.2,3.0766,47,3,eccentric,1,6.93,7,2.3157", "800,800,47,3,eccentric,1,6.93,7,700");
        assert!(matches!(grams, Err(TableError::LoadUnit { factor, .. }) if factor > 100.0));
    }
}
