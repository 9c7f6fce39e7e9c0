//! The manual as one HTML file, without scripts and without references to other files.

use std::fmt::Write as _;

use super::{Pictures, of_step};
use crate::formats::guide::document::{Block, Document, Step, Table};
use crate::formats::guide::figure::{Align, Figure, Ink, Shape, TEXT_MM};
use crate::formats::guide::inline::{Run, runs};
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;

const STYLE: &str = include_str!("manual.css");

pub(super) fn html(document: &Document, pictures: &Pictures) -> String {
    let mut text = format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" \
         content=\"width=device-width, initial-scale=1\">\n<title>{}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n<main>\n<h1>{}</h1>\n",
        escape(&document.title),
        escape(&document.title)
    );
    text.push_str(&contents(document));
    for block in &document.blocks {
        write_block(&mut text, block, pictures);
    }
    text.push_str("</main>\n</body>\n</html>\n");
    text
}

fn escape(text: &str) -> String {
    text.chars().fold(String::with_capacity(text.len()), |mut escaped, c| {
        match c {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            other => escaped.push(other),
        }
        escaped
    })
}

fn inline(text: &str) -> String {
    let tagged = |tag: &str, text: &str| format!("<{tag}>{}</{tag}>", escape(text));
    runs(text)
        .iter()
        .map(|run| match run {
            Run::Plain(text) => escape(text),
            Run::Strong(text) => tagged("strong", text),
            Run::Code(text) => tagged("code", text),
        })
        .collect()
}

/// The list of sections.
fn contents(document: &Document) -> String {
    let items: String = document
        .blocks
        .iter()
        .filter_map(|block| match block {
            Block::Heading { number: Some(number), text } => {
                Some(format!("<li><a href=\"#section-{number}\">{}</a></li>\n", inline(text)))
            }
            _ => None,
        })
        .collect();
    format!("<nav aria-label=\"Contents\">\n<ol>\n{items}</ol>\n</nav>\n")
}

fn write_block(text: &mut String, block: &Block, pictures: &Pictures) {
    match block {
        Block::Heading { number: Some(number), text: words } => {
            let _ = writeln!(text, "<h2 id=\"section-{number}\">{number}. {}</h2>", inline(words));
        }
        Block::Heading { number: None, text: words } => {
            let _ = writeln!(text, "<h3>{}</h3>", inline(words));
        }
        Block::Paragraph(words) => {
            let _ = writeln!(text, "<p>{}</p>", inline(words));
        }
        Block::List(points) => {
            let items: String = points.iter().map(|p| format!("<li>{}</li>\n", inline(p))).collect();
            let _ = writeln!(text, "<ul>\n{items}</ul>");
        }
        Block::Table(table) => write_table(text, table),
        Block::Picture { file, alt, .. } => {
            if let Some(png) = pictures.get(file) {
                let _ = writeln!(text, "<figure>{}</figure>", image(png, alt));
            }
        }
        Block::Figure { alt, figure, .. } => {
            let _ = writeln!(text, "<figure>{}</figure>", svg(figure, alt));
        }
        Block::Step(step) => write_step(text, step, pictures),
    }
}

fn image(png: &[u8], alt: &str) -> String {
    format!("<img alt=\"{}\" src=\"data:image/png;base64,{}\">", escape(alt), STANDARD.encode(png))
}

fn write_table(text: &mut String, table: &Table) {
    let head: String =
        table.head.iter().map(|cell| format!("<th scope=\"col\">{}</th>", inline(cell))).collect();
    let _ = writeln!(text, "<table>\n<thead>\n<tr>{head}</tr>\n</thead>\n<tbody>");
    for row in &table.rows {
        let cells: String = row
            .iter()
            .zip(&table.head)
            .map(|(cell, head)| {
                format!("<td data-title=\"{}\"><span>{}</span></td>", escape(head), inline(cell))
            })
            .collect();
        let _ = writeln!(text, "<tr>{cells}</tr>");
    }
    text.push_str("</tbody>\n</table>\n");
}

fn write_step(text: &mut String, step: &Step, pictures: &Pictures) {
    let picture = step.picture.as_ref().and_then(|(number, _)| of_step(pictures, *number));
    let class = if picture.is_some() { "step pictured" } else { "step" };
    let (label, title) = (step.label(), inline(&step.title));
    let _ = writeln!(text, "<section class=\"{class}\">\n<div>\n<h3>{label} {title}</h3>");
    let _ = writeln!(text, "<p>{}</p>", inline(&step.text.join(" ")));
    if !step.risks.is_empty() {
        let risks: String =
            step.risks.iter().map(|risk| format!("<li>{}</li>\n", inline(&Step::risk_text(risk)))).collect();
        let _ = writeln!(text, "<ul class=\"risks\">\n{risks}</ul>");
    }
    text.push_str("</div>\n");
    if let Some((_, png)) = picture {
        let alt = format!("Picture of step {}: {}", step.label(), step.title);
        let _ = writeln!(text, "<figure>{}</figure>", image(png, &alt));
    }
    text.push_str("</section>\n");
}

const fn class(ink: Ink) -> &'static str {
    match ink {
        Ink::Axis => "axis",
        Ink::Band => "band",
        Ink::Curve => "curve",
        Ink::Threshold => "threshold",
    }
}

fn svg(figure: &Figure, alt: &str) -> String {
    let [width, height] = figure.size_mm;
    let points = |all: &[[f64; 2]]| -> String {
        all.iter().map(|[x, y]| format!("{x:.2},{y:.2}")).collect::<Vec<_>>().join(" ")
    };
    let shapes: String = figure
        .shapes
        .iter()
        .map(|shape| match shape {
            Shape::Line(ink, all) => {
                format!("<polyline class=\"{}\" points=\"{}\"/>\n", class(*ink), points(all))
            }
            Shape::Area(ink, all) => {
                format!("<polygon class=\"{}\" points=\"{}\"/>\n", class(*ink), points(all))
            }
            Shape::Text(ink, align, [x, y], words) => {
                let anchor = match align {
                    Align::Start => "start",
                    Align::Middle => "middle",
                    Align::End => "end",
                };
                format!(
                    "<text class=\"{}\" x=\"{x:.2}\" y=\"{y:.2}\" font-size=\"{TEXT_MM}\" text-anchor=\"{anchor}\">{}</text>\n",
                    class(*ink),
                    escape(words)
                )
            }
        })
        .collect();
    format!(
        "<svg viewBox=\"0 0 {width} {height}\" role=\"img\" aria-label=\"{}\">\n{shapes}</svg>",
        escape(alt)
    )
}
