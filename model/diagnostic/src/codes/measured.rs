//! Faults of plateau tables, which a calibration reads, and of other measured values.

pages! {
    "Measured tables";

    TABLE_WITHOUT_ROWS: "table-without-rows", "The table is empty", in "model/doc/file-formats.md" {
        "A header alone is not data. The file may be the output of a command that found no \
         plateau.",
        "Write one line per repetition below the header.",
    }

    MISSING_COLUMN: "missing-column", "The header lacks a column", in "model/doc/file-formats.md" {
        "Names of columns are exact, with their unit. `load_N`, `direction`, `force_N` and a few \
         more are required; covariates such as `speed_pct` may be absent, and their effects are \
         then not identifiable.",
        "`pinswitch import` converts a file with other names and units, and `pinswitch segment` \
         converts raw logs.",
    }

    INVALID_CELL: "invalid-cell", "A cell cannot be read", in "model/doc/file-formats.md" {
        "The cell is not a number or a word of its column, or the number is outside the bounds \
         of that column. A repeated reading (same session, series, direction, repetition and \
         time) is reported here as well, because it would count twice.",
        "Leave unknown values empty instead of writing a placeholder such as -999 or n/a.",
    }

    MALFORMED_TABLE: "malformed-table", "The file is not a CSV table", in "model/doc/file-formats.md" {
        "Every line must have as many cells as the header, separated by commas, in UTF-8. \
         Decimal commas and semicolons, as some spreadsheets write them, are not this format.",
        "`pinswitch import` reads such files and writes a table.",
    }

    SESSION_IN_TWO_FILES: "session-in-two-files", "Two files contain the same session", in "model/doc/calibration.md" {
        "A session is a table or a day, with a common time and load cell, and has effects of its \
         own in the model. Two files with one session name would be fitted as one.",
        "Name the sessions in a column `session`, or leave out one of the files.",
    }

    READINGS_DO_NOT_FOLLOW: "readings-do-not-follow", "The readings do not follow the loads", in "model/doc/file-formats.md" {
        "On any tendon the force rises with the load, by 0.2 to 5 N per newton at the wrap of \
         the paper, and with a rank correlation above 0.5. If most conditions depart from it, \
         the table as a whole does not describe such a rig.",
        "Usual causes are a wrong sign, a wrong unit, exchanged columns, or a cable of the load \
         cell that was not connected.",
    }

    SWAPPED_COLUMNS: "swapped-columns", "Two columns have each other's values", in "model/doc/file-formats.md" {
        "The values show it, and the message gives the evidence: for instance a force that is \
         constant in both directions while the load is not, or a load that does not match the \
         declared masses while another column does.",
        "Exchange the two names in the header.",
    }

    SWAPPED_DIRECTIONS: "swapped-directions", "The labels of the two directions are exchanged", in "model/doc/file-formats.md" {
        "Friction adds to the force while a load is pulled (concentric), and subtracts while it \
         is released (eccentric). In most conditions, or in more than three series, the labels \
         contradict the readings; in a table with one direction, the readings are on the wrong \
         side of their loads.",
        "Exchange the two words, or `load_N` and `force_N` if these are exchanged. A calibration \
         can leave out up to three such series.",
    }

    NO_FRICTION: "no-friction", "The readings show no friction", in "model/doc/file-formats.md" {
        "In every condition, half of the difference between the directions is within three \
         standard errors of zero. There is nothing to calibrate.",
        "Often `force_N` is a copy of the declared load, or the load cell is on the wrong side \
         of the switch.",
    }

    READING_UNIT: "reading-unit", "The readings have another unit than the loads", in "model/doc/file-formats.md" {
        "Averaged over both directions friction cancels, and the readings must rise by about one \
         newton per newton of load: 0.6 to 1.6. Another factor means another unit, or a pulley \
         between tendon and cell.",
        "Convert both columns to newtons at the tendon. `pinswitch import --set factor.NAME=...` \
         does so.",
    }

    MIXED_SERIES: "mixed-series", "A series has several conditions or loads", in "model/doc/file-formats.md" {
        "A series is recorded without a break, on one contact and at one load: its rows share \
         random effects in the model. Another layout or substrate, or a load that is more than \
         2.5 times as heavy, starts another series.",
        "Give each its own name.",
    }

    SCATTERED_WRAPS: "scattered-wraps", "The wrap angle was measured for each row", in "model/doc/file-formats.md" {
        "Each wrap angle is a condition with its own constants, and at most 8 angles are \
         possible for one layout. Measured angles scatter, and every row would become a \
         condition.",
        "Write the nominal angle of each mount.",
    }

    TOO_FEW_LOADS: "too-few-loads", "Too few different loads", in "model/doc/file-formats.md" {
        "How friction grows with the load is the basis of every model, and one load at one wrap \
         angle does not determine it. At least two different loads above zero are needed.",
        "Add series with other weights, or with other wrap angles of a plain contact.",
    }

    TOO_FEW_ROWS: "too-few-rows", "Too few rows for a calibration", in "model/doc/calibration.md" {
        "The rows must determine the constants of the baseline and the noise: at least the \
         number of constants and eight more.",
        "Record more loads, or more repetitions.",
    }

    COPIED_READINGS: "copied-readings", "Readings are a copy of others", in "model/doc/file-formats.md" {
        "A table shares most of its readings with another one at the same times, or a series \
         agrees with another one to the last digit, which noise does not allow. As another \
         measurement, the copy would look like a perfect repetition, and all intervals would \
         become too narrow.",
        "Leave out the copy.",
    }

    LOAD_UNIT: "load-unit", "The loads are not in newtons", in "model/doc/file-formats.md" {
        "`load_N` is less than half or more than twice the weight of `load_mass_g`, or half of \
         the loads are outside 0.3 to 1000 N, the range of a tendon on a printed switch.",
        "A kilogram weighs 9.80665 N; grams are divided by 101.97, and kilonewtons multiplied by \
         1000. Leave the mass empty if it is unknown.",
    }
}
