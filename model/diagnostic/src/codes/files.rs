//! Faults of reading and writing.

pages! {
    "Files and folders";

    FILE_NOT_FOUND: "file-not-found", "The file or template does not exist" {
        "A path is relative to the folder in which the command runs; paths inside a file are \
         relative to the folder of that file. The name of a configuration may also be that of a \
         template.",
        "`pinswitch layouts` lists the templates, and the help names a similar one if there is \
         one.",
    }

    CANNOT_READ: "cannot-read", "A file cannot be read" {
        "The operating system refused, and the line `cause` is its message: usually a missing \
         file, missing permission, or an interrupted network folder.",
        "Nothing was written when an input could not be read.",
    }

    CANNOT_WRITE: "cannot-write", "A file cannot be written" {
        "The operating system refused: the folder does not exist, permission is missing, the \
         disk is full, or a symbolic link in the path leads nowhere. The program writes each \
         file under a temporary name and renames it when it is complete, so an old file is \
         either kept or replaced as a whole.",
        "The exit code is 1, since the input was usable. Repeat the command when the cause is \
         removed.",
    }

    NOT_UTF_8: "not-utf-8", "The text is not UTF-8", in "model/doc/file-formats.md" {
        "Text files are read as UTF-8, with or without a byte-order mark. Spreadsheets and \
         loggers also write UTF-16 or a legacy encoding, in which the same bytes are other \
         characters.",
        "Save the file as UTF-8. `pinswitch import` reads other encodings of measured data, and \
         detects them.",
    }

    FILE_TOO_LARGE: "file-too-large", "The file is larger than the reader accepts" {
        "Every reader has a bound, so that its memory is bounded for any input, also for a small \
         compressed file that unpacks to a huge one. The bounds are far above the files of real \
         use.",
        "Divide the file, or export only the columns or parts that are needed.",
    }

    OUTPUT_IS_INPUT: "output-is-input", "The output would overwrite an input" {
        "The command read this file, and would replace it or remove it at the end. The input is \
         the origin of the result, and a second run could then not repeat it.",
        "Give another path with `--out`.",
    }

    OTHER_SOURCE: "other-source", "The folder contains the set of another configuration", in "model/doc/file-formats.md" {
        "Each set has a manifest with the origin of its files. Two configurations in one folder \
         would overwrite each other, and parts of both could be mixed.",
        "Give another `--out`. With `--force` the new set replaces the old one.",
    }

    CHANGED_FILE: "changed-file", "A file was changed after pinswitch wrote it", in "model/doc/file-formats.md" {
        "The file has a recorded SHA-256, and its content has another one. Results that are \
         computed from it would not follow from the recorded inputs.",
        "Restore the file, or follow the help to use the changed one on purpose. Line ends that \
         an editor or git converts do not change the hash of model files.",
    }

    OUTDATED_RESULT: "outdated-result", "A result was made from a file that has changed since", in "model/doc/file-formats.md" {
        "The folder of the result records the SHA-256 of its inputs, and an input is different \
         now. The result still describes the old input.",
        "Run the named command again.",
    }

    DAMAGED_FILE: "damaged-file", "The content of the file is empty, damaged or incomplete" {
        "An empty file usually comes from a command that failed after its output was opened, \
         such as `program > file`. A file that breaks off or contradicts itself comes from an \
         interrupted copy or an edit by hand.",
        "Make or copy the file again. The line `cause`, if there is one, has the message of the \
         reader.",
    }

    OUTSIDE_THE_FOLDER: "outside-the-folder", "A file outside the folder is named", in "cad/doc/batch.md" {
        "A sweep or a run that comes from somebody else could otherwise read any file of your \
         account. Symbolic links are resolved before the comparison.",
        "Copy the file into the folder, or allow it with `--read-outside`.",
    }

    FOLDER_IN_USE: "folder-in-use", "Another run writes into the same folder" {
        "Two runs at once would mix their files, so the first one locks the folder. The message \
         names the process that has the lock, if it is known; the lock of a process that ended \
         is free.",
        "Wait for it with `--wait SECONDS`, or give another `--out`.",
    }

    NOT_A_FILE: "not-a-file", "The path is not an ordinary file" {
        "The command reads or writes one file at this path, and finds a folder, a pipe or a \
         device. A pipe can be read once at most, and most commands need the file again, its \
         size, or a place next to it.",
        "Give a file, or save the content to a file first.",
    }

    FILE_IN_THE_WAY: "file-in-the-way", "A file in the way was not written by pinswitch, or is yours", in "model/doc/file-formats.md" {
        "The program replaces only files that a record in the folder lists as its own, with \
         their hashes. Another file with the same name may be your work, and so may the file \
         that `init` wrote before.",
        "Move it away, or give another `--out`. `generate` and `init` overwrite it with \
         `--force`.",
    }
}
