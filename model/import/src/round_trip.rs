//! A table in any dialect, language and unit gives the same plateau table to the last digit.

use proptest::prelude::*;

use crate::{Import, Map, Output, Source, import};

/// A reading: load in hundredths of a newton, whether the load is pulled, force in ten-thousandths
/// of a newton, position in hundredths of a millimetre, time in hundredths of a second.
type Reading = (i64, bool, i64, i64, i64);

/// How a table is written.
#[derive(Clone, Debug)]
struct Dialect {
    delimiter: char,
    has_comma: bool,
    is_quoted: bool,
    encoding: u8,
    language: usize,
    /// Powers of ten of the units of force, position and time.
    units: [usize; 3],
    has_units_row: bool,
    order: Vec<usize>,
    has_preamble: bool,
    line_end: &'static str,
}

/// Names of load, direction, force, position and time, and the words for pulled and released.
const LANGUAGES: [([&str; 5], [&str; 2]); 5] = [
    (["Load", "Direction", "Force", "Position", "Time"], ["pull", "release"]),
    (["Last", "Richtung", "Kraft", "Weg", "Zeit"], ["heben", "senken"]),
    (["Charge", "Sens", "Effort", "Déplacement", "Temps"], ["montée", "descente"]),
    (["Carga", "Dirección", "Fuerza", "Posición", "Tiempo"], ["subida", "bajada"]),
    (["Carico", "Direzione", "Forza", "Corsa", "Tempo"], ["salita", "discesa"]),
];

/// Units with the power of ten by which their numbers are larger.
const FORCES: [(&str, i32); 3] = [("N", 0), ("kN", -3), ("mN", 3)];
const LENGTHS: [(&str, i32); 3] = [("mm", 0), ("cm", -1), ("m", -3)];
const TIMES: [(&str, i32); 3] = [("s", 0), ("ms", 3), ("us", 6)];

/// Writes `value` times ten to the power of `exponent`, without an exponent.
fn decimal(value: i64, exponent: i32, sign: char) -> String {
    let minus = if value < 0 { "-" } else { "" };
    let digits = value.unsigned_abs().to_string();
    let places = usize::try_from(-exponent).unwrap_or(0);
    if places == 0 {
        return format!("{minus}{digits}{}", "0".repeat(usize::try_from(exponent).unwrap_or(0)));
    }
    let digits = format!("{digits:0>width$}", width = places + 1);
    let (whole, fraction) = digits.split_at(digits.len() - places);
    format!("{minus}{whole}{sign}{fraction}")
}

fn write(readings: &[Reading], dialect: &Dialect) -> Vec<u8> {
    let (names, words) = LANGUAGES[dialect.language];
    let sign = if dialect.has_comma { ',' } else { '.' };
    let units = ["N", "", FORCES[dialect.units[0]].0, LENGTHS[dialect.units[1]].0, TIMES[dialect.units[2]].0];
    let exponents = [FORCES[dialect.units[0]].1, LENGTHS[dialect.units[1]].1, TIMES[dialect.units[2]].1];
    let mut lines: Vec<Vec<String>> = Vec::new();
    lines.push(
        (0..5)
            .map(|i| {
                if dialect.has_units_row || units[i].is_empty() {
                    names[i].to_owned()
                } else {
                    format!("{} [{}]", names[i], units[i])
                }
            })
            .collect(),
    );
    if dialect.has_units_row {
        lines.push(units.iter().map(|unit| (*unit).to_owned()).collect());
    }
    for (load, is_pulled, force, position, time) in readings {
        lines.push(vec![
            decimal(*load, -2, sign),
            words[usize::from(!is_pulled)].to_owned(),
            decimal(*force, exponents[0] - 4, sign),
            decimal(*position, exponents[1] - 2, sign),
            decimal(*time, exponents[2] - 2, sign),
        ]);
    }
    let mut text = String::new();
    if dialect.has_preamble {
        text.push_str(&format!("Friction test 7{0}Operator: A{0}", dialect.line_end));
    }
    for cells in &lines {
        let quoted = |cell: &String| {
            let needs = dialect.is_quoted || cell.contains(dialect.delimiter);
            if needs { format!("\"{cell}\"") } else { cell.clone() }
        };
        let cells: Vec<String> = dialect.order.iter().map(|i| quoted(&cells[*i])).collect();
        text.push_str(&cells.join(&dialect.delimiter.to_string()));
        text.push_str(dialect.line_end);
    }
    encode(&text, dialect.encoding)
}

fn encode(text: &str, encoding: u8) -> Vec<u8> {
    match encoding {
        0 => text.as_bytes().to_vec(),
        1 => [b"\xef\xbb\xbf", text.as_bytes()].concat(),
        2 => std::iter::once(0xfeff).chain(text.encode_utf16()).flat_map(u16::to_le_bytes).collect(),
        3 => std::iter::once(0xfeff).chain(text.encode_utf16()).flat_map(u16::to_be_bytes).collect(),
        // Latin-1.
        _ => text.chars().map(|c| u8::try_from(u32::from(c)).unwrap_or(b'?')).collect(),
    }
}

