//! The guide as Markdown.

use std::fmt::Write as _;

use super::document::{Block, Document, Step, Table};
use super::step_picture;
use crate::formats::markdown::escape;

/// Writes a document.
pub(super) fn markdown(document: &Document) -> String {
    let mut text = format!("# {}\n", escape(&document.title));
    for block in &document.blocks {
        text.push('\n');
        match block {
            Block::Heading { number: Some(number), text: words } => {
                let _ = writeln!(text, "## {number}. {words}");
            }
            Block::Heading { number: None, text: words } => {
                let _ = writeln!(text, "### {words}");
            }
            Block::Paragraph(words) => {
                let _ = writeln!(text, "{words}");
            }
            Block::List(points) => {
                for point in points {
                    let _ = writeln!(text, "- {point}");
                }
            }
            Block::Table(table) => write_table(&mut text, table),
            Block::Picture { file, alt, .. } | Block::Figure { file, alt, .. } => {
                let _ = writeln!(text, "![{alt}]({file})");
            }
            Block::Step(step) => write_step(&mut text, step),
        }
    }
    text
}

fn write_table(text: &mut String, table: &Table) {
    let row = |cells: &[String]| format!("| {} |\n", cells.join(" | "));
    text.push_str(&row(&table.head));
    text.push_str(&format!("|{}\n", "---|".repeat(table.head.len())));
    for cells in &table.rows {
        text.push_str(&row(cells));
    }
}

fn write_step(text: &mut String, step: &Step) {
    let _ = writeln!(text, "### {} {}\n\n{}", step.label(), step.title, step.text.join(" "));
    if !step.risks.is_empty() {
        text.push('\n');
    }
    for risk in &step.risks {
        let _ = writeln!(text, "- {}", Step::risk_text(risk));
    }
    if let Some((number, _)) = &step.picture {
        let _ = writeln!(text, "\n![Step {}]({})", step.label(), step_picture(*number));
    }
}
