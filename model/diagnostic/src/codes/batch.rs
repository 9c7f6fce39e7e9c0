//! Faults of sweeps, shards and their results.

pages! {
    "Batches and tables of curves";

    INVALID_AXIS: "invalid-axis", "The axes of the sweep are not valid", in "cad/doc/batch.md" {
        "A sweep needs fields with values: in `[axes]` for all combinations, in `[sample]` for a \
         seeded sample, or in `[rows]` from a CSV file. An axis is a list, or a range with \
         `step` or `count`. A field varies in one place only, since the later value would hide \
         the earlier one, and the name of a variant cannot vary, since it is its id.",
        "`pinswitch init sweep` writes a commented sweep.",
    }

    TABLE_OF_ROWS_MALFORMED: "table-of-rows-malformed", "The table of rows is not a table of parameters", in "cad/doc/batch.md" {
        "The header names parameters, and each line has one cell for each of them, written as in \
         a configuration. A list has commas, so its cell is quoted: \"[5, 8]\".",
        "`pinswitch init configurations` writes an example.",
    }

    CONSTRAINT_NOT_SATISFIED: "constraint-not-satisfied", "A variant does not satisfy a constraint", in "cad/doc/batch.md" {
        "Each constraint of the sweep is a condition on fields, derived dimensions or predicted \
         quantities. It is not satisfied either if it depends on a value that does not exist, \
         such as the threshold of a switch that does not switch.",
        "The reason gives the values of the quantities in the condition. A refused variant does \
         not stop the others.",
    }

    TOO_MANY_VARIANTS: "too-many-variants", "The sweep has too many variants", in "cad/doc/batch.md" {
        "All combinations multiply: six axes of ten values are a million variants, with about \
         0.8 MB of disk each. Above a bound, `--yes` is required.",
        "`--dry-run` estimates time and size. `--shard K/N` makes a part.",
    }

    INVALID_SHARD: "invalid-shard", "The shard does not exist", in "cad/doc/batch.md" {
        "`--shard K/N` makes the K-th of N contiguous blocks of the variants, with K from 1 to \
         N. With more shards than variants some would be empty.",
        "All machines of one batch use the same N.",
    }

    OTHER_SWEEP: "other-sweep", "The folder contains another sweep", in "cad/doc/batch.md" {
        "A batch folder belongs to one sweep with all its inputs and options: batch.json has \
         their hash. A changed file, preset or option makes another sweep, whose variants would \
         be mixed with the old ones.",
        "Give another `--out`, or the options with which that batch was started.",
    }

    NOT_A_BATCH_FOLDER: "not-a-batch-folder", "The place is not a batch folder", in "cad/doc/batch.md" {
        "A folder or bucket of a batch has a batch.json at its top. A new batch needs an empty \
         or new place, so that it cannot overwrite foreign files.",
        "Check the path: variants are one level below it.",
    }

    SHARD_DAMAGED: "shard-damaged", "A shard is damaged", in "cad/doc/batch.md" {
        "A merge checks every file of every variant by the hashes that the shard recorded. A \
         file is missing or has changed, so nothing is written.",
        "Run the shard again: it makes only the missing and changed files.",
    }

    VARIANTS_FAILED: "variants-failed", "Some variants or rows failed or were refused", in "cad/doc/batch.md" {
        "A refused row or variant breaks a rule, or its law does not apply; a failed one could \
         not be made for another reason, such as an internal error. Each has its reason in the \
         table.",
        "The same command tries failed variants again, and keeps the finished ones.",
    }

    BATCH_STOPPED: "batch-stopped", "The batch was stopped", in "cad/doc/batch.md" {
        "Ctrl-C and SIGTERM finish the variants in progress, and then stop. Nothing is lost.",
        "The same command continues.",
    }

    SHARDS_DO_NOT_JOIN: "shards-do-not-join", "The shards do not make one batch", in "cad/doc/batch.md" {
        "Every variant must be in exactly one finished shard. A shard counts when its shard.json \
         exists, which is written last: a job may have failed, or still run. Variants in two \
         shards come from different divisions, such as 1/4 and 1/8.",
        "Run the options that the help gives, or leave one of the shards out.",
    }
}
