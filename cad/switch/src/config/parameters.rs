//! Every parameter of a switch: unit (in its name), default, range, origin and reason.

use super::name::Name;
use super::parameter::{choice, choice_values, configuration};
use crate::process::{Coating, Material, PinStock, SiliconeProduct};
use pinswitch_friction::{Substrate, published};

choice_values! { Substrate { Silicone = "silicone", Abs = "abs" } }

choice! {
    /// Which grooves get a slot in the side supports.
    Slots {
        /// Every groove, so that pins can be moved.
        All = "all",
        /// Only the occupied ones.
        Occupied = "occupied",
    }
}

choice! {
    /// Depth of the slots of the side supports.
    SlotKind {
        /// With a floor that retains the pins axially.
        Blind = "blind",
        /// Through the whole plate.
        Through = "through",
    }
}

choice! {
    /// Type of the casting mould.
    MouldKind {
        /// Core, ring and lid, registered by keys.
        Split = "split",
        /// A tray in one piece.
        OnePiece = "one-piece",
        /// No mould.
        None = "none",
    }
}

choice! {
    /// Arrangement of the views of a drawing.
    Projection {
        /// First angle: the top view is below the front view.
        First = "first",
        /// Third angle: the top view is above the front view.
        Third = "third",
    }
}

choice! {
    /// Type of the joint between shell and side supports.
    FastenerKind {
        /// Through screws with nuts outside.
        Screw = "screw",
        /// Through screws with nuts in traps of the right support.
        NutTrap = "nut-trap",
        /// Short screws from both sides into heat-set inserts in the shell.
        Insert = "insert",
    }
}

choice! {
    /// Smallest sheet size of a drawing.
    Paper {
        /// 297 x 210 mm.
        A4 = "a4",
        /// 420 x 297 mm.
        A3 = "a3",
    }
}

choice! {
    /// Type of the mounting plate.
    MountKind {
        /// No plate.
        None = "none",
        /// A base plate with four holes.
        Flange = "flange",
        /// Two links on an axle on the pulley's axis.
        Joint = "joint",
        /// The upright board of a test rig, with guide pulleys, feet, cell mount and drive.
        Rig = "rig",
    }
}

choice! {
    /// Type of the load cell of the rig.
    CellKind {
        /// An S-beam cell, in line with the tendon, with a threaded hole at each end.
        SBeam = "s-beam",
        /// A bar cell, across the tendon, with two threaded holes at each end.
        Bar = "bar",
    }
}

choice! {
    /// Drive of the rig.
    DriveKind {
        /// A linear actuator with a clevis at each end.
        Actuator = "actuator",
        /// A hand crank on a printed drum with a locking pin.
        Crank = "crank",
    }
}

