//! Faults of raw logs, which are divided into plateaus.

pages! {
    "Raw logs";

    TOO_FEW_SAMPLES: "too-few-samples", "The log has too few usable samples", in "model/doc/file-formats.md" {
        "Lines without a time and a force are skipped, and at least 30 samples must remain. A \
         log of many lines with few samples usually has another delimiter, decimal sign or \
         column name than expected.",
        "`pinswitch import` shows how it reads each column of a file.",
    }

    IMPOSSIBLE_CLOCK: "impossible-clock", "The times of the log are not those of a clock", in "model/doc/logs.md" {
        "Stamps must increase, with a sampling period from 50 microseconds to 0.5 s in some \
         unit, or at the declared `rig.sample_rate_hz`. A column whose name gives another unit \
         than its values, or whose lines are in reverse order, does not.",
        "Declare the rate, or write the times in seconds. If two units are possible, only a \
         declared rate decides.",
    }

    OVERLAPPING_CLOCKS: "overlapping-clocks", "Two logs have overlapping times", in "model/doc/logs.md" {
        "A clock that runs on orders the logs of a session, and one that restarts near zero \
         continues at the end of the log before. Stamps that overlap are neither: a log may be \
         listed twice, or come from another computer.",
        "List each log once, with stamps of one clock.",
    }

    NO_LOAD_IN_LOG: "no-load-in-log", "The load of the log is missing", in "model/doc/file-formats.md" {
        "The load is an input of every model and cannot be estimated from the force, which \
         contains the friction.",
        "Give `load_mass_g` of the series (without the hook), or a column with the load.",
    }

    FORCE_AGAINST_LOAD: "force-against-load", "The force does not match the load", in "model/doc/file-formats.md" {
        "A tension is positive and, on a loaded tendon, at least a tenth of the load. A median \
         plateau below -0.1 of the load means a reversed sign; plateaus that are all below 0.1 \
         of it mean a slack tendon, another unit or another load.",
        "Change the sign or the unit of `force_N`, or correct the load.",
    }

    SEVERAL_LOADS_IN_LOG: "several-loads-in-log", "The log has plateaus at more than two levels", in "model/doc/logs.md" {
        "Friction puts one level above the load and one below it, so the plateaus of one load \
         are at two levels. More than two separate levels of two or more plateaus are several \
         loads.",
        "Give the load in a column or as a mark, at which the log is split, or write one log per \
         load.",
    }

    UNCERTAIN_DIRECTIONS: "uncertain-directions", "The directions of the moves are uncertain", in "model/doc/logs.md" {
        "Each witness (position, level of the force, step, power, order) names a direction with \
         a fixed reliability, and their odds are combined. A move under a probability of 0.99 is \
         left out; the log is refused if these are more than two and a tenth of the moves, or \
         all.",
        "The message names the witnesses that disagree. Declaring `rig.protocol` or recording \
         the position decides most cases.",
    }

    MOVES_NOT_VISIBLE: "moves-not-visible", "The force does not show the moves", in "model/doc/logs.md" {
        "Without power and position, moves are changes of the force. If the rests are irregular \
         and fewer than 0.7 of the declared moves are visible, or if more than two thirds would \
         have to be placed by the schedule, the plateaus would be guesses.",
        "Record the power or the position of the actuator.",
    }

    RESTS_NOT_DISTINGUISHED: "rests-not-distinguished", "The force does not distinguish rests from moves", in "model/doc/logs.md" {
        "While the actuator moves, the force is as steady as at rest, and in one direction it \
         alternates between two levels. By the force alone, either can be the rest.",
        "Declare `rig.on_s` and `rig.dwell_s`, or record the power or the position.",
    }

    NO_PLATEAU: "no-plateau", "No log contains a plateau", in "model/doc/logs.md" {
        "A plateau is a rest after a move, or the middle of a full cycle. The logs contain \
         neither, or their moves were left out.",
        "The findings that are printed for each log describe what it contains.",
    }
}
