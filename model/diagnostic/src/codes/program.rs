//! Faults of the command line and of the program itself.

pages! {
    "The program";

    USAGE: "usage", "The arguments of the command are not valid" {
        "The command line has an unknown option or command, lacks a required argument, or gives \
         a value that the option does not take. Nothing was written.",
        "`pinswitch help COMMAND` describes the arguments, with examples. Shell completions come \
         from `pinswitch completions`.",
    }

    FEATURE_NOT_BUILT: "feature-not-built", "This build lacks the feature" {
        "Parts of the program are optional when it is built: the second CAD kernel (`truck`), \
         buckets (`cloud`), and readers of workbooks and Parquet files in the browser.",
        "Use a build with the feature, or the way around it that the help names.",
    }

    CANNOT_START: "cannot-start", "A thread, program or server cannot be started" {
        "The operating system refused: a limit on processes or memory, a missing program, or a \
         port that another program uses. The line `cause` has its message.",
        "Give fewer `--threads`, another port (0 for any free one), or install the program.",
    }

    NOT_SAVED: "not-saved", "The server cannot save the configuration" {
        "The page of `pinswitch view` saves only into the text file that the server was started \
         with. A template or a 3MF is not such a file.",
        "Start `pinswitch view FILE.toml`.",
    }

    CONFIGURATION_CHANGED: "configuration-changed", "The configuration was changed to make it valid", in "cad/doc/dimensions.md" {
        "`generate --fix` makes the nearest configuration that can be built, so the parts are \
         not those of the file. Each change is printed, and the fixed configuration is written \
         next to the parts.",
        "Compare the changes with what you need; without `--fix` the first broken rule ends the \
         command.",
    }

    INTERNAL_ERROR: "internal-error", "The program has met an error of its own" {
        "Something happened that no input should cause: a value that cannot be encoded, or a \
         computation that stopped. Nothing incomplete was left under a final name.",
        "Please report the command with its input, and the lines `cause`.",
    }
}
