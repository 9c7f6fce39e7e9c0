//! Rules of the design for what carries the switch.

pages! {
    "Mounting plate, joint and rig";

    SHEATH_WITHOUT_PLATE: "sheath-without-plate", "The sheath stop needs a mounting plate", in "cad/doc/dimensions.md" {
        "The stop for the sheath of the tendon is a block on the mounting plate, so it needs a \
         plate.",
        "Set `mount.kind` to a plate, or `tendon.sheath_diameter_mm` to 0 for a tendon without a \
         sheath.",
    }

    SHEATH_DOES_NOT_FIT: "sheath-does-not-fit", "The sheath does not fit around the tendon or over the plate", in "cad/doc/dimensions.md" {
        "A sheath needs 0.4 mm more than the tendon, on the diameter. It is centred on the \
         tendon, so a wide one comes close to the plate, above which 1 mm of the stop must \
         remain.",
        "A wider shell raises the tendon above the plate.",
    }

    PLATE_WITHOUT_SCREWS: "plate-without-screws", "Nothing fastens the mounting plate", in "cad/doc/dimensions.md" {
        "The plate is fastened by the screws that join shell and supports. With `fasteners.count \
         = 0` there are none.",
        "Give at least one screw, or leave the plate out with `mount.kind = \"none\"`.",
    }

    PLATE_HOLES_CROWDED: "plate-holes-crowded", "The holes of the mounting plate are too close", in "cad/doc/dimensions.md" {
        "Holes for screws, axles and the mount, and the foot of the sheath stop, are all in the \
         same plate, and 1 mm of wall must remain between any two.",
        "Larger distances of the mount, or smaller holes, separate them.",
    }

    PULLEY_NEAR_SWITCH: "pulley-near-switch", "The guide pulley is too close to the switch", in "cad/doc/rig.md" {
        "The turning pulley must clear the supports by 2 mm, and its rim grows with the tendon.",
        "Raise `mount.pulley_distance_mm`, the distance between the two axes.",
    }

    PULLEY_NEAR_PLATE: "pulley-near-plate", "The guide pulley is too close to the plate", in "cad/doc/rig.md" {
        "The pulley guides the tendon at the height of the switch, on a spacer between plate and \
         pulley of at least 1 mm.",
        "A wider shell or a thicker support raises the tendon, and a thinner rope makes the \
         pulley narrower.",
    }

    SHEATH_STOP_IN_THE_WAY: "sheath-stop-in-the-way", "The sheath stop is in the way of the tendon or the pulley", in "cad/doc/dimensions.md" {
        "The stop must keep 1 mm from the tendon on the side of the load, and 2 mm from the \
         guide pulley. At large wrap angles both ends of the tendon leave the switch on similar \
         ways.",
        "Lower the wrap angle, move the pulley away, or use no sheath.",
    }

    PLATE_TOO_THIN: "plate-too-thin", "The plate is too thin for the recessed heads", in "cad/doc/dimensions.md" {
        "The plate rests on a table, so the heads of all screws and of the axle are sunk into \
         its outer face. Above the deepest recess remain a skin of two layers (at least 0.4 mm), \
         which the printer bridges, and 1 mm of plate.",
        "If recesses do not fit next to each other, fewer or smaller screws are the way out.",
    }

    JOINT_WITH_SHEATH: "joint-with-sheath", "A joint has no place for a sheath stop", in "cad/doc/dimensions.md" {
        "The proximal link of a joint guides the tendon itself, so no sheath ends at the switch.",
        "Set `tendon.sheath_diameter_mm` to 0, or use a flange in place of the joint.",
    }

    AXLE_NOT_SOLD: "axle-not-sold", "No bolt on sale is an axle of this size", in "cad/doc/dimensions.md" {
        "Axles are bolts of 4, 5, 6 or 8 mm. A bolt of ISO 4014 must reach through both links \
         and the switch: M4 is sold to 40 mm, M5 to 50, M6 to 60 and M8 to 80.",
        "Another diameter, a narrower shell or thinner plates bring the length into the range.",
    }

    HUB_TOO_SMALL: "hub-too-small", "The hub has too little wall around the axle", in "cad/doc/dimensions.md" {
        "The hub of the joint is inside the shell, so its radius follows from the outer radius \
         and the wall of the shell. It needs 2 mm of wall around the axle, and must carry the \
         washer of the bolt.",
        "A thinner axle, or a larger shell, leaves more wall.",
    }

    STOPS_TOO_CLOSE: "stops-too-close", "The stops of the joint leave too little flexion", in "cad/doc/dimensions.md" {
        "Less than 5 degrees between `mount.flexion_min_deg` and `mount.flexion_max_deg` is not \
         accepted as a joint.",
        "Raise the larger angle, or lower the smaller one.",
    }

    WRAP_OUTSIDE_STOPS: "wrap-outside-stops", "The joint never reaches the wrap of the layout", in "cad/doc/dimensions.md" {
        "The parts are constructed, and the curve is predicted, at a flexion of the wrap angle \
         of the layout. This angle must therefore be between the stops.",
        "Move a stop, or choose another `layout.wrap_angle_deg`.",
    }

    FLEXION_LEAVES_SEGMENT: "flexion-leaves-segment", "At full flexion the tendon leaves the segment", in "cad/doc/dimensions.md" {
        "The wrap grows with the flexion, and at the largest flexion it must still end on \
         grooves.",
        "Lower `mount.flexion_max_deg`, or raise `segment.span_deg`. A larger wrap angle of the \
         layout can help as well.",
    }

    STOPS_DO_NOT_FIT: "stops-do-not-fit", "The stops do not fit next to the shell", in "cad/doc/dimensions.md" {
        "The stops are on the hub, in the arc that the sector of the shell leaves free. Between \
         them and the ends of shell and supports must be 1 mm of air, over the whole range of \
         flexion.",
        "A smaller range or a shorter sector makes room.",
    }

    LINK_TOO_SHORT: "link-too-short", "A link of the joint is too short", in "cad/doc/dimensions.md" {
        "The holes at the end of a link must be 1 mm outside the supports of the switch, and \
         beyond the guide of the tendon (proximal) or its anchor (distal).",
        "The message gives the least length.",
    }

    LOAD_CANNOT_HANG: "load-cannot-hang", "The load of the rig cannot hang free", in "cad/doc/rig.md" {
        "In the rig the tendon runs from the switch over a guide pulley to a hanging weight. \
         Above 150 degrees of wrap it leaves the switch in a direction from which no guide \
         pulley lets the load hang.",
        "A flange carries the switch in a rig of your own.",
    }

    CELL_TOO_WEAK: "cell-too-weak", "The load cell of the rig is too weak", in "cad/doc/rig.md" {
        "The cell must measure the heaviest weight of the paper with the hook, and in addition \
         the largest measured friction of 12.97 N.",
        "Choose a cell with a larger range, or a lighter hook.",
    }

    CELL_THREAD_TOO_WIDE: "cell-thread-too-wide", "A thread is too wide for the load cell", in "cad/doc/rig.md" {
        "Around a thread in the cell 1 mm of metal must remain, and 0.5 mm towards the end of a \
         bar. The values describe a purchased part, so a broken rule usually means a wrong \
         reading of its data sheet.",
        "Check the sizes of the cell, in mm.",
    }

    BAR_CELL_TOO_SHORT: "bar-cell-too-short", "The bar of the load cell is too short for its holes", in "cad/doc/rig.md" {
        "A bar cell has two holes at each end, and its measuring section of at least 10 mm \
         between the inner ones.",
        "Check length, inset and spacing of the holes against the data sheet.",
    }

    BAR_HOLES_TOO_CLOSE: "bar-holes-too-close", "The holes of the load cell are too close for their screws", in "cad/doc/rig.md" {
        "The mount has a slot for each screw, and 3 mm of wall must remain between two heads, \
         which are 1.5 diameters wide.",
        "Check the spacing of the holes and the thread of the cell.",
    }

    ACTUATOR_TOO_SHORT: "actuator-too-short", "The actuator is too short for its stroke", in "cad/doc/rig.md" {
        "A linear actuator cannot retract into itself: the distance between its holes is at \
         least the stroke and 45 mm for its ends and eyes.",
        "`rig.retracted_mm` is measured between the holes of the retracted actuator.",
    }
}
