//! The model of the guide: one document, which each writer puts into its format.
//!
//! Texts are a subset of Markdown: `**strong**`, `` `code` `` and backslash escapes. [`super::inline`] reads it.

use super::figure::Figure;
use crate::scene::{Bench, Illustration};

/// A document.
#[derive(Clone, Debug)]
pub(crate) struct Document {
    /// Title, plain text.
    pub title: String,
    /// Content.
    pub blocks: Vec<Block>,
}

/// A block of a document.
#[derive(Clone, Debug)]
pub(crate) enum Block {
    /// The heading of a section, numbered from 1, or of a part of it.
    Heading {
        /// Number of a section; `None` for a part of it.
        number: Option<usize>,
        /// Text.
        text: String,
    },
    /// A paragraph.
    Paragraph(String),
    /// A list of points.
    List(Vec<String>),
    /// A table.
    Table(Table),
    /// A picture of the set: its file, and its description.
    Picture {
        /// File in the set.
        file: String,
        /// Description.
        alt: String,
        /// What it shows.
        source: PictureSource,
    },
    /// A drawing of lines: the file with the same content, its description, and the lines.
    Figure {
        /// File in the set.
        file: String,
        /// Description.
        alt: String,
        /// Lines.
        figure: Figure,
    },
    /// A step.
    Step(Step),
}

/// The content of a picture of the set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PictureSource {
    /// The exploded assembly.
    Exploded,
    /// A plate, by its index.
    Plate(usize),
}

/// A table: the first row has the titles of the columns.
#[derive(Clone, Debug)]
pub(crate) struct Table {
    /// Titles.
    pub head: Vec<String>,
    /// Rows, as long as `head`.
    pub rows: Vec<Vec<String>>,
}

impl Table {
    /// Returns a table as a block.
    pub(crate) fn block<const N: usize>(
        head: [&str; N],
        rows: impl IntoIterator<Item = [String; N]>,
    ) -> Block {
        Block::Table(Self {
            head: head.map(str::to_owned).to_vec(),
            rows: rows.into_iter().map(|row| row.to_vec()).collect(),
        })
    }
}

/// An error that can occur in a step.
#[derive(Clone, Debug)]
pub(crate) struct Risk {
    /// What goes wrong.
    pub problem: String,
    /// How it is noticed, and what to do.
    pub sign: String,
}

/// A step: what to do, what can go wrong, and a picture of the bodies that it moves.
#[derive(Clone, Debug)]
pub(crate) struct Step {
    /// Number of its section, and its number in the section; set by [`number`].
    pub number: [usize; 2],
    /// Title: an imperative.
    pub title: String,
    /// Sentences.
    pub text: Vec<String>,
    /// Errors.
    pub risks: Vec<Risk>,
    /// Picture, with its number in the document; set by [`number`].
    pub picture: Option<(usize, Illustration)>,
}

impl Step {
    /// Creates a step with a title.
    pub(crate) fn new(title: impl Into<String>) -> Self {
        Self { number: [0, 0], title: title.into(), text: Vec::new(), risks: Vec::new(), picture: None }
    }

    /// Adds sentences; nothing for an empty text.
    #[must_use]
    pub(crate) fn text(mut self, text: impl Into<String>) -> Self {
        let text = text.into();
        if !text.is_empty() {
            self.text.push(text);
        }
        self
    }

    /// Adds an error and its sign.
    #[must_use]
    pub(crate) fn risk(mut self, problem: &str, sign: &str) -> Self {
        self.risks.push(Risk { problem: problem.to_owned(), sign: sign.to_owned() });
        self
    }

    /// Adds an error and its sign if `is_possible`.
    #[must_use]
    pub(crate) fn risk_if(self, is_possible: bool, problem: &str, sign: &str) -> Self {
        if is_possible { self.risk(problem, sign) } else { self }
    }

    /// Sets the picture.
    #[must_use]
    pub(crate) fn picture(mut self, picture: Illustration) -> Self {
        self.picture = Some((0, picture));
        self
    }

    /// Returns the number with its section, such as `5.2`.
    pub(crate) fn label(&self) -> String {
        format!("{}.{}", self.number[0], self.number[1])
    }

    /// Returns the sentence of an error.
    pub(crate) fn risk_text(risk: &Risk) -> String {
        format!("**Risk:** {} **Sign:** {}", risk.problem, risk.sign)
    }
}

impl Document {
    /// Returns the steps in their order.
    pub(crate) fn steps(&self) -> impl Iterator<Item = &Step> {
        self.blocks.iter().filter_map(|block| match block {
            Block::Step(step) => Some(step),
            _ => None,
        })
    }
}

/// A section: its title and its blocks.
pub(crate) type Section = (&'static str, Vec<Block>);

/// Numbers sections, steps and pictures, and puts into every picture the bodies that earlier steps placed on its bench.
pub(crate) fn number(sections: Vec<Section>) -> Vec<Block> {
    let (mut blocks, mut pictures) = (Vec::new(), 0);
    let mut benches = std::collections::BTreeMap::<_, Vec<String>>::new();
    let filled = sections.into_iter().filter(|(_, content)| !content.is_empty());
    for (section, (title, content)) in (1..).zip(filled) {
        blocks.push(Block::Heading { number: Some(section), text: title.to_owned() });
        let mut steps = 0;
        for mut block in content {
            if let Block::Step(step) = &mut block {
                steps += 1;
                step.number = [section, steps];
                if let Some((number, picture)) = &mut step.picture {
                    pictures += 1;
                    *number = pictures;
                    let placed = benches.entry(picture.bench).or_default();
                    picture.present.clone_from(placed);
                    for m in &picture.moves {
                        placed.retain(|name| !m.bodies.contains(name));
                        // Loose bodies are put aside again.
                        if m.motion.stays() && picture.bench != Bench::Loose {
                            placed.extend(m.bodies.iter().cloned());
                        }
                    }
                }
            }
            blocks.push(block);
        }
    }
    blocks
}
