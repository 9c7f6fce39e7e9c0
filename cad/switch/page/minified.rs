/// Removes comments, indentation and empty lines from a script whose comments are on lines of their own and whose strings
/// end on the line on which they begin.
pub(super) fn minified(script: &str) -> String {
    let lines = script.lines().map(str::trim_start);
    lines.filter(|line| !line.is_empty() && !line.starts_with("//")).flat_map(|line| [line, "\n"]).collect()
}
