//! Faults of formulas, in effects and constraints.

pages! {
    "Formulas and user-defined effects";

    FORMULA_SYNTAX: "formula-syntax", "The formula is not complete or not well-formed", in "model/doc/own-effects.md" {
        "The reader expected something else at the caret: an operand, an operator or a bracket. \
         Comparisons cannot be chained, and a condition is no number: `40 < x < 60` is written \
         `40 < x && x < 60`.",
        "At most 100 operations may be nested, and a formula has up to 1000 characters.",
    }

    UNKNOWN_NAME: "unknown-name", "The name has no meaning here", in "model/doc/own-effects.md" {
        "Names are those of variables, functions, effects or constants of the same effect, and \
         capital letters count. The help gives the most similar one.",
        "`pinswitch effects --variables` lists variables and functions, and `pinswitch effects` \
         the effects.",
    }

    FORMULA_UNITS: "formula-units", "The units of the formula do not agree", in "model/doc/own-effects.md" {
        "Both sides of a sum or comparison have the same unit, functions such as exp take \
         dimensionless values, and the whole has the unit of the quantity on which the effect \
         acts. A formula with another unit would change with the choice of units.",
        "Divide by a reference, as in `load_n/50`, or give a constant a unit. Bare numbers take \
         the unit that makes a sum consistent.",
    }

    FORMULA_NOT_FINITE: "formula-not-finite", "The formula is not finite", in "model/doc/own-effects.md" {
        "Somewhere it divides by zero, or takes the logarithm or root of a negative number: at \
         its start values, on a row of the table, or in any case for a constant part. A fit \
         cannot continue there.",
        "Guard it, as in `ln(max(load_n, 0.1)/50)`, or narrow the bounds of the constants.",
    }

    INVALID_EFFECT: "invalid-effect", "The definition of an effect is not valid", in "model/doc/own-effects.md" {
        "An effect has a well-formed id that no other effect has, 1 to 8 constants with at least \
         one size, and start values within their bounds. Reports, priors and model files refer \
         to these.",
        "`pinswitch init effects` writes a valid file to start from.",
    }

    EFFECT_WITHOUT_ZERO: "effect-without-zero", "The effect is not zero at zero size", in "model/doc/own-effects.md" {
        "A hypothesis without the effect is the one in which all its sizes are zero. If the \
         formula keeps a remainder there, both hypotheses would contain the effect. If it is \
         zero in every row at its start values, neither does.",
        "Mark every constant that cancels the effect as a size, or subtract the remainder.",
    }

    EFFECT_NOT_LINEAR: "effect-not-linear", "The effect is not linear in its size near zero", in "model/doc/own-effects.md" {
        "A fit starts with a small size, and an interval around zero needs both signs. `k^2`, \
         `abs(k)` and `sqrt(k)` have no slope at zero, or only one sign.",
        "Write `k*f`, or `exp(k*f) - 1`.",
    }

    EFFECT_IN_STEPS: "effect-in-steps", "The effect changes in steps with a constant", in "model/doc/own-effects.md" {
        "A fit follows slopes. If a constant only moves the place of a step, small changes of it \
         change nothing, and large ones jump.",
        "Replace the comparison by a narrow slope, such as `0.5*(1 + tanh((time - c)/0.004))`.",
    }

    CONSTANTS_NOT_IDENTIFIABLE: "constants-not-identifiable", "No data can separate the constants", in "model/doc/own-effects.md" {
        "A change of one constant is compensated by others: in `(a + b)*stroke` only the sum \
         matters. The fit would have no unique solution, whatever the table.",
        "Leave out one of the named constants.",
    }
}
