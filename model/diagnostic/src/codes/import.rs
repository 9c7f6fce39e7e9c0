//! Open questions and refusals of `pinswitch import`.

pages! {
    "Imports";

    AMBIGUOUS_NUMBER: "ambiguous-number", "A number, date or time has two readings", in "model/doc/import.md" {
        "Such as 1,000 (one or a thousand), 3.4.2024 (April or March) or 10:30 (hours or \
         minutes). Nothing in the file decides, and a wrong guess would scale every value, so \
         nothing is written.",
        "The help lists an option for each reading. Repeat the command with one of them; the \
         written map keeps the decision for the next file of the same machine.",
    }

    AMBIGUOUS_COLUMN: "ambiguous-column", "The meaning of columns or rows is open", in "model/doc/import.md" {
        "Several columns may be the same quantity, a column may be one of two quantities, \
         numbers in names may count trials or be wrap angles, or rows may be samples of a log or \
         steady readings. The names that machines write are not unique.",
        "Decide with the listed options, such as `column.NAME=QUANTITY`, or with \
         `column.NAME=ignore` for those that are not needed.",
    }

    UNKNOWN_UNIT: "unknown-unit", "The unit is not known", in "model/doc/import.md" {
        "A column of a measured file has no unit, or one that does not belong to its quantity. \
         Values alone rarely show their unit: 20 can be newtons or kilograms. Signals in volts \
         or counts need a calibration line in addition, `factor` and `offset`.",
        "Give it with `--set unit.NAME=N`. In formulas, units are products and powers of 1, N, \
         %, s, mm and rad.",
    }

    UNKNOWN_DIRECTION: "unknown-direction", "The direction of readings is not known", in "model/doc/import.md" {
        "Friction has opposite signs while a load is pulled (concentric) and released \
         (eccentric), so a reading without a direction does not determine it. Common words such \
         as pull and release, or up and down, are known.",
        "Define the others with `--set concentric=WORD`, or give one direction to all rows with \
         `--set direction=concentric`.",
    }

    DIRECTION_AGAINST_FORCE: "direction-against-force", "The directions contradict the forces", in "model/doc/import.md" {
        "At the same load the force is higher while the load is pulled. At most loads it is \
         lower here, so the words may have the opposite meaning in this file.",
        "Decide with the listed options. If the load cell reads a tension as negative, decide \
         its sign first.",
    }

    UNKNOWN_LOAD: "unknown-load", "The load or wrap angle of readings is not known", in "model/doc/import.md" {
        "Each row of a table needs the load. It can be in a column, in the names of columns or \
         files, or the same for the whole file. An empty cell is not taken from above unless you \
         allow it.",
        "Use `--set load_kg=2`, `--set column.NAME=load`, `--set fill.NAME=down`, or `--pattern` \
         for names of files.",
    }

    NEGATIVE_FORCES: "negative-forces", "Nearly all forces are negative", in "model/doc/import.md" {
        "A tension is positive here. A load cell may read it as negative, depending on its \
         mounting.",
        "`--set force_sign=-1` reverses the sign; `force_sign=1` keeps it.",
    }

    NOT_A_TEXT: "not-a-text", "The file is neither a text nor a known format", in "model/doc/import.md" {
        "Text, LVM, Excel, OpenDocument and Parquet are read; TDMS, HDF5, MATLAB and PDF are \
         recognised but not read. A text with bytes that the named encoding does not allow is \
         not in that encoding.",
        "Export the data as CSV, or leave out the encoding so that it is detected.",
    }

    NO_TABLE_FOUND: "no-table-found", "The file has no table of names and numbers", in "model/doc/import.md" {
        "The import searches a line of names that is followed by lines of numbers with as many \
         cells. A header of another width, or numbers that a decimal comma splits, hide it.",
        "Give the line with `--set header=N`, or the names with `--set names=time_s,force_N`.",
    }

    UNKNOWN_COLUMN: "unknown-column", "The column or sheet does not exist", in "model/doc/import.md" {
        "A map or an option names a column or a sheet that the file does not have. Names are \
         compared with those of the file, and numbers count columns from 1.",
        "The help lists the names of the file. A map of another machine is the usual cause.",
    }

    UNUSABLE_CELLS: "unusable-cells", "Cells of the table are not usable", in "model/doc/import.md" {
        "A needed cell is not a number, has another unit than its column, or has a value that \
         contradicts a given constant. Leaving rows out silently would change the result.",
        "Correct the cell, or leave such rows out with `--set bad_rows=skip`, which lists them.",
    }

    NO_FORCE_COLUMN: "no-force-column", "The columns of force and time are missing or several", in "model/doc/import.md" {
        "A log is one force over time, and a table has one force in each row or several in \
         columns that name their condition. Other columns of forces may be set values or other \
         cells.",
        "Name the columns with `--set 'column.NAME=force'` and `--set unit.NAME=N`, and ignore \
         the others.",
    }

    SEVERAL_TABLES: "several-tables", "The file contains blocks of different columns", in "model/doc/import.md" {
        "A second header with other names or units begins in the file, or channels have times of \
         their own. The rows of both do not form one table.",
        "Give each block in a file of its own; `import` takes several files. In LabVIEW, export \
         with one time column.",
    }

    FILES_DO_NOT_JOIN: "files-do-not-join", "The files are not parts of one table", in "model/doc/import.md" {
        "Several files become one table if all are tables with the load and the direction in \
         each row or name. A table and a log, or several logs, do not join.",
        "Import logs separately, and list the results in run.toml. For tables whose names have \
         the load, give `--pattern`.",
    }

    PATTERN_MISMATCH: "pattern-mismatch", "A name does not match the pattern", in "model/doc/import.md" {
        "`--pattern` reads values from names of files, such as `{load_g}g_{trial}.csv`. Texts \
         between the fields must occur in the name exactly, and two fields need a text between \
         them.",
        "Leave the file out, or change the pattern; `{_}` skips a part of the name.",
    }
}