const PLAIN: Dialect = Dialect {
    delimiter: ',',
    has_comma: false,
    is_quoted: false,
    encoding: 0,
    language: 0,
    units: [0, 0, 0],
    has_units_row: false,
    order: Vec::new(),
    has_preamble: false,
    line_end: "\n",
};

fn plain() -> Dialect {
    Dialect { order: (0..5).collect(), ..PLAIN }
}

fn read(bytes: &[u8], map: &Map) -> Import {
    import(&[Source::new("table.csv", bytes)], map).unwrap()
}

fn table(import: &Import) -> &str {
    match &import.output {
        Some(Output::Table(csv)) => csv,
        other => panic!("{other:?} {:?}", import.understanding.questions),
    }
}

/// Readings whose forces agree with their directions: the force is 0.5 to 0.9 or 1.1 to 1.5 of the
/// load.
fn readings() -> impl Strategy<Value = Vec<Reading>> {
    let reading = (1_i64..2_000, 1_i64..4_000, -20_000_i64..20_000);
    prop::collection::vec(reading, 4..40).prop_map(|all| {
        let mut readings = Vec::new();
        for (i, (load, share, position)) in all.into_iter().enumerate() {
            let time = i64::try_from(i).unwrap_or(0) * 2 * 317;
            let load = load * 10 + 1;
            readings.push((load, true, load * (11_000 + share) / 100, position, time));
            readings.push((load, false, load * (9_000 - share) / 100, position, time + 317));
        }
        readings
    })
}

fn dialect() -> impl Strategy<Value = Dialect> {
    let signs = (prop::sample::select(vec![',', ';', '\t', '|']), any::<bool>(), any::<bool>(), 0_u8..5);
    let units = [0_usize..3, 0..3, 0..3];
    let rest = (0_usize..5, units, any::<bool>(), any::<bool>(), prop::sample::select(vec!["\n", "\r\n"]));
    (signs, rest, Just((0..5).collect::<Vec<usize>>()).prop_shuffle()).prop_map(|(signs, rest, order)| {
        Dialect {
            delimiter: signs.0,
            has_comma: signs.1,
            is_quoted: signs.2,
            encoding: signs.3,
            language: rest.0,
            units: rest.1,
            has_units_row: rest.2,
            order,
            has_preamble: rest.3,
            line_end: rest.4,
        }
    })
}

/// Writes a wide table: one row for each load, with a column for each direction.
fn write_wide(readings: &[Reading]) -> String {
    let mut text = String::from("Last [N];F_heben [kN];F_senken [kN]\n");
    for pair in readings.chunks(2) {
        let [pulled, released] = pair else { continue };
        let force = |reading: &Reading| decimal(reading.2, -7, ',');
        text.push_str(&format!("{};{};{}\n", decimal(pulled.0, -2, ','), force(pulled), force(released)));
    }
    text
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn dialects_give_the_same_table(readings in readings(), dialect in dialect()) {
        let expected = read(&write(&readings, &plain()), &Map::default());
        let import = read(&write(&readings, &dialect), &Map::default());
        prop_assert_eq!(table(&import), table(&expected));
    }

    #[test]
    fn the_map_repeats_the_import(readings in readings(), dialect in dialect()) {
        let bytes = write(&readings, &dialect);
        let import = read(&bytes, &Map::default());
        let text = import.map.to_toml();
        let again = read(&bytes, &Map::parse(&text, "map.toml").unwrap());
        prop_assert_eq!(table(&again), table(&import));
        prop_assert_eq!(again.map.to_toml(), text);
    }

    #[test]
    fn wide_tables_give_the_same_readings(readings in readings()) {
        let long = read(&write(&readings, &plain()), &Map::default());
        let wide = read(write_wide(&readings).as_bytes(), &Map::default());
        let forces = |import: &Import| -> Vec<String> {
            let csv = table(import).to_owned();
            let names: Vec<&str> = csv.lines().next().unwrap_or_default().split(',').collect();
            let at = |name| names.iter().position(|n| *n == name).unwrap();
            let wanted = [at("series"), at("load_N"), at("direction"), at("force_N")];
            csv.lines().skip(1).map(|line| {
                let cells: Vec<&str> = line.split(',').collect();
                wanted.map(|i| cells[i]).join(",")
            }).collect()
        };
        prop_assert_eq!(forces(&wide), forces(&long));
    }

    #[test]
    fn any_bytes_end_with_a_result(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        let _ = import(&[Source::new("x", &bytes)], &Map::default());
    }

    #[test]
    fn any_text_ends_with_a_result(text in "[-a-zF \t,;:.0-9\"'#%\\[\\]()/\n]{0,300}") {
        let _ = import(&[Source::new("x", text.as_bytes())], &Map::default());
    }

    #[test]
    fn damaged_tables_end_with_a_result(readings in readings(), at in any::<prop::sample::Index>(), byte in any::<u8>()) {
        let mut bytes = write(&readings, &plain());
        let at = at.index(bytes.len());
        bytes[at] = byte;
        let _ = import(&[Source::new("x", &bytes)], &Map::default());
    }
}
