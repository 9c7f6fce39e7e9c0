//! Rules, warnings and checks for printing, casting and purchased parts.

pages! {
    "Printing and process";

    CHAMFER_TOO_SMALL: "chamfer-too-small", "The chamfer is too small to print", in "cad/doc/print-limits.md" {
        "A chamfer under 0.02 mm does not print, and would make facets that are too thin. 0 \
         leaves it out.",
        "Most slicers compensate the squeezed first layer themselves, by 0.2 mm in most \
         profiles. Use either this chamfer or their compensation, never both.",
    }

    LABEL_STROKE_TOO_THIN: "label-stroke-too-thin", "The strokes of the label are under one printed line", in "cad/doc/print-limits.md" {
        "The label is engraved with strokes of `label.stroke_mm`. A groove that is narrower than \
         a printed line may vanish when the part is sliced.",
        "Raise the stroke, or set `label.engrave` to false.",
    }

    GROOVES_UNDER_FOUR_LAYERS: "grooves-under-four-layers", "The grooves are narrower than four layers", in "cad/doc/print-limits.md" {
        "Stratasys' guide for ABS gives four layers as the smallest feature in the plane. A \
         groove of 1 mm passes with layers of 0.178 and 0.2 mm, not with 0.254 mm.",
        "Use thinner layers, or wider grooves.",
    }

    LINE_UNDER_NOZZLE: "line-under-nozzle", "The printed line is narrower than the nozzle", in "cad/doc/print-limits.md" {
        "The default of PrusaSlicer's ABS profiles is a line of 0.45 mm from a nozzle of 0.4 mm. \
         A narrower line than the nozzle is usually a value for another nozzle; the check does \
         not prevent the parts from being made.",
        "Raise `print.line_mm` to the nozzle or more.",
    }

    LAYER_TOO_THICK: "layer-too-thick", "The layers are too thick for the nozzle", in "cad/doc/print-limits.md" {
        "Layers of at most four fifths of the nozzle are a rule of thumb, not tested here.",
        "Lower `print.layer_mm`.",
    }

    SLOTS_CLOSE_WHEN_SLICED: "slots-close-when-sliced", "The slicer may close the slots", in "cad/doc/print-limits.md" {
        "Measured with PrusaSlicer: slots that are 0.05 and 0.08 mm wider than the pin are \
         closed, and 0.10 mm stays open. The slicer closes gaps of twice its closing radius of \
         0.049 mm.",
        "Raise `support.slot_clearance_mm` to at least 0.10.",
    }

    SLOT_FLOOR_TOO_THIN: "slot-floor-too-thin", "The floor of the slots has too few layers", in "cad/doc/print-limits.md" {
        "At least three layers are a rule of thumb, not tested here; the default floor is 0.9 \
         mm.",
        "Raise `support.slot_floor_mm`, or print with thinner layers.",
    }

    BRIDGE_TOO_LONG: "bridge-too-long", "A ceiling is too long to be bridged", in "cad/doc/print-limits.md" {
        "Ceilings of up to 10 mm print without support and without sagging (practice; some \
         guides give 30 mm).",
        "The guide names the exception: the skin over a pocket for an axle, which the axle \
         breaks.",
    }

    THIN_RIM_OF_HOLES: "thin-rim-of-holes", "The wall around the screw holes is under 1 mm", in "cad/doc/print-limits.md" {
        "0.5 mm is the minimum between a hole and an edge, and 1 mm is ideal (guide for ABS \
         parts). Recesses for nuts and heads, and holes for inserts, count.",
        "Raise `shell.wall_mm`, or use smaller screws.",
    }

    CURE_TOO_COLD: "cure-too-cold", "The temperature of the cure is below that of a room", in "cad/doc/process.md" {
        "Silicone cures at room temperature or above; under 18 degrees Celsius the value is \
         taken for a mistake.",
        "0 lets the program choose the temperature at which the silicone shrinks by \
         `mould.shrinkage_pct`.",
    }

    CURE_AGAINST_SHRINKAGE: "cure-against-shrinkage", "Cure, shrinkage and mould do not agree", in "cad/doc/process.md" {
        "Silicone shrinks by `(a_silicone - a_mould) (T - 25 C)`: it sets at the temperature of \
         its cure, and contracts more than the mould when both cool. The mould is enlarged by \
         `mould.shrinkage_pct`, so the two must agree within 0.3 % (chosen), and oven and mould \
         must reach and survive the temperature.",
        "A stated `process.cure_c` that contradicts is an error. If the temperature follows from \
         the shrinkage and cannot be reached, it is a warning, and the guide then has no \
         temperature.",
    }

    COATING_CONTRADICTION: "coating-contradiction", "The tendon is bare but has a coating", in "cad/doc/process.md" {
        "`process.coating` states what is bought, and `tendon.coating_mm` its thickness on the \
         rope.",
        "A bare rope has a thickness of 0. Friction was published for polyamide 12 only: for \
         other surfaces the prediction is extrapolated.",
    }

    HARDNESS_NOT_REACHED: "hardness-not-reached", "No cure gives the hardness of the silicone", in "cad/doc/process.md" {
        "Sylgard 184 has 44 Shore A after a cure at 25 degrees Celsius, and 54 after 200 \
         (Johnston et al. 2014). Other products have the hardness of their data sheet. The \
         predicted curve uses the configured hardness, so it does not describe a softer layer.",
        "Allow a hotter oven with `process.oven_c`, choose another product, or configure the \
         hardness that you can make.",
    }

    MIX_RATIO_WITHOUT_EFFECT: "mix-ratio-without-effect", "The mix ratio does not apply to this silicone", in "cad/doc/process.md" {
        "A named product is mixed as its package states, and the program uses that ratio.",
        "`silicone.mix_ratio` is for Sylgard 184 and for `process.silicone = \"other\"`.",
    }

    CURE_INHIBITED: "cure-inhibited", "Silicone does not cure on this mould", in "cad/doc/process.md" {
        "Resin prints contain substances that inhibit addition-cured silicones: the surface \
         stays tacky.",
        "Wash the mould, cure it under UV and bake it for 2 h at 50 degrees Celsius before you \
         cast, and test a small amount first.",
    }

    PIN_NOT_SOLD: "pin-not-sold", "Pins of this diameter are not sold", in "cad/doc/process.md" {
        "Music wire comes in the sizes that hobby suppliers keep, and dowels in those of ISO \
         8734. Tin-plated pins, as in the paper, are accepted in any diameter.",
        "The remedy names the nearest diameter on sale that fits the grooves. The predicted \
         curve changes with the diameter.",
    }

    PART_EXCEEDS_BED: "part-exceeds-bed", "A part does not fit the bed of the printer", in "cad/doc/meshes.md" {
        "Each part must fit with 3 mm free along the edges of the bed, `print.bed_mm`, in the \
         orientation in which it is printed.",
        "Parts that are not needed can be left out: the coupon, or the mount.",
    }
}
