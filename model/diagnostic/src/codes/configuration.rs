//! Faults of keys and values, in files of settings and in options.

pages! {
    "Files of settings and options";

    INVALID_TOML: "invalid-toml", "The text is not TOML", in "model/doc/file-formats.md" {
        "The reader of TOML stops at the first character that the format does not allow, and the \
         caret points to it. Frequent causes are a text without quotes, a key that occurs twice, \
         a bracket that is not closed, and a decimal comma.",
        "`pinswitch init` writes commented files of every kind to start from. With the schema \
         that `pinswitch schema KIND` prints, an editor marks such places while you type.",
    }

    UNKNOWN_FIELD: "unknown-field", "A field, table or key does not exist", in "model/doc/file-formats.md" {
        "A misspelled key would silently leave its default in force, so unknown names are \
         errors. The help gives the most similar known name, or lists those of the same table.",
        "`templates/reference.toml` lists every field of a configuration; `pinswitch schema \
         KIND` prints the keys of the other files.",
    }

    MISSING_FIELD: "missing-field", "A required key is absent", in "model/doc/file-formats.md" {
        "Most keys have a default. A key is required where no default would be true for your \
         file, such as the wrap angle of a run or the formula of an effect.",
        "`pinswitch init KIND` writes an example with every required key.",
    }

    WRONG_TYPE: "wrong-type", "A value has the wrong type", in "model/doc/file-formats.md" {
        "Numbers and booleans are written without quotes and texts with quotes, lists are in \
         brackets, and tables have keys of their own. A fraction is not accepted where a count \
         is needed, such as 3.5 grooves.",
        "The message names the type that the field needs.",
    }

    OUT_OF_RANGE: "out-of-range", "A number is outside its range", in "cad/doc/dimensions.md" {
        "Each number has a range, within which geometry can be constructed and computations stay \
         finite. A number outside is often in another unit: lengths are in mm, angles in \
         degrees, loads in newtons, unless the name of the field says otherwise.",
        "`pinswitch init reference` writes the range of every field of a configuration with its \
         origin. `pinswitch generate --fix` moves a number outside its range to the nearest end \
         of the range.",
    }

    UNKNOWN_WORD: "unknown-word", "The word or name is not one that is possible" {
        "Some values choose one of a few alternatives, and no other word has a meaning. Names \
         become parts of file names, ids and engraved labels, and are therefore restricted in \
         length and in characters.",
        "The help lists the words, or gives the form of a name. Capital letters and hyphens \
         count.",
    }

    INVALID_RANGE: "invalid-range", "A range is empty or reversed" {
        "A range is given by its smaller and its larger end, in this order, such as 3..6. A \
         reversed range is more often a mistake than an empty request, so it is refused.",
        "Exchange the two ends.",
    }

    CONFLICTING_SETTINGS: "conflicting-settings", "Two settings exclude each other" {
        "Both settings determine the same thing, or one has no meaning with the other. The \
         program does not choose between them, because the result would depend on their order.",
        "Leave one of them out, as the help proposes.",
    }

    DUPLICATE_ENTRY: "duplicate-entry", "An entry occurs twice" {
        "Two entries have the same name, and later references to it would be ambiguous.",
        "Remove one of them, or give it another name.",
    }

    TOO_MANY_ENTRIES: "too-many-entries", "A list or a number is longer than possible" {
        "The bound limits time or memory: the work grows with each entry, or the file of a \
         request is read as a whole.",
        "Divide the list, or remove entries that are not needed. The message gives the bound.",
    }

    OTHER_KIND_OF_FILE: "other-kind-of-file", "The file is of another kind or version than expected", in "model/doc/file-formats.md" {
        "Each kind of file has its own keys, and files that the program writes for itself begin \
         with the name and version of their format, such as `pinswitch.effects/1`. A file of \
         another kind or version could have keys of another meaning, so it is not read. A 3MF \
         that another program saved has lost its configuration.",
        "The help names the command or the file that fits. `pinswitch help COMMAND` lists the \
         files that a command takes.",
    }

    MALFORMED_VALUE: "malformed-value", "The text of a value or an option is not well-formed" {
        "Numbers have a decimal point and no unit unless the help names one, ranges are written \
         A..B, and assignments KEY=VALUE, such as `--set segment.grooves=20`. A shell divides a \
         text at blanks and removes quotes, and the message quotes the text as it arrived.",
        "Put values with blanks, brackets or quotes into single quotes.",
    }
}