configuration! {
    /// A configuration with every value in its range. [`crate::design::Design`] is one that also satisfies the rules.
    Configuration {
        /// The switch as a whole.
        switch: SwitchTable {
            name: Name = Name::cleaned("switch"), (), Chosen, "names the output folder and the plots";
        }
        /// Pins, substrate and wrap of the tendon.
        layout: LayoutTable {
            pins: Vec<usize> = Vec::new(), (), Published, "occupied grooves, numbered from 1 along increasing angle; [] leaves the substrate bare";
            substrate: Substrate = Substrate::Silicone, (), Published, "silicone for the switch; abs for the rigid proxy, on which the pins alone carry the tendon";
            wrap_angle_deg: f64 = published::WRAP_ANGLE_DEG, 1.0..=340.0, Published, "wrap angle of the tendon; 63.89 in every experiment";
        }
        /// The grooved sector.
        segment: SegmentTable {
            span_deg: f64 = published::SEGMENT_DEG, 5.0..=340.0, Published, "angle of the grooved sector";
            grooves: usize = published::GROOVES, 1..=60, Published, "number of grooves, evenly spaced over the span";
            groove_radius_mm: f64 = 0.5, 0.1..=3.0, Published, "radius of the half-round grooves on shell and silicone";
            end_margin_mm: f64 = 0.0, 0.0..=10.0, Chosen, "material beyond the span at both ends; the published span leaves end walls of 0.54 mm, 0.9 prints better";
        }
        /// The rigid shell.
        shell: ShellTable {
            outer_radius_mm: f64 = 20.0, 5.0..=150.0, Assumed, "radius of the face under the silicone; places the contact at 22 mm, the only radius in the paper";
            wall_mm: f64 = 8.5, 1.0..=60.0, Assumed, "radial thickness; 8.5 has room under the grooves for M3 nut traps and inserts with 1 mm of wall around them";
            width_mm: f64 = 14.0, 2.0..=100.0, Assumed, "width along the axis";
            stop_mm: f64 = 1.0, 0.0..=5.0, Chosen, "thickness of the stops beyond both ends of the layer, which keep it from sliding; 0 omits them";
            stop_height_mm: f64 = 0.8, 0.2..=5.0, Chosen, "height of the stops above the shell's face, at most 0.2 below the silicone's surface";
        }
        /// Axial holes that join shell and side supports.
        fasteners: FastenersTable {
            kind: FastenerKind = FastenerKind::NutTrap, (), Chosen, "nuts in traps need no second wrench; inserts need a soldering iron";
            count: usize = 2, 0..=12, Chosen, "number of through holes; 0 omits them";
            hole_diameter_mm: f64 = 3.4, 1.0..=12.0, Chosen, "clearance hole: 3.4 for M3, 2.4 for M2";
            end_distance_mm: f64 = 3.0, 1.0..=40.0, Chosen, "distance along the arc from the ends of the sector to the centres of the outermost holes";
            nut_recess_mm: f64 = 1.5, 0.0..=10.0, Chosen, "depth of the nut traps, omitted where they do not fit; half the default plate, the other half carries the load";
            head_recess_mm: f64 = 0.0, 0.0..=10.0, Chosen, "depth of counterbores for the screw heads, omitted where they do not fit; 0 for protruding heads";
            dowel_diameter_mm: f64 = 0.0, 0.0..=6.0, Chosen, "steel dowels next to the outermost screws that register shell and supports; 0 omits them";
        }
        /// The cast layer.
        silicone: SiliconeTable {
            thickness_mm: f64 = 2.0, 0.3..=10.0, Published, "thickness of the layer";
            side_clearance_mm: f64 = 0.2, 0.0..=1.0, Chosen, "gap to each side support; the layer must bulge without rubbing";
            hardness_shore_a: f64 = 50.0, 10.0..=80.0, Published, "Sylgard 184 after a hot cure; affects friction through the stiffness from Gent's formula";
            density_g_cm3: f64 = 1.03, 0.8..=1.5, Assumed, "cured Sylgard 184";
            mix_ratio: f64 = 10.0, 1.0..=20.0, Published, "base to curing agent by mass";
            waste_factor: f64 = 1.3, 1.0..=3.0, Chosen, "allowance for silicone left in cup and syringe";
            least_mix_g: f64 = 11.0, 0.0..=100.0, Chosen, "below it, a scale with 0.1 g resolution cannot weigh 10:1";
        }
        /// The steel pins.
        pins: PinsTable {
            diameter_mm: f64 = 0.94, 0.1..=5.0, Published, "polished tin-plated steel";
            tolerance_mm: f64 = 0.01, 0.0..=0.2, Published, "tolerance of the diameter";
            end_play_mm: f64 = 0.2, 0.0..=2.0, Chosen, "axial play between the two slot floors";
            spares: usize = 1, 0..=20, Chosen, "spare pins to cut";
        }
        /// The tendon.
        tendon: TendonTable {
            rope_diameter_mm: f64 = 1.2, 0.1..=6.0, Published, "the paper's 1.2 mm \"radius\" read as diameter: 2.4 mm rope would carry four times the published 850 N";
            coating_mm: f64 = 0.25, 0.0..=2.0, Published, "polyamide-12 coating, on the radius";
            length_mm: f64 = 300.0, 10.0..=10000.0, Chosen, "length to cut, for the bill of materials";
            entry_fillet_mm: f64 = 0.45, 0.0..=3.0, Chosen, "fillet of the stops where the tendon enters and leaves, at most 0.45 of their thickness; a sharp edge would cut the coating";
            sheath_diameter_mm: f64 = 0.0, 0.0..=10.0, Chosen, "outer diameter of a sheath that ends in a stop on the mounting plate, on the side away from the load; 0 for no sheath";
        }
        /// The two side supports.
        support: SupportTable {
            plate_mm: f64 = 3.0, 0.8..=20.0, Chosen, "thickness of the plates";
            slots: Slots = Slots::All, (), Chosen, "all lets pins be moved; occupied prevents wrong layouts";
            slot_kind: SlotKind = SlotKind::Blind, (), Chosen, "blind slots retain the pins axially; through slots let them be changed from outside";
            slot_clearance_mm: f64 = 0.2, 0.1..=0.4, Chosen, "slot width beyond the pin; under 0.1 slicers close the slot, over 0.4 the pin has too much play";
            slot_floor_mm: f64 = 0.9, 0.2..=5.0, Chosen, "thickness of the plate under a blind slot";
            travel_margin_mm: f64 = 0.2, 0.0..=2.0, Chosen, "travel beyond the pin's flush position";
            rise_mm: f64 = 2.55, 0.5..=20.0, Chosen, "height of the plate above the resting pins; 1.5 tendon diameters retain the tendon";
            corner_radius_mm: f64 = 1.5, 0.0..=5.0, Chosen, "radius of the outer corners; sharp ones would cut the coating";
            lip_depth_mm: f64 = 0.8, 0.0..=5.0, Chosen, "depth of the lip over the edge of the silicone; 0 omits it";
            lip_height_mm: f64 = 0.9, 0.4..=5.0, Chosen, "radial thickness of the lip: two printed lines";
            lip_clearance_mm: f64 = 0.2, 0.0..=2.0, Chosen, "gap between lip and resting silicone";
        }
        /// The casting mould.
        mould: MouldTable {
            kind: MouldKind = MouldKind::Split, (), Chosen, "split comes apart for release; one-piece is a tray";
            wall_mm: f64 = 3.0, 1.2..=20.0, Chosen, "least wall around the cavity";
            floor_mm: f64 = 3.0, 0.8..=20.0, Chosen, "floor, base plate and lid";
            overfill_mm: f64 = 1.0, 0.0..=10.0, Chosen, "one-piece: height of the basin above the layer; cut the layer along its ledge";
            draft_deg: f64 = 0.0, 0.0..=5.0, Chosen, "one-piece: draft of the basin's walls, whose silicone is cut off; the walls that shape the layer are vertical";
            shrinkage_pct: f64 = 0.0, 0.0..=3.0, Chosen, "linear shrinkage of the silicone that the cavity compensates, and with it the temperature of the cure: 0 for 25 C, 0.9 for 60 C in ABS";
            clearance_mm: f64 = 0.2, 0.05..=0.5, Chosen, "print clearance between parts of the split mould, per side";
            key_diameter_mm: f64 = 3.0, 1.5..=10.0, Chosen, "diameter at the foot of the keys that register the parts";
            key_height_mm: f64 = 2.5, 0.5..=10.0, Chosen, "height of the keys";
            pour_width_mm: f64 = 6.0, 1.0..=20.0, Chosen, "width of the lid's pouring funnel at its mouth";
            vent_diameter_mm: f64 = 1.5, 0.5..=4.0, Chosen, "diameter of the vents at both ends of the lid, at most the width of the cavity";
        }
        /// The mounting plate next to the left support, fastened by the same screws.
        mount: MountTable {
            kind: MountKind = MountKind::None, (), Chosen, "flange, joint or rig; with none, the two screws fasten the switch to a user-defined support";
            plate_mm: f64 = 7.0, 2.0..=20.0, Chosen, "thickness of the plate; 7 has room for the heads of M5 screws and of the rig's M8 bolts";
            hole_diameter_mm: f64 = 4.5, 2.0..=12.0, Chosen, "mounting holes of the plate, and at the ends of the links of a joint: 4.5 for M4 (ISO 273)";
            rim_mm: f64 = 3.0, 1.0..=20.0, Chosen, "wall around every hole of the plate";
            axle_mm: f64 = 5.0, 4.0..=8.0, Chosen, "joint: diameter of the bolt on the pulley's axis: 4, 5, 6 or 8 (M4 to M8, ISO 4014)";
            proximal_mm: f64 = 60.0, 10.0..=300.0, Chosen, "joint: from the axis to the holes at the end of the proximal link, which carries the switch";
            distal_mm: f64 = 50.0, 10.0..=300.0, Chosen, "joint: from the axis to the holes at the end of the distal link, which carries the load";
            flexion_min_deg: f64 = 0.0, 0.0..=150.0, Chosen, "joint: flexion at the first stop; at 0 the links are in line";
            flexion_max_deg: f64 = 75.0, 5.0..=170.0, Chosen, "joint: flexion at the second stop; the published segment ends at 76.7";
            pulley_distance_mm: f64 = 70.0, 20.0..=500.0, Chosen, "rig: straight tendon between the switch and each guide pulley";
        }
        /// The test rig (`mount.kind = "rig"`): stand, load, cell and drive.
        rig: RigTable {
            tendon_height_mm: f64 = 60.0, 45.0..=120.0, Chosen, "height of the tendon above the table between guide pulley and drive; the axis of the drive";
            weight_diameter_mm: f64 = 120.0, 10.0..=300.0, Chosen, "largest diameter of the weights; the table's edge clears them by 10 mm";
            hook_mass_g: f64 = published::HOOK_MASS_G, 0.0..=1000.0, Published, "hook between tendon and weights; it is part of every load";
            cell: CellKind = CellKind::SBeam, (), Chosen, "s-beam is in line with the tendon; bar is cheaper and needs a longer bracket";
            cell_limit_n: f64 = 98.0, 1.0..=1000.0, Chosen, "range of the load cell: 10 kg, the smallest common one above the paper's largest reading of 62.6 N";
            s_beam_thread_mm: f64 = 8.0, 4.0..=12.0, Assumed, "s-beam: metric thread at both ends; M6 and M8 are common";
            s_beam_length_mm: f64 = 63.5, 20.0..=120.0, Assumed, "s-beam: length between the faces with the threads; measure it";
            s_beam_width_mm: f64 = 50.8, 12.0..=80.0, Assumed, "s-beam: width across the tendon; measure it";
            s_beam_thickness_mm: f64 = 12.7, 5.0..=26.0, Assumed, "s-beam: thickness; measure it";
            bar_length_mm: f64 = 80.0, 50.0..=150.0, Chosen, "bar: length (TAL220 and YZC-133: 80)";
            bar_side_mm: f64 = 12.7, 6.0..=26.0, Chosen, "bar: side of the square section (TAL220: 12.7)";
            bar_hole_inset_mm: f64 = 5.0, 3.0..=15.0, Chosen, "bar: from each end to the outer hole (TAL220: 5)";
            bar_hole_spacing_mm: f64 = 15.0, 8.0..=25.0, Chosen, "bar: between the two holes of an end (TAL220: 15)";
            bar_screw_mm: f64 = 5.0, 3.0..=6.0, Chosen, "bar: metric thread at the fixed end (TAL220: M5)";
            bar_load_thread_mm: f64 = 4.0, 3.0..=6.0, Chosen, "bar: metric thread at the load end, for the eye bolt (TAL220: M4)";
            sample_rate_hz: f64 = 80.0, 1.0..=100000.0, Chosen, "rate of the logger; 80 is the fast setting of the HX711 amplifier";
            drive: DriveKind = DriveKind::Actuator, (), Chosen, "actuator moves at a known speed; crank needs no supply";
            stroke_mm: f64 = published::STROKE_MM, 10.0..=400.0, Published, "stroke of the drive";
            full_speed_mm_s: f64 = 50.8, 0.1..=1000.0, Chosen, "speed of the actuator at 100 %, 2 in/s; measure it with the heaviest load";
            retracted_mm: f64 = 292.4, 60.0..=900.0, Chosen, "actuator: distance of its two holes when retracted; PA-14: the stroke and 5.51 in";
            clevis_pin_mm: f64 = 6.0, 4.0..=10.0, Chosen, "actuator: metric bolt through its two holes; M6 passes the holes of 6.35 of a PA-14";
            clevis_mm: f64 = 10.0, 4.0..=20.0, Assumed, "actuator: thickness of its eyes along the bolt; measure it";
            body_mm: f64 = 38.1, 15.0..=64.0, Chosen, "actuator: diameter of its body (PA-14: 1.5 in)";
        }
        /// Optional parts.
        parts: PartsTable {
            proxy: bool = true, (), Published, "the rigid proxy of the silicone layer";
            coupon: bool = true, (), Chosen, "fit coupon: slots of 0.10 to 0.40 mm clearance and three grooves";
            guide_pulley: bool = false, (), Published, "the rig's guide pulley, radius 22 mm, for a 608 bearing";
        }
        /// The engraved label.
        label: LabelTable {
            engrave: bool = true, (), Chosen, "identifies printed variants; omitted with a warning where it does not fit";
            text: String = String::new(), 12, Chosen, "empty: pins x step / first groove, such as 3x3/5";
            height_mm: f64 = 3.2, 1.5..=10.0, Chosen, "height of the letters";
            stroke_mm: f64 = 0.45, 0.3..=2.0, Chosen, "stroke width, at least one printed line";
            depth_mm: f64 = 0.4, 0.1..=2.0, Chosen, "two layers";
        }
        /// The printer.
        print: PrintTable {
            nozzle_mm: f64 = 0.4, 0.1..=1.2, Chosen, "nozzle";
            line_mm: f64 = 0.45, 0.1..=1.5, Chosen, "extrusion width";
            layer_mm: f64 = 0.2, 0.05..=0.6, Chosen, "layer height";
            least_wall_mm: f64 = 0.45, 0.1..=3.0, Chosen, "thinnest wall or land that is accepted: one printed line; under two lines it warns";
            elephant_foot_mm: f64 = 0.0, 0.0..=1.0, Chosen, "45 degree chamfer on bottom edges; slicers compensate 0.2 by default: use one of the two";
            bed_mm: f64 = 250.0, 50.0..=2000.0, Chosen, "side of the print bed";
            abs_density_g_cm3: f64 = 1.04, 0.5..=3.0, Assumed, "for the mass of the printed parts";
        }
        /// Materials as bought, and the cure of the layer.
        process: ProcessTable {
            material: Material = Material::Abs, (), Published, "material of the printed parts; the hottest cure in the mould, the inhibition of the cure, and the mass follow from it";
            silicone: SiliconeProduct = SiliconeProduct::Sylgard184, (), Published, "silicone of the layer; mixing ratio, cure and the scatter of the hardness follow from it; other for one whose data are on its package";
            cure_c: f64 = 0.0, 0.0..=200.0, Chosen, "cure in the mould; 0 for the temperature at which the silicone shrinks by mould.shrinkage_pct";
            oven_c: f64 = 150.0, 20.0..=250.0, Chosen, "hottest oven for a post-cure of the layer outside the mould, with which Sylgard 184 reaches the published 50 Shore A; 25 without an oven";
            pins: PinStock = PinStock::TinPlated, (), Published, "steel of the pins, for the shopping list; the friction of other surfaces is not measured";
            coating: Coating = Coating::Polyamide, (), Published, "coating of the tendon, for the shopping list; the friction of other coatings is not measured";
        }
        /// The mesh.
        mesh: MeshTable {
            chord_tolerance_mm: f64 = 0.01, 1e-3..=0.1, Chosen, "largest absolute distance between mesh and true curve";
        }
        /// The drawing.
        drawing: DrawingTable {
            projection: Projection = Projection::First, (), Chosen, "first angle as in Europe and Asia, third as in North America";
            paper: Paper = Paper::A4, (), Chosen, "sheet size; a part that does not fit on a4 gets a3";
            date: String = String::new(), 20, Chosen, "for the title block; empty for no date, which keeps the bytes reproducible";
        }
        /// The predicted curve.
        friction: FrictionTable {
            load_min_n: f64 = 3.0766, 0.0..=1000.0, Published, "lightest load of the curve; 3.077 was the lightest tested";
            load_max_n: f64 = 49.671, 0.1..=1000.0, Published, "heaviest load of the curve; 49.671 was the heaviest tested";
            points: usize = 101, 2..=10000, Chosen, "points of the curve";
            six_single_threshold: f64 = 5.7, 0.0..=20.0, Published, "F_thr of six-single as printed; 4.7 would bring its maximum to the measured one";
        }
    }
}
