//! Faults of solids, meshes, their files and the slicer.

pages! {
    "Parts, meshes and slicing";

    THIN_PLACE: "thin-place", "A part has a place under two printed lines", in "cad/doc/print-limits.md" {
        "One rule measures the distance through material between any two faces that face each \
         other, at every height, exactly for lines and arcs. Walls that are lower than thick, \
         such as the edge of an engraved letter, do not count.",
        "The warning gives the part, the thickness and its place. No part of the published \
         layouts has such a place.",
    }

    SHAPE_CANNOT_BE_BUILT: "shape-cannot-be-built", "The shape of a part cannot be constructed", in "cad/doc/meshes.md" {
        "An offset moves every edge into the material; if an edge would vanish or reverse, or if \
         contours cross, there is no such shape. This can happen although no rule is broken, \
         mostly with `print.elephant_foot_mm`, `support.corner_radius_mm` or \
         `mould.pour_width_mm`.",
        "The help names the nearest configurations that can be built, where some are found. \
         Otherwise please report the configuration.",
    }

    INVALID_MESH: "invalid-mesh", "A mesh is not valid", in "cad/doc/meshes.md" {
        "A valid mesh is closed, consistently oriented and free of self-intersections, so that \
         inside and outside are defined. `pinswitch check` prints the faults of each file with \
         their places.",
        "Export the part again from the program that made it, or repair it there. If pinswitch \
         made the mesh, please report the configuration.",
    }

    MESH_NOT_JUDGED: "mesh-not-judged", "A mesh cannot be judged within the bounds", in "cad/doc/meshes.md" {
        "The examination has bounds of time and memory for files of any origin. A file beyond \
         them is neither valid nor invalid.",
        "A coarser mesh, or several files, may meet the bounds.",
    }

    MALFORMED_MESH_FILE: "malformed-mesh-file", "The mesh file breaks its format", in "cad/doc/meshes.md" {
        "An STL or 3MF has a fixed structure, and the message names the line or the part of the \
         package where the file departs from it. Truncated downloads are the usual cause.",
        "Export the part again.",
    }

    UNSUPPORTED_FORMAT: "unsupported-format", "The format is not supported here", in "cad/doc/meshes.md" {
        "The command recognises the format by the content or the ending of the file, and does \
         not read or write this one.",
        "The help names formats that are possible, or another program for this one.",
    }

    KERNELS_DISAGREE: "kernels-disagree", "The second kernel makes another mesh", in "cad/doc/meshes.md" {
        "With `--verify` a second CAD kernel, truck, builds each part again from the exact \
         solid, and both meshes are compared within the chord tolerance. A difference is an \
         error of one of the two programs, not of your configuration.",
        "Please report the configuration. Without `--verify` the parts are still examined by the \
         rules of every mesh.",
    }

    SLICER_NOT_FOUND: "slicer-not-found", "No slicer was found", in "cad/doc/slicing.md" {
        "`--slice` needs PrusaSlicer 2.5 or later. It is searched as `prusa-slicer` on PATH, or \
         at the path in PINSWITCH_SLICER. If the variable names something that is not a program, \
         this is an error; if nothing is installed, it is a warning and everything else is made.",
        "Install it, or leave `--slice` out.",
    }

    SLICER_FAILED: "slicer-failed", "The slicer did not slice a file", in "cad/doc/slicing.md" {
        "The message of the slicer follows the name of the file. The parts are written all the \
         same, since only print time and filament are missing. A file may take 600 s, or \
         PINSWITCH_SLICER_SECONDS, after which the slicer is ended.",
        "Try the file in the slicer's own window, with the profile of your printer. Versions \
         before 2.5 write no estimate that the program can read.",
    }

    FEATURE_LEFT_OUT: "feature-left-out", "A feature of a part is left out", in "cad/doc/dimensions.md" {
        "There is no room for it on the part. The set is made without it, and the drawing has a \
         note.",
        "The warning names the part and the feature, and a change that was tested, if a single \
         value makes room.",
    }
}
