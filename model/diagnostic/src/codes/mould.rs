//! Rules of the design for the ends of the sectors, the mould and the range of loads.

pages! {
    "Mould and sector ends";

    ENDS_BEYOND_SECTOR: "ends-beyond-sector", "The ends of a sector are too far beyond its span", in "cad/doc/dimensions.md" {
        "The ends of shell, supports and mould are planes that are shifted outwards from the \
         radial planes, by margin, stops and walls. At the inner radius such a plane must still \
         meet the circle: the shift may be at most 0.9 of the inner radius.",
        "The message names the sector. The ends of a mould are further out than those of the \
         shell, by the wall of the mould.",
    }

    ENDS_MEET: "ends-meet", "The ends of a sector meet behind the axis", in "cad/doc/dimensions.md" {
        "A sector of a large span nearly closes to a ring. At least 0.5 mm must remain open \
         behind the axis, between its two ends.",
        "A smaller span, a larger shell or thinner ends open the gap.",
    }

    MOULD_INNER_RADIUS: "mould-inner-radius", "The inner radius of the mould is too small", in "cad/doc/dimensions.md" {
        "The one-piece mould ends inside the outer radius of the shell, by its walls around the \
         layer, and its inner radius must be at least 1 mm.",
        "A thinner wall of the mould, or a larger shell, leaves more radius. With `mould.kind = \
         \"none\"` no mould is made.",
    }

    DRAFT_WITHOUT_BASIN: "draft-without-basin", "The draft of the mould changes nothing", in "cad/doc/print-limits.md" {
        "Only the walls of the basin of the tray may be inclined: all other walls form the \
         silicone layer. Without an overfill there is no basin.",
        "A draft on the walls of the layer would make it thicker at one edge than at the other: \
         3 degrees over 13.6 mm are 0.71 mm.",
    }

    MOULD_KEYS_CROWDED: "mould-keys-crowded", "The keys of the mould have too thin walls around them", in "cad/doc/dimensions.md" {
        "Keys align the parts of the split mould. One thinnest wall must remain between the \
         holes for two keys, and beyond the outermost ones at the ends of the ring.",
        "Thinner keys or a longer span make room; the one-piece mould has no keys.",
    }

    MOULD_KEY_TOO_HIGH: "mould-key-too-high", "The keys of the mould are too high", in "cad/doc/dimensions.md" {
        "The ring of the split mould must be as high as a key, 0.4 mm of play and 1 mm of wall \
         above the hole. Keys are tapered, and a key that is too high for its diameter would \
         have no head of 0.2 mm left.",
        "The height of the ring follows from the width of the silicone layer.",
    }

    EMPTY_LOAD_RANGE: "empty-load-range", "The range of loads is empty" {
        "The curve is predicted at loads from `friction.load_min_n` to `friction.load_max_n`, in \
         newtons.",
        "The first must be below the second. If only one of them was set, the default of the \
         other may be on the wrong side.",
    }
}
