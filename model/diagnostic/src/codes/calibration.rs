//! Faults of files of models, plans and simulated rigs.

pages! {
    "Models, experiments and simulation";

    INVALID_MODEL: "invalid-model", "The model file contradicts itself", in "model/doc/file-formats.md" {
        "Constants, conditions, noise and covariance of a model depend on each other, and each \
         has bounds: the covariance must be symmetric and positive semidefinite, for instance. \
         An edit by hand usually breaks this.",
        "Use the file as `calibrate` wrote it, or calibrate again.",
    }

    COVARIATE_MISSING: "covariate-missing", "The rows lack a covariate of the model", in "model/doc/file-formats.md" {
        "An effect of the model depends on a quantity that the rows do not have, so their \
         readings cannot be predicted with it.",
        "Give the column in every row. baseline.toml has no effects and needs no covariates.",
    }

    MODEL_NOT_FINITE: "model-not-finite", "The model gives no finite number", in "model/doc/calibration.md" {
        "A prediction is infinite, not a number, or far beyond any tendon. Either the values of \
         the table are impossible for a rig, or the effects of the model are used far outside \
         the range in which they were fitted.",
        "Check loads, speeds and times of the rows that the message names.",
    }

    CALIBRATION_INCOMPLETE: "calibration-incomplete", "The folder is not a complete calibration", in "model/doc/next-experiment.md" {
        "`experiment` reads report.json, model.toml and residuals.csv of one calibration. They \
         are missing, or come from different calibrations.",
        "Give the folder as `calibrate` wrote it, with the effects that it tested.",
    }

    NO_RUN_FITS: "no-run-fits", "No run fits the rig or the time", in "model/doc/next-experiment.md" {
        "A run must stay below 90 % of the load cell's range, and fit into the minutes of the \
         session with the times for changing loads and mounts in rig.toml.",
        "Lighter weights, more `--minutes` or shorter times give the search something to choose.",
    }

    PLAN_NOT_USABLE: "plan-not-usable", "The plan of the session cannot be used", in "model/doc/next-experiment.md" {
        "A plan is the folder that `experiment` wrote: next-runs.csv lists the runs, and \
         experiment.json the questions. Cells outside their bounds, a missing file or an empty \
         plan leave nothing to compare a table with.",
        "Give the folder as it was written.",
    }

    PLAN_NOT_FOLLOWED: "plan-not-followed", "The table does not follow its plan", in "model/doc/next-experiment.md" {
        "The rows are matched with the planned runs by contact, load, sweep, speed and dwell. If \
         less than half of the runs are found, the table is not that of the plan. Missing runs \
         and another order are warnings, since they weaken conclusions about time and about the \
         previous load.",
        "Give the table of the planned session, or leave out `--plan`.",
    }

    PLAN_OF_RIG_INCONSISTENT: "plan-of-rig-inconsistent", "The simulated rig is not possible", in "model/doc/file-formats.md" {
        "The values of a plan for `simulate` are valid one by one, but not together: an effect \
         has another number of constants, raw logs would need several dwells, or a reading \
         exceeds the range of a table.",
        "`pinswitch init plan` writes a plan to start from.",
    }
}
