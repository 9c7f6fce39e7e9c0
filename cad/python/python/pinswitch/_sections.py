"""Tables of a configuration; written by tools/sections.py from the parameters of the library."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from . import _pinswitch
from ._read_only_list import read_only


class Section:
    """One table of a configuration."""

    _table = ""
    _keys: tuple[str, ...] = ()
    _native: _pinswitch.Configuration

    def __init__(self, native: _pinswitch.Configuration) -> None:
        object.__setattr__(self, "_native", native)

    # A type checker knows the parameters below, and no others.
    if not TYPE_CHECKING:

        def __getattr__(self, key: str) -> Any:
            if key.startswith("_"):
                raise AttributeError(key)
            if key not in self._keys:
                raise AttributeError(f"[{self._table}] has no {key!r}; its parameters are {', '.join(self._keys)}")
            return read_only(self._native.get(f"{self._table}.{key}"))

        def __setattr__(self, key: str, value: object) -> None:
            self._native.set(f"{self._table}.{key}", value)

    def __dir__(self) -> list[str]:
        return list(self._keys)

    def __repr__(self) -> str:
        values = ", ".join(f"{key}={self._native.get(f'{self._table}.{key}')!r}" for key in self._keys)
        return f"{type(self).__name__}({values})"


class Switch(Section):
    """Table ``[switch]``.

    Attributes
    ----------
    name : str
        Names the output folder and the plots. Range: a name of 1 to 80 letters, digits, spaces and -_.+, not a
        path, without a dot or space at an end; default switch (chosen).
    """

    _table = "switch"
    _keys = (
        "name",
    )
    name: str


class Layout(Section):
    """Table ``[layout]``.

    Attributes
    ----------
    pins : list[int]
        Occupied grooves, numbered from 1 along increasing angle; [] leaves the substrate bare. Range: a list of
        groove numbers; default [] (published).
    substrate : str
        Silicone for the switch; abs for the rigid proxy, on which the pins alone carry the tendon. Range:
        "silicone" or "abs"; default silicone (published).
    wrap_angle_deg : float
        Wrap angle of the tendon; 63.89 in every experiment. Range: 1 to 340 deg; default 63.89 (published).
    """

    _table = "layout"
    _keys = (
        "pins", "substrate", "wrap_angle_deg",
    )
    pins: list[int]
    substrate: str
    wrap_angle_deg: float


class Segment(Section):
    """Table ``[segment]``.

    Attributes
    ----------
    span_deg : float
        Angle of the grooved sector. Range: 5 to 340 deg; default 89.45 (published).
    grooves : int
        Number of grooves, evenly spaced over the span. Range: 1 to 60; default 15 (published).
    groove_radius_mm : float
        Radius of the half-round grooves on shell and silicone. Range: 0.1 to 3 mm; default 0.5 (published).
    end_margin_mm : float
        Material beyond the span at both ends; the published span leaves end walls of 0.54 mm, 0.9 prints
        better. Range: 0 to 10 mm; default 0.0 (chosen).
    """

    _table = "segment"
    _keys = (
        "span_deg", "grooves", "groove_radius_mm", "end_margin_mm",
    )
    span_deg: float
    grooves: int
    groove_radius_mm: float
    end_margin_mm: float


class Shell(Section):
    """Table ``[shell]``.

    Attributes
    ----------
    outer_radius_mm : float
        Radius of the face under the silicone; places the contact at 22 mm, the only radius in the paper. Range:
        5 to 150 mm; default 20.0 (assumed).
    wall_mm : float
        Radial thickness; 8.5 has room under the grooves for M3 nut traps and inserts with 1 mm of wall around
        them. Range: 1 to 60 mm; default 8.5 (assumed).
    width_mm : float
        Width along the axis. Range: 2 to 100 mm; default 14.0 (assumed).
    stop_mm : float
        Thickness of the stops beyond both ends of the layer, which keep it from sliding; 0 omits them. Range: 0
        to 5 mm; default 1.0 (chosen).
    stop_height_mm : float
        Height of the stops above the shell's face, at most 0.2 below the silicone's surface. Range: 0.2 to 5
        mm; default 0.8 (chosen).
    """

    _table = "shell"
    _keys = (
        "outer_radius_mm", "wall_mm", "width_mm", "stop_mm", "stop_height_mm",
    )
    outer_radius_mm: float
    wall_mm: float
    width_mm: float
    stop_mm: float
    stop_height_mm: float


class Fasteners(Section):
    """Table ``[fasteners]``.

    Attributes
    ----------
    kind : str
        Nuts in traps need no second wrench; inserts need a soldering iron. Range: "screw" or "nut-trap" or
        "insert"; default nut-trap (chosen).
    count : int
        Number of through holes; 0 omits them. Range: 0 to 12; default 2 (chosen).
    hole_diameter_mm : float
        Clearance hole: 3.4 for M3, 2.4 for M2. Range: 1 to 12 mm; default 3.4 (chosen).
    end_distance_mm : float
        Distance along the arc from the ends of the sector to the centres of the outermost holes. Range: 1 to 40
        mm; default 3.0 (chosen).
    nut_recess_mm : float
        Depth of the nut traps, omitted where they do not fit; half the default plate, the other half carries
        the load. Range: 0 to 10 mm; default 1.5 (chosen).
    head_recess_mm : float
        Depth of counterbores for the screw heads, omitted where they do not fit; 0 for protruding heads. Range:
        0 to 10 mm; default 0.0 (chosen).
    dowel_diameter_mm : float
        Steel dowels next to the outermost screws that register shell and supports; 0 omits them. Range: 0 to 6
        mm; default 0.0 (chosen).
    """

    _table = "fasteners"
    _keys = (
        "kind", "count", "hole_diameter_mm", "end_distance_mm", "nut_recess_mm", "head_recess_mm",
        "dowel_diameter_mm",
    )
    kind: str
    count: int
    hole_diameter_mm: float
    end_distance_mm: float
    nut_recess_mm: float
    head_recess_mm: float
    dowel_diameter_mm: float


class Silicone(Section):
    """Table ``[silicone]``.

    Attributes
    ----------
    thickness_mm : float
        Thickness of the layer. Range: 0.3 to 10 mm; default 2.0 (published).
    side_clearance_mm : float
        Gap to each side support; the layer must bulge without rubbing. Range: 0 to 1 mm; default 0.2 (chosen).
    hardness_shore_a : float
        Sylgard 184 after a hot cure; affects friction through the stiffness from Gent's formula. Range: 10 to
        80 Shore A; default 50.0 (published).
    density_g_cm3 : float
        Cured Sylgard 184. Range: 0.8 to 1.5 g/cm3; default 1.03 (assumed).
    mix_ratio : float
        Base to curing agent by mass. Range: 1 to 20; default 10.0 (published).
    waste_factor : float
        Allowance for silicone left in cup and syringe. Range: 1 to 3; default 1.3 (chosen).
    least_mix_g : float
        Below it, a scale with 0.1 g resolution cannot weigh 10:1. Range: 0 to 100 g; default 11.0 (chosen).
    """

    _table = "silicone"
    _keys = (
        "thickness_mm", "side_clearance_mm", "hardness_shore_a", "density_g_cm3", "mix_ratio",
        "waste_factor", "least_mix_g",
    )
    thickness_mm: float
    side_clearance_mm: float
    hardness_shore_a: float
    density_g_cm3: float
    mix_ratio: float
    waste_factor: float
    least_mix_g: float


class Pins(Section):
    """Table ``[pins]``.

    Attributes
    ----------
    diameter_mm : float
        Polished tin-plated steel. Range: 0.1 to 5 mm; default 0.94 (published).
    tolerance_mm : float
        Tolerance of the diameter. Range: 0 to 0.2 mm; default 0.01 (published).
    end_play_mm : float
        Axial play between the two slot floors. Range: 0 to 2 mm; default 0.2 (chosen).
    spares : int
        Spare pins to cut. Range: 0 to 20; default 1 (chosen).
    """

    _table = "pins"
    _keys = (
        "diameter_mm", "tolerance_mm", "end_play_mm", "spares",
    )
    diameter_mm: float
    tolerance_mm: float
    end_play_mm: float
    spares: int


class Tendon(Section):
    """Table ``[tendon]``.

    Attributes
    ----------
    rope_diameter_mm : float
        The paper's 1.2 mm "radius" read as diameter: 2.4 mm rope would carry four times the published 850 N.
        Range: 0.1 to 6 mm; default 1.2 (published).
    coating_mm : float
        Polyamide-12 coating, on the radius. Range: 0 to 2 mm; default 0.25 (published).
    length_mm : float
        Length to cut, for the bill of materials. Range: 10 to 10000 mm; default 300.0 (chosen).
    entry_fillet_mm : float
        Fillet of the stops where the tendon enters and leaves, at most 0.45 of their thickness; a sharp edge
        would cut the coating. Range: 0 to 3 mm; default 0.45 (chosen).
    sheath_diameter_mm : float
        Outer diameter of a sheath that ends in a stop on the mounting plate, on the side away from the load; 0
        for no sheath. Range: 0 to 10 mm; default 0.0 (chosen).
    """

    _table = "tendon"
    _keys = (
        "rope_diameter_mm", "coating_mm", "length_mm", "entry_fillet_mm", "sheath_diameter_mm",
    )
    rope_diameter_mm: float
    coating_mm: float
    length_mm: float
    entry_fillet_mm: float
    sheath_diameter_mm: float


class Support(Section):
    """Table ``[support]``.

    Attributes
    ----------
    plate_mm : float
        Thickness of the plates. Range: 0.8 to 20 mm; default 3.0 (chosen).
    slots : str
        All lets pins be moved; occupied prevents wrong layouts. Range: "all" or "occupied"; default all
        (chosen).
    slot_kind : str
        Blind slots retain the pins axially; through slots let them be changed from outside. Range: "blind" or
        "through"; default blind (chosen).
    slot_clearance_mm : float
        Slot width beyond the pin; under 0.1 slicers close the slot, over 0.4 the pin has too much play. Range:
        0.1 to 0.4 mm; default 0.2 (chosen).
    slot_floor_mm : float
        Thickness of the plate under a blind slot. Range: 0.2 to 5 mm; default 0.9 (chosen).
    travel_margin_mm : float
        Travel beyond the pin's flush position. Range: 0 to 2 mm; default 0.2 (chosen).
    rise_mm : float
        Height of the plate above the resting pins; 1.5 tendon diameters retain the tendon. Range: 0.5 to 20 mm;
        default 2.55 (chosen).
    corner_radius_mm : float
        Radius of the outer corners; sharp ones would cut the coating. Range: 0 to 5 mm; default 1.5 (chosen).
    lip_depth_mm : float
        Depth of the lip over the edge of the silicone; 0 omits it. Range: 0 to 5 mm; default 0.8 (chosen).
    lip_height_mm : float
        Radial thickness of the lip: two printed lines. Range: 0.4 to 5 mm; default 0.9 (chosen).
    lip_clearance_mm : float
        Gap between lip and resting silicone. Range: 0 to 2 mm; default 0.2 (chosen).
    """

    _table = "support"
    _keys = (
        "plate_mm", "slots", "slot_kind", "slot_clearance_mm", "slot_floor_mm", "travel_margin_mm",
        "rise_mm", "corner_radius_mm", "lip_depth_mm", "lip_height_mm", "lip_clearance_mm",
    )
    plate_mm: float
    slots: str
    slot_kind: str
    slot_clearance_mm: float
    slot_floor_mm: float
    travel_margin_mm: float
    rise_mm: float
    corner_radius_mm: float
    lip_depth_mm: float
    lip_height_mm: float
    lip_clearance_mm: float


class Mould(Section):
    """Table ``[mould]``.

    Attributes
    ----------
    kind : str
        Split comes apart for release; one-piece is a tray. Range: "split" or "one-piece" or "none"; default
        split (chosen).
    wall_mm : float
        Least wall around the cavity. Range: 1.2 to 20 mm; default 3.0 (chosen).
    floor_mm : float
        Floor, base plate and lid. Range: 0.8 to 20 mm; default 3.0 (chosen).
    overfill_mm : float
        One-piece: height of the basin above the layer; cut the layer along its ledge. Range: 0 to 10 mm;
        default 1.0 (chosen).
    draft_deg : float
        One-piece: draft of the basin's walls, whose silicone is cut off; the walls that shape the layer are
        vertical. Range: 0 to 5 deg; default 0.0 (chosen).
    shrinkage_pct : float
        Linear shrinkage of the silicone that the cavity compensates, and with it the temperature of the cure: 0
        for 25 C, 0.9 for 60 C in ABS. Range: 0 to 3 %; default 0.0 (chosen).
    clearance_mm : float
        Print clearance between parts of the split mould, per side. Range: 0.05 to 0.5 mm; default 0.2 (chosen).
    key_diameter_mm : float
        Diameter at the foot of the keys that register the parts. Range: 1.5 to 10 mm; default 3.0 (chosen).
    key_height_mm : float
        Height of the keys. Range: 0.5 to 10 mm; default 2.5 (chosen).
    pour_width_mm : float
        Width of the lid's pouring funnel at its mouth. Range: 1 to 20 mm; default 6.0 (chosen).
    vent_diameter_mm : float
        Diameter of the vents at both ends of the lid, at most the width of the cavity. Range: 0.5 to 4 mm;
        default 1.5 (chosen).
    """

    _table = "mould"
    _keys = (
        "kind", "wall_mm", "floor_mm", "overfill_mm", "draft_deg", "shrinkage_pct", "clearance_mm",
        "key_diameter_mm", "key_height_mm", "pour_width_mm", "vent_diameter_mm",
    )
    kind: str
    wall_mm: float
    floor_mm: float
    overfill_mm: float
    draft_deg: float
    shrinkage_pct: float
    clearance_mm: float
    key_diameter_mm: float
    key_height_mm: float
    pour_width_mm: float
    vent_diameter_mm: float


class Mount(Section):
    """Table ``[mount]``.

    Attributes
    ----------
    kind : str
        Flange, joint or rig; with none, the two screws fasten the switch to a user-defined support. Range:
        "none" or "flange" or "joint" or "rig"; default none (chosen).
    plate_mm : float
        Thickness of the plate; 7 has room for the heads of M5 screws and of the rig's M8 bolts. Range: 2 to 20
        mm; default 7.0 (chosen).
    hole_diameter_mm : float
        Mounting holes of the plate, and at the ends of the links of a joint: 4.5 for M4 (ISO 273). Range: 2 to
        12 mm; default 4.5 (chosen).
    rim_mm : float
        Wall around every hole of the plate. Range: 1 to 20 mm; default 3.0 (chosen).
    axle_mm : float
        Joint: diameter of the bolt on the pulley's axis: 4, 5, 6 or 8 (M4 to M8, ISO 4014). Range: 4 to 8 mm;
        default 5.0 (chosen).
    proximal_mm : float
        Joint: from the axis to the holes at the end of the proximal link, which carries the switch. Range: 10
        to 300 mm; default 60.0 (chosen).
    distal_mm : float
        Joint: from the axis to the holes at the end of the distal link, which carries the load. Range: 10 to
        300 mm; default 50.0 (chosen).
    flexion_min_deg : float
        Joint: flexion at the first stop; at 0 the links are in line. Range: 0 to 150 deg; default 0.0 (chosen).
    flexion_max_deg : float
        Joint: flexion at the second stop; the published segment ends at 76.7. Range: 5 to 170 deg; default 75.0
        (chosen).
    pulley_distance_mm : float
        Rig: straight tendon between the switch and each guide pulley. Range: 20 to 500 mm; default 70.0
        (chosen).
    """

    _table = "mount"
    _keys = (
        "kind", "plate_mm", "hole_diameter_mm", "rim_mm", "axle_mm", "proximal_mm", "distal_mm",
        "flexion_min_deg", "flexion_max_deg", "pulley_distance_mm",
    )
    kind: str
    plate_mm: float
    hole_diameter_mm: float
    rim_mm: float
    axle_mm: float
    proximal_mm: float
    distal_mm: float
    flexion_min_deg: float
    flexion_max_deg: float
    pulley_distance_mm: float


class Rig(Section):
    """Table ``[rig]``.

    Attributes
    ----------
    tendon_height_mm : float
        Height of the tendon above the table between guide pulley and drive; the axis of the drive. Range: 45 to
        120 mm; default 60.0 (chosen).
    weight_diameter_mm : float
        Largest diameter of the weights; the table's edge clears them by 10 mm. Range: 10 to 300 mm; default
        120.0 (chosen).
    hook_mass_g : float
        Hook between tendon and weights; it is part of every load. Range: 0 to 1000 g; default 62.53
        (published).
    cell : str
        S-beam is in line with the tendon; bar is cheaper and needs a longer bracket. Range: "s-beam" or "bar";
        default s-beam (chosen).
    cell_limit_n : float
        Range of the load cell: 10 kg, the smallest common one above the paper's largest reading of 62.6 N.
        Range: 1 to 1000 N; default 98.0 (chosen).
    s_beam_thread_mm : float
        S-beam: metric thread at both ends; M6 and M8 are common. Range: 4 to 12 mm; default 8.0 (assumed).
    s_beam_length_mm : float
        S-beam: length between the faces with the threads; measure it. Range: 20 to 120 mm; default 63.5
        (assumed).
    s_beam_width_mm : float
        S-beam: width across the tendon; measure it. Range: 12 to 80 mm; default 50.8 (assumed).
    s_beam_thickness_mm : float
        S-beam: thickness; measure it. Range: 5 to 26 mm; default 12.7 (assumed).
    bar_length_mm : float
        Bar: length (TAL220 and YZC-133: 80). Range: 50 to 150 mm; default 80.0 (chosen).
    bar_side_mm : float
        Bar: side of the square section (TAL220: 12.7). Range: 6 to 26 mm; default 12.7 (chosen).
    bar_hole_inset_mm : float
        Bar: from each end to the outer hole (TAL220: 5). Range: 3 to 15 mm; default 5.0 (chosen).
    bar_hole_spacing_mm : float
        Bar: between the two holes of an end (TAL220: 15). Range: 8 to 25 mm; default 15.0 (chosen).
    bar_screw_mm : float
        Bar: metric thread at the fixed end (TAL220: M5). Range: 3 to 6 mm; default 5.0 (chosen).
    bar_load_thread_mm : float
        Bar: metric thread at the load end, for the eye bolt (TAL220: M4). Range: 3 to 6 mm; default 4.0
        (chosen).
    sample_rate_hz : float
        Rate of the logger; 80 is the fast setting of the HX711 amplifier. Range: 1 to 100000 Hz; default 80.0
        (chosen).
    drive : str
        Actuator moves at a known speed; crank needs no supply. Range: "actuator" or "crank"; default actuator
        (chosen).
    stroke_mm : float
        Stroke of the drive. Range: 10 to 400 mm; default 152.4 (published).
    full_speed_mm_s : float
        Speed of the actuator at 100 %, 2 in/s; measure it with the heaviest load. Range: 0.1 to 1000 mm/s;
        default 50.8 (chosen).
    retracted_mm : float
        Actuator: distance of its two holes when retracted; PA-14: the stroke and 5.51 in. Range: 60 to 900 mm;
        default 292.4 (chosen).
    clevis_pin_mm : float
        Actuator: metric bolt through its two holes; M6 passes the holes of 6.35 of a PA-14. Range: 4 to 10 mm;
        default 6.0 (chosen).
    clevis_mm : float
        Actuator: thickness of its eyes along the bolt; measure it. Range: 4 to 20 mm; default 10.0 (assumed).
    body_mm : float
        Actuator: diameter of its body (PA-14: 1.5 in). Range: 15 to 64 mm; default 38.1 (chosen).
    """

    _table = "rig"
    _keys = (
        "tendon_height_mm", "weight_diameter_mm", "hook_mass_g", "cell", "cell_limit_n",
        "s_beam_thread_mm", "s_beam_length_mm", "s_beam_width_mm", "s_beam_thickness_mm",
        "bar_length_mm", "bar_side_mm", "bar_hole_inset_mm", "bar_hole_spacing_mm", "bar_screw_mm",
        "bar_load_thread_mm", "sample_rate_hz", "drive", "stroke_mm", "full_speed_mm_s", "retracted_mm",
        "clevis_pin_mm", "clevis_mm", "body_mm",
    )
    tendon_height_mm: float
    weight_diameter_mm: float
    hook_mass_g: float
    cell: str
    cell_limit_n: float
    s_beam_thread_mm: float
    s_beam_length_mm: float
    s_beam_width_mm: float
    s_beam_thickness_mm: float
    bar_length_mm: float
    bar_side_mm: float
    bar_hole_inset_mm: float
    bar_hole_spacing_mm: float
    bar_screw_mm: float
    bar_load_thread_mm: float
    sample_rate_hz: float
    drive: str
    stroke_mm: float
    full_speed_mm_s: float
    retracted_mm: float
    clevis_pin_mm: float
    clevis_mm: float
    body_mm: float


class Parts(Section):
    """Table ``[parts]``.

    Attributes
    ----------
    proxy : bool
        The rigid proxy of the silicone layer. Range: true or false; default True (published).
    coupon : bool
        Fit coupon: slots of 0.10 to 0.40 mm clearance and three grooves. Range: true or false; default True
        (chosen).
    guide_pulley : bool
        The rig's guide pulley, radius 22 mm, for a 608 bearing. Range: true or false; default False
        (published).
    """

    _table = "parts"
    _keys = (
        "proxy", "coupon", "guide_pulley",
    )
    proxy: bool
    coupon: bool
    guide_pulley: bool


class Label(Section):
    """Table ``[label]``.

    Attributes
    ----------
    engrave : bool
        Identifies printed variants; omitted with a warning where it does not fit. Range: true or false; default
        True (chosen).
    text : str
        Empty: pins x step / first groove, such as 3x3/5. Range: a text of at most 12 ASCII characters; default
        (chosen).
    height_mm : float
        Height of the letters. Range: 1.5 to 10 mm; default 3.2 (chosen).
    stroke_mm : float
        Stroke width, at least one printed line. Range: 0.3 to 2 mm; default 0.45 (chosen).
    depth_mm : float
        Two layers. Range: 0.1 to 2 mm; default 0.4 (chosen).
    """

    _table = "label"
    _keys = (
        "engrave", "text", "height_mm", "stroke_mm", "depth_mm",
    )
    engrave: bool
    text: str
    height_mm: float
    stroke_mm: float
    depth_mm: float


class Print(Section):
    """Table ``[print]``.

    Attributes
    ----------
    nozzle_mm : float
        Nozzle. Range: 0.1 to 1.2 mm; default 0.4 (chosen).
    line_mm : float
        Extrusion width. Range: 0.1 to 1.5 mm; default 0.45 (chosen).
    layer_mm : float
        Layer height. Range: 0.05 to 0.6 mm; default 0.2 (chosen).
    least_wall_mm : float
        Thinnest wall or land that is accepted: one printed line; under two lines it warns. Range: 0.1 to 3 mm;
        default 0.45 (chosen).
    elephant_foot_mm : float
        45 degree chamfer on bottom edges; slicers compensate 0.2 by default: use one of the two. Range: 0 to 1
        mm; default 0.0 (chosen).
    bed_mm : float
        Side of the print bed. Range: 50 to 2000 mm; default 250.0 (chosen).
    abs_density_g_cm3 : float
        For the mass of the printed parts. Range: 0.5 to 3 g/cm3; default 1.04 (assumed).
    """

    _table = "print"
    _keys = (
        "nozzle_mm", "line_mm", "layer_mm", "least_wall_mm", "elephant_foot_mm", "bed_mm",
        "abs_density_g_cm3",
    )
    nozzle_mm: float
    line_mm: float
    layer_mm: float
    least_wall_mm: float
    elephant_foot_mm: float
    bed_mm: float
    abs_density_g_cm3: float


class Process(Section):
    """Table ``[process]``.

    Attributes
    ----------
    material : str
        Material of the printed parts; the hottest cure in the mould, the inhibition of the cure, and the mass
        follow from it. Range: "abs" or "petg" or "pla" or "resin"; default abs (published).
    silicone : str
        Silicone of the layer; mixing ratio, cure and the scatter of the hardness follow from it; other for one
        whose data are on its package. Range: "sylgard-184" or "smooth-sil-950" or "smooth-sil-940" or
        "dragon-skin-30" or "elastosil-m-4601" or "other"; default sylgard-184 (published).
    cure_c : float
        Cure in the mould; 0 for the temperature at which the silicone shrinks by mould.shrinkage_pct. Range: 0
        to 200 C; default 0.0 (chosen).
    oven_c : float
        Hottest oven for a post-cure of the layer outside the mould, with which Sylgard 184 reaches the
        published 50 Shore A; 25 without an oven. Range: 20 to 250 C; default 150.0 (chosen).
    pins : str
        Steel of the pins, for the shopping list; the friction of other surfaces is not measured. Range:
        "tin-plated" or "music-wire" or "dowel"; default tin-plated (published).
    coating : str
        Coating of the tendon, for the shopping list; the friction of other coatings is not measured. Range:
        "polyamide" or "ptfe" or "none"; default polyamide (published).
    """

    _table = "process"
    _keys = (
        "material", "silicone", "cure_c", "oven_c", "pins", "coating",
    )
    material: str
    silicone: str
    cure_c: float
    oven_c: float
    pins: str
    coating: str


class Mesh(Section):
    """Table ``[mesh]``.

    Attributes
    ----------
    chord_tolerance_mm : float
        Largest absolute distance between mesh and true curve. Range: 0.001 to 0.1 mm; default 0.01 (chosen).
    """

    _table = "mesh"
    _keys = (
        "chord_tolerance_mm",
    )
    chord_tolerance_mm: float


class Drawing(Section):
    """Table ``[drawing]``.

    Attributes
    ----------
    projection : str
        First angle as in Europe and Asia, third as in North America. Range: "first" or "third"; default first
        (chosen).
    paper : str
        Sheet size; a part that does not fit on a4 gets a3. Range: "a4" or "a3"; default a4 (chosen).
    date : str
        For the title block; empty for no date, which keeps the bytes reproducible. Range: a text of at most 20
        ASCII characters; default  (chosen).
    """

    _table = "drawing"
    _keys = (
        "projection", "paper", "date",
    )
    projection: str
    paper: str
    date: str


class Friction(Section):
    """Table ``[friction]``.

    Attributes
    ----------
    load_min_n : float
        Lightest load of the curve; 3.077 was the lightest tested. Range: 0 to 1000 N; default 3.0766
        (published).
    load_max_n : float
        Heaviest load of the curve; 49.671 was the heaviest tested. Range: 0.1 to 1000 N; default 49.671
        (published).
    points : int
        Points of the curve. Range: 2 to 10000; default 101 (chosen).
    six_single_threshold : float
        F_thr of six-single as printed; 4.7 would bring its maximum to the measured one. Range: 0 to 20; default
        5.7 (published).
    """

    _table = "friction"
    _keys = (
        "load_min_n", "load_max_n", "points", "six_single_threshold",
    )
    load_min_n: float
    load_max_n: float
    points: int
    six_single_threshold: float


class Sections:
    """The tables of a configuration."""

    switch: Switch
    layout: Layout
    segment: Segment
    shell: Shell
    fasteners: Fasteners
    silicone: Silicone
    pins: Pins
    tendon: Tendon
    support: Support
    mould: Mould
    mount: Mount
    rig: Rig
    parts: Parts
    label: Label
    print: Print
    process: Process
    mesh: Mesh
    drawing: Drawing
    friction: Friction


SECTIONS: dict[str, type[Section]] = {
    "switch": Switch,
    "layout": Layout,
    "segment": Segment,
    "shell": Shell,
    "fasteners": Fasteners,
    "silicone": Silicone,
    "pins": Pins,
    "tendon": Tendon,
    "support": Support,
    "mould": Mould,
    "mount": Mount,
    "rig": Rig,
    "parts": Parts,
    "label": Label,
    "print": Print,
    "process": Process,
    "mesh": Mesh,
    "drawing": Drawing,
    "friction": Friction,
}
