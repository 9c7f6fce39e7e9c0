//! Rules of the design for the grooved sector, its pins, the silicone and the tendon.

pages! {
    "Shell, pins and tendon";

    SHELL_INNER_RADIUS: "shell-inner-radius", "The inner radius of the shell is too small", in "cad/doc/dimensions.md" {
        "The wall may be at most the outer radius less 1 mm: `wall <= R - 1`. The remaining \
         radius leaves room for the core of a mould.",
        "Either a thinner wall or a larger shell satisfies the rule.",
    }

    WALL_UNDER_GROOVES: "wall-under-grooves", "The wall under the grooves is too thin", in "cad/doc/dimensions.md" {
        "Under the bottom of a groove the wall must still have two thinnest walls: `wall >= g + \
         2 print.least_wall_mm`, where `g` is the radius of the grooves.",
        "`print.least_wall_mm` is one printed line by default, since thinner walls lose layers \
         or vanish when they are sliced.",
    }

    GROOVES_OVERLAP: "grooves-overlap", "Grooves overlap", in "cad/doc/print-limits.md" {
        "The material between two grooves, the land, is narrowest on the shell. With the outer \
         radius `R`, the pitch `p` (span divided by number of grooves) and the radius `g` of the \
         grooves, the distance of two grooves is `2 R sin(p/2)`, and must be at least `2 g` and \
         one thinnest wall (with chamfers: at least twice the chamfer and 0.05 mm).",
        "The land grows with the radius of the shell, and shrinks with the number of grooves. \
         With the published pitch and grooves of 0.5 mm radius, one line between grooves needs a \
         radius of 13.94 mm.",
    }

    END_WALL_TOO_THIN: "end-wall-too-thin", "The wall beyond the outermost groove is too thin", in "cad/doc/print-limits.md" {
        "The outermost groove ends half a land from the end of the sector, plus \
         `segment.end_margin_mm`: `R sin(p/2) + margin - g`. At least half of a thinnest wall is \
         required.",
        "A margin is the simplest way out. It is outside of the span, so the grooves stay where \
         they are.",
    }

    NARROW_LAND: "narrow-land", "The land between grooves is under two printed lines", in "cad/doc/print-limits.md" {
        "In a slicer without thin-wall detection, walls of 0.45 mm lose layers or vanish, and \
         walls of 0.60 mm are kept (measured); guides require at least 0.8 mm. A published \
         dimension under two lines is kept, so this is a warning and not an error.",
        "With the published pitch, two lines need a radius of 18.26 mm.",
    }

    NARROW_END_WALL: "narrow-end-wall", "The end walls are under two printed lines", in "cad/doc/print-limits.md" {
        "The end wall is half a land and the margin, and is therefore thinner than the lands \
         unless there is a margin. Stops at the ends of the shell thicken the end walls.",
        "The preset `printer-fff-0.4` sets a margin of 0.5 mm.",
    }

    PIN_OUTSIDE_GROOVES: "pin-outside-grooves", "A pin is in a groove that does not exist", in "cad/doc/dimensions.md" {
        "Grooves are numbered from 1 at one end to `segment.grooves` at the other. The published \
         segment has 15, with number 8 in the middle.",
        "Often a layout for one number of grooves is used with another: the same angle then has \
         another number.",
    }

    GROOVE_OCCUPIED_TWICE: "groove-occupied-twice", "Two pins are in one groove", in "cad/doc/dimensions.md" {
        "A groove takes one pin, so `layout.pins` lists each number once.",
        "Remove the repeated number, or write the one that was meant.",
    }

    PIN_WIDER_THAN_GROOVE: "pin-wider-than-groove", "The pins are wider than their grooves", in "cad/doc/print-limits.md" {
        "A pin must sink into its groove up to its largest size: `d <= 2 g - pins.tolerance_mm`. \
         A wider pin would rest on the edges of the groove.",
        "The tolerance is that of the purchased pins.",
    }

    SILICONE_TOO_THIN: "silicone-too-thin", "The silicone under the grooves is too thin", in "cad/doc/print-limits.md" {
        "The layer must continue by at least 0.5 mm below the grooves: `thickness >= g + 0.5`. \
         The value is practice.",
        "The thickness of the layer also determines at which load the tendon touches the \
         silicone, so the predicted curve changes with it.",
    }

    SILICONE_TOO_NARROW: "silicone-too-narrow", "The silicone layer is too narrow for the lips", in "cad/doc/dimensions.md" {
        "The lips of both supports reach over the edges of the layer. Its width must be at least \
         twice the depth of a lip and two thinnest walls.",
        "The width of the layer is `shell.width_mm` less the clearances at both sides.",
    }

    WRAP_EXCEEDS_SEGMENT: "wrap-exceeds-segment", "The tendon would wrap beyond the segment", in "cad/doc/dimensions.md" {
        "The wrap angle is the arc on which the tendon touches the switch. It cannot exceed the \
         grooved span, beyond which there is nothing to touch.",
        "Lower `layout.wrap_angle_deg`, or raise `segment.span_deg`.",
    }

    TENDON_ENDS_COLLIDE: "tendon-ends-collide", "The ends of the tendon meet each other or the guide pulley", in "cad/doc/dimensions.md" {
        "At large wrap angles the two ends of the tendon approach each other where they leave \
         the wrap. At least 1 mm must remain between them, and between them and the guide \
         pulley.",
        "A pulley that is further away, or a larger shell, moves the ends apart.",
    }

    TENDON_ENDS_MEET: "tendon-ends-meet", "The ends of the tendon meet beyond the wrap", in "cad/doc/dimensions.md" {
        "Both ends leave the wrap along tangents, and these cross within 100 mm of the wrap. The \
         parts can be made, but the ends of the tendon would touch.",
        "Guide the ends past each other on different heights, or lower the wrap angle.",
    }

    PINS_OUTSIDE_WRAP: "pins-outside-wrap", "Pins outside the wrap carry no load", in "cad/doc/dimensions.md" {
        "The wrap is centred on the segment, and a tendon over a wrap of A degrees touches pins \
         within A/2 of the middle only. Other pins have no effect on the curve.",
        "The remedy gives the wrap angle that reaches the outermost pin, if the segment is long \
         enough for it.",
    }

    TENDON_TOO_THICK: "tendon-too-thick", "The tendon is too thick for the channel", in "cad/doc/print-limits.md" {
        "The tendon runs between the lips of both supports with 0.5 mm of air on each side: \
         `tendon <= width - 2 lip_depth_mm - 1`. The thickness counts with the coating.",
        "No friction law describes a tendon that rubs on a lip.",
    }

    TENDON_BENT_TOO_SHARPLY: "tendon-bent-too-sharply", "The tendon is too thick for the bend radius", in "cad/doc/print-limits.md" {
        "Wire ropes that bend around less than ten times their own diameter fatigue early \
         (practice). The rule compares the coated tendon with the diameter of the surface on \
         which it lies.",
        "A larger shell or a thinner rope satisfies it. From a ratio of 20 on there is no \
         warning either.",
    }

    TENDON_TOO_SHORT: "tendon-too-short", "The tendon is too short for its way", in "cad/doc/dimensions.md" {
        "The tendon needs the length of the wrap, of the sheath stop if there is one, and 20 mm \
         at each end.",
        "On the rig, the bill of materials lists what the ways of the tendon need if that is \
         more. Only the tendon is affected, so this is a warning.",
    }

    TENDON_WEARS_EARLY: "tendon-wears-early", "The tendon bends sharply and will wear early", in "cad/doc/print-limits.md" {
        "The ratio of pulley to tendon diameter is under 20, the value from which on wire ropes \
         last (practice). Under 10 the configuration is refused.",
        "Raise `shell.outer_radius_mm`, or choose a thinner rope.",
    }
}
