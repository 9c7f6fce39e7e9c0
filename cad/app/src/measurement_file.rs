//! A file of measurements that was dropped on the page: a plateau table, or the file of a laboratory.

use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use pinswitch_calibration::table::PlateauTable;
use pinswitch_diagnostic::{Diagnostic, Location, codes};
use pinswitch_import::{Import, Map, Output, Question, Source, import};
use serde::Serialize;

use crate::Answer;
use crate::calibration::MAX_TABLE_MB;

/// What the page shows of a file before it is used.
#[derive(Debug, Default, PartialEq, Serialize)]
struct Preview {
    /// What was recognised, ignored and assumed, as `pinswitch import` prints it; empty for a plateau table.
    understood: String,
    /// Names of the columns of the file.
    columns: Vec<String>,
    /// What has two readings.
    questions: Vec<Question>,
    /// The plateau table; absent for a log, and while a question is open.
    csv: Option<String>,
    /// Whether it is a log, which a page cannot segment.
    is_log: bool,
}

/// Answers what a file contains; `data` is its content in base64, `file` its name, and `set` are values of a map.
pub(crate) fn answer(data: &str, file: &str, set: &[String]) -> Answer {
    preview(data, file, set).map_or_else(Answer::error, |preview| Answer::json(&preview))
}

fn preview(data: &str, file: &str, set: &[String]) -> Result<Preview, Diagnostic> {
    // A third more characters than bytes.
    if data.len() / 4 * 3 > MAX_TABLE_MB * 1_000_000 {
        return Err(Diagnostic::new(
            codes::FILE_TOO_LARGE,
            format!("the file has more than {MAX_TABLE_MB} MB"),
        )
        .with_location(Location::file(file))
        .with_help("import it with `pinswitch import`"));
    }
    let bytes = BASE64_STANDARD.decode(data).map_err(|e| Diagnostic::from_error(codes::DAMAGED_FILE, e))?;
    let plateaus = std::str::from_utf8(&bytes).ok().filter(|text| PlateauTable::has_header(text));
    let as_plateaus = |text: &str| Preview { csv: Some(text.to_owned()), ..Preview::default() };
    if let Some(text) = plateaus.filter(|text| PlateauTable::read(text.as_bytes(), file).is_ok()) {
        return Ok(as_plateaus(text));
    }
    let mut map = Map::default();
    for assignment in set {
        map.set(assignment)?;
    }
    let Import { understanding, output, .. } = match (import(&[Source::new(file, &bytes)], &map), plateaus) {
        (Ok(import), _) => import,
        // A table of plateaus with an error, which its calibration reports by line and column.
        (Err(_), Some(text)) if set.is_empty() => return Ok(as_plateaus(text)),
        (Err(error), _) => return Err(error),
    };
    Ok(Preview {
        understood: understanding.to_string(),
        is_log: understanding.kind == "log",
        columns: understanding.files.iter().flat_map(|f| f.columns.iter().map(|c| c.name.clone())).collect(),
        questions: understanding.questions,
        csv: match output {
            Some(Output::Table(csv)) => Some(csv),
            _ => None,
        },
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dropped(text: &str, set: &[&str]) -> Result<Preview, Diagnostic> {
        let set: Vec<String> = set.iter().map(|one| (*one).to_owned()).collect();
        preview(&BASE64_STANDARD.encode(text), "rig.csv", &set)
    }

    #[test]
    fn plateau_tables_need_no_import() {
        let table = "series,substrate,pins,load_N,direction,force_N\na,plain,,10,concentric,x\n";
        let preview = dropped(table, &[]).unwrap();
        assert_eq!((preview.csv.as_deref(), preview.understood.as_str()), (Some(table), ""));
    }

    #[test]
    fn files_of_laboratories_are_shown_first() {
        let preview = dropped("Last [kg];F_heben [N];F_senken [N]\n1,5;19,25;11,2\n", &[]).unwrap();
        assert!(preview.understood.contains("x 1000 -> g"), "{}", preview.understood);
        assert!(preview.csv.unwrap().contains("concentric,19.25"));
        let log = dropped("t/ms;Kraft [N]\n0;1,5\n10;1,6\n20;1,7\n", &[]).unwrap();
        assert!(log.is_log && log.csv.is_none(), "{log:?}");
    }

    #[test]
    fn answers_close_questions() {
        let text = "Last [N];F_heben [N];F_senken [N]\n1,500;2,500;1,200\n2,500;4,500;2,100\n";
        let open = dropped(text, &[]).unwrap();
        assert!(open.csv.is_none() && !open.questions.is_empty(), "{open:?}");
        let option = &open.questions[0].answers[0].options[0];
        let closed = dropped(text, &[option]).unwrap();
        assert!(closed.questions.is_empty() && closed.csv.is_some(), "{closed:?}");
        assert!(dropped("a,b\n1,2\n", &[]).is_err());
        assert!(dropped(text, &["nonsense"]).is_err());
    }
}
