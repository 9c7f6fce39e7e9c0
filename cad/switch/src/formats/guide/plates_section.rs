//! The section of the plates, with files, parts and pictures.

use std::fmt::Write as _;

use crate::design::Design;
use crate::documents::Manifest;
use crate::formats::markdown::escape;
use crate::plates::Plate;

/// Returns the section of the plates. Files are listed only if the set has them.
pub(super) fn plates_section(design: &Design, manifest: &Manifest, plates: &[Plate<'_>]) -> String {
    let bed_mm = design.configuration().print.bed_mm;
    let mut text = "### Plates\n\n".to_owned();
    let has_files = !manifest.plates.is_empty();
    if let ([only], true) = (plates, has_files) {
        let _ = writeln!(
            text,
            "`{}` contains all parts on one plate, centred on a bed of {bed_mm} x {bed_mm} mm (`print.bed_mm`). Slice it unchanged.\n",
            only.package()
        );
    } else if has_files {
        let _ = writeln!(
            text,
            "The parts need {} plates of {bed_mm} x {bed_mm} mm (`print.bed_mm`), with a file each. Slice the files unchanged.\n\n\
             | plate | file | parts |\n|---|---|---|",
            plates.len()
        );
        for plate in plates {
            let names: Vec<&str> = plate.parts.iter().map(|(part, _)| part.part().name.as_str()).collect();
            let _ =
                writeln!(text, "| {} | {} | {} |", plate.number, plate.package(), escape(&names.join(", ")));
        }
        text.push('\n');
    }
    for plate in plates {
        let alt = match plate.of {
            1 => "The printed parts on a plate".to_owned(),
            _ => format!("Plate {}", plate.number),
        };
        let _ = writeln!(text, "![{alt}]({})\n", plate.picture());
    }
    text
}
