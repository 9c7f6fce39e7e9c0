//! Faults of friction laws, requests for designs, and the analysis of tolerances.

pages! {
    "Predictions, designs and tolerances";

    LAW_DOES_NOT_APPLY: "law-does-not-apply", "The friction law does not describe this contact", in "model/doc/friction-laws.md" {
        "Each law was derived or fitted for certain contacts, such as one of the published \
         layouts. It gives no number for other contacts, rather than a wrong one.",
        "The help names a law for this contact. The default, `physics`, applies to any pattern \
         of pins.",
    }

    PHYSICS_NOT_CONVERGED: "physics-not-converged", "A computation did not converge", in "model/doc/physics.md" {
        "The law `physics` balances the forces on a tendon over pins in silicone by Newton's \
         method, and iterates between shape and tension. It stops with an error after a fixed \
         number of steps. A fit stops as well if the data do not determine its parameters.",
        "Use `--law layout`, and please report the configuration.",
    }

    NO_SUPPORT: "no-support", "Nothing carries the tendon", in "model/doc/friction-laws.md" {
        "Without a contact there is no friction to compute. On the rigid proxy the pins alone \
         carry the tendon, so at least one must be within the wrap; silicone carries it also \
         without pins.",
        "Put a pin near the middle groove, or use silicone as the substrate.",
    }

    MODEL_BEYOND_RIG: "model-beyond-rig", "A calibrated model does not cover this switch", in "model/doc/calibration.md" {
        "A calibration describes the rig of its data: its 15 grooves, its wrap angle and the \
         contacts that can be placed on them. Elsewhere its constants say nothing.",
        "Leave out `--model` to use the published constants, or give a configuration that the \
         rig could carry.",
    }

    CONTRADICTORY_TARGETS: "contradictory-targets", "Targets of the request contradict each other", in "cad/doc/design.md" {
        "No switch can satisfy both, whatever its dimensions: for instance two ranges of one \
         quantity that do not overlap.",
        "Drop one of the two, or widen it.",
    }

    REQUEST_IMPOSSIBLE: "request-impossible", "No design satisfies the request", in "cad/doc/design.md" {
        "The result is then the nearest design, with the targets that it misses and the limit \
         that blocks it: the end of a range, a list of materials, a size, the number of pins, or \
         the physics.",
        "The help lists parameters that would help, fixed or varied. Each was tested alone over \
         its range, so the advice is verified. If no layout can be printed at all, start from \
         another configuration.",
    }

    SWITCH_WITHOUT_THRESHOLD: "switch-without-threshold", "The switch has no threshold in the range of loads", in "model/doc/friction-laws.md" {
        "The threshold is the load at which silicone carries half of the friction. A rigid proxy \
         has no silicone, a switch without pins in the wrap has nothing else, and a stiff one \
         may reach it only beyond `friction.load_max_n`.",
        "The help names what to change; with other loads the curve itself is still predicted.",
    }

    SCATTER_NOT_REACHED: "scatter-not-reached", "No processes reach the wanted scatter", in "cad/doc/tolerances.md" {
        "The allocation chooses one process for each dimension of the chain so that the scatter \
         of the threshold is at most the wanted one. Even the best process of every dimension \
         gives a larger one.",
        "Widen the request. The table that the command prints shows which dimensions contribute \
         most.",
    }

    TENSION_NOT_INCREASING: "tension-not-increasing", "The tension does not grow with the load" {
        "Models for robot simulators look up tensions over load and wrap angle, and interpolate \
         between them. They need a table that increases with the load, of at least two loads.",
        "Give more loads, or another law.",
    }

    INVALID_REQUIREMENT: "invalid-requirement", "The request is not well-formed", in "cad/doc/design.md" {
        "A request has at least one target: a threshold, a friction at a load, a largest \
         friction, a friction at low load, or a stiffness. Each is a number (about that value), \
         a phrase with its bounds, or in a file also a table.",
        "The help lists the forms, and which targets need a load in addition. `pinswitch init \
         request` writes a commented request.",
    }
}
