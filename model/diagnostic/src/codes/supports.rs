//! Rules of the design for the side supports, their slots, screws, inserts and dowels.

pages! {
    "Supports and fasteners";

    PLATE_OUTSIDE_SLOTS: "plate-outside-slots", "The plate outside the slots is too thin", in "cad/doc/dimensions.md" {
        "A pin slides in a slot of each support. Between the outer end of the slots and the edge \
         of the plate one thinnest wall must remain: `rise + d/2 - slot width/2 >= least`.",
        "`support.rise_mm` is the height of the plates above the resting pins. It also keeps the \
         tendon from jumping out.",
    }

    SLOTS_TOO_CLOSE: "slots-too-close", "The wall between neighbouring slots is too thin", in "cad/doc/dimensions.md" {
        "Slots are radial, so they are closest at their inner end. All grooves count, even if \
         only occupied ones get a slot, so that a layout can be changed without a new limit.",
        "Slots become narrower with `support.slot_clearance_mm` and shorter with \
         `support.travel_margin_mm`.",
    }

    WALL_BEYOND_SLOTS: "wall-beyond-slots", "The wall beyond the outermost slot is too thin", in "cad/doc/dimensions.md" {
        "At the inner end of the outermost slot, half of a thinnest wall must remain to the end \
         of the support.",
        "`segment.end_margin_mm` moves the end outwards without moving the slots.",
    }

    CORNERS_TOO_ROUND: "corners-too-round", "The rounded corners of the plate are too large", in "cad/doc/dimensions.md" {
        "The outer corners of the plates are rounded because a sharp edge cuts the coating of \
         the tendon (practice). The curve must leave a wall around the outermost slots and \
         holes, and a part of the plate's ends.",
        "Lower `support.corner_radius_mm`, or move the ends outwards with \
         `segment.end_margin_mm`.",
    }

    SLOT_TOO_SHALLOW: "slot-too-shallow", "A blind slot is too shallow", in "cad/doc/dimensions.md" {
        "A blind slot ends at a floor of `support.slot_floor_mm`, which retains the pin. What \
         remains of the plate's thickness is the depth of the slot, and must be at least one \
         thinnest wall.",
        "Through slots have no floor, but do not retain the pins.",
    }

    PIN_REACHES_SHELL: "pin-reaches-shell", "A sunk pin reaches into the shell", in "cad/doc/dimensions.md" {
        "Under load a pin sinks into the silicone along its slot. At the inner end of the slot \
         it must not touch the shell: `thickness - d - travel_margin >= 0`.",
        "Thinner pins, a smaller `support.travel_margin_mm` or a thicker layer satisfy the rule.",
    }

    PIN_ENGAGES_TOO_LITTLE: "pin-engages-too-little", "The ends of the pins are supported too little", in "cad/doc/print-limits.md" {
        "Each end of a pin must be in its slot over at least one diameter (practice).",
        "The length of the pins is rounded down to half a millimetre. A thicker plate, a thinner \
         floor and less end play all help.",
    }

    SCREW_HOLES_TOO_LARGE: "screw-holes-too-large", "The screw holes are too large for the wall", in "cad/doc/print-limits.md" {
        "A hole lies in the wall of the shell, between the inner face on one side and grooves \
         and slots on the other. Around it 0.5 mm of wall are required, and 1 mm is recommended \
         (guide for ABS parts).",
        "A clearance hole of ISO 273 is 3.4 mm for M3 and 2.4 mm for M2.",
    }

    SCREW_HOLE_NEAR_END: "screw-hole-near-end", "The outermost screw hole is too close to the end", in "cad/doc/dimensions.md" {
        "The wall between the outermost hole and the end of the sector must be as thick as that \
         around every hole: 0.5 mm, or one thinnest wall if that is more.",
        "`fasteners.end_distance_mm` is measured from the end of the span; stops and margin of \
         the ends add to it.",
    }

    SCREW_HOLES_CROWDED: "screw-holes-crowded", "The screw holes do not fit next to each other", in "cad/doc/dimensions.md" {
        "The holes are spread over the arc between the two end distances. Two neighbours must be \
         one diameter and one wall apart, and a single hole must fit the span.",
        "Fewer holes, or a smaller end distance, give them more room.",
    }

    INSERT_DOES_NOT_FIT: "insert-does-not-fit", "The threaded inserts do not fit", in "cad/doc/print-limits.md" {
        "Inserts are known for M2 to M4, with sizes as commonly quoted for one maker (ruthex). \
         They need a wall around their hole, a hole that is 0.2 mm wider than that of the screw \
         (a shoulder), and 1 mm between the two inserts that enter the shell from both sides.",
        "Sizes of makers differ: check your package. Screws with nuts need no inserts.",
    }

    SCREW_NOT_SOLD: "screw-not-sold", "No screw on sale fits", in "cad/doc/print-limits.md" {
        "Screws of ISO 4762 are sold in a range of lengths for each thread: M1.6 to 16 mm, M2 \
         20, M2.5 25, M3 30, M4 40, M5 50. The screw must reach through both plates and the \
         shell, or be short enough for inserts.",
        "Sunk heads (`fasteners.head_recess_mm`), a narrower shell or another thread change the \
         length that is needed. A hole under 1.7 mm is too small for M1.6, the smallest thread \
         here.",
    }

    DOWEL_NOT_SOLD: "dowel-not-sold", "Dowels of this diameter are not sold", in "cad/doc/dimensions.md" {
        "Dowels align the supports with the shell. Their diameters are those of ISO 2338.",
        "0 leaves the dowels out; the screws alone then align the parts, with the play of their \
         holes.",
    }

    DOWEL_WALL_TOO_THIN: "dowel-wall-too-thin", "The wall around the dowels is too thin", in "cad/doc/dimensions.md" {
        "The dowels are next to the outermost screws, and need the same wall around them as the \
         screws.",
        "Thinner dowels, a thicker wall of the shell or fewer screws make room.",
    }

    LOOSE_PINS: "loose-pins", "Nothing retains the pins in through slots", in "cad/doc/dimensions.md" {
        "In a through slot a pin is free along its axis, and only friction keeps it in place.",
        "Cover the outside of the plates when you assemble the switch, or use blind slots.",
    }

    SLOTS_TOO_WIDE: "slots-too-wide", "The slots give the pins too much play", in "cad/doc/print-limits.md" {
        "Beyond 0.3 mm of clearance a pin can move by more than 0.4 degrees at a radius of 20 mm \
         (geometry), and the angles between pins determine the friction.",
        "Print the coupon, and set the smallest clearance in which the pin slides. Prusa's MK3S \
         handbook calls 0.20 mm loose.",
    }
}
