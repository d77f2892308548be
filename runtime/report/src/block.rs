//! Sections of a page and their blocks.

use super::claim::Claim;
use super::equation::Equation;
use super::inline::{Inline, inlines};
use super::pattern::Pattern;
use super::plot::Figure;
use super::scene::Scene;
use super::table::Table;

/// A section of the page.
#[derive(Debug, Clone, PartialEq)]
pub struct Section {
    /// Anchor on the page: letters, digits, hyphens and underscores.
    pub id: String,
    /// Heading of the section.
    pub title: String,
    /// Blocks of the section in order.
    pub blocks: Vec<Block>,
}

/// A part of a section.
#[derive(Debug, Clone, PartialEq)]
pub enum Block {
    /// A paragraph.
    Text(Vec<Inline>),
    /// A heading within the section.
    Heading(Vec<Inline>),
    /// Equations, each on a separate line.
    Equations(Vec<Equation>),
    /// Short equations of intermediate values, side by side if the page is wide enough.
    Abbreviations(Vec<Equation>),
    /// A table of values.
    Table(Table),
    /// Claims with their verdicts.
    Claims(Vec<Claim>),
    /// Sparsity patterns of matrices, side by side.
    Patterns(Vec<Pattern>),
    /// Plots with a caption.
    Figure(Figure),
    /// Drawing of the kinematic tree of a robot.
    Tree(Scene),
    /// Interactive 3-D view of the robot.
    Scene(Scene),
    /// Preformatted text in a fixed-width font.
    Code(String),
    /// Blocks that can be collapsed. Collapsed blocks are not printed.
    Details {
        /// Text that is shown while the blocks are collapsed.
        summary: Vec<Inline>,
        /// Whether the blocks are initially open.
        is_open: bool,
        /// Blocks that can be collapsed.
        blocks: Vec<Block>,
    },
}

/// Returns a paragraph with markup: `$…$` is an equation in LaTeX, `` `…` `` is code. For text from descriptions and
/// files use [`plain`].
#[must_use]
pub fn text(source: &str) -> Block {
    Block::Text(inlines(source))
}

/// Returns a paragraph without markup, for text from descriptions and files.
#[must_use]
pub fn plain(source: impl Into<String>) -> Block {
    Block::Text(vec![Inline::Text(source.into())])
}

impl Section {
    /// An empty section.
    #[must_use]
    pub fn new(id: impl Into<String>, title: impl Into<String>) -> Self {
        Self { id: id.into(), title: title.into(), blocks: Vec::new() }
    }

    /// Adds a block.
    #[must_use]
    pub fn block(mut self, block: Block) -> Self {
        self.blocks.push(block);
        self
    }

    /// Adds several blocks.
    #[must_use]
    pub fn blocks(mut self, blocks: impl IntoIterator<Item = Block>) -> Self {
        self.blocks.extend(blocks);
        self
    }

    /// All blocks in order, including blocks inside collapsible blocks.
    pub(super) fn all_blocks(&self) -> Vec<&Block> {
        let mut all = Vec::new();
        collect(&self.blocks, &mut all);
        all
    }

    /// Identifiers of the section and its parts.
    pub(super) fn ids(&self) -> Vec<&str> {
        let parts = self.all_blocks().into_iter().flat_map(Block::ids);
        std::iter::once(self.id.as_str()).chain(parts).collect()
    }
}

fn collect<'a>(blocks: &'a [Block], into: &mut Vec<&'a Block>) {
    for block in blocks {
        into.push(block);
        if let Block::Details { blocks, .. } = block {
            collect(blocks, into);
        }
    }
}

impl Block {
    fn ids(&self) -> Vec<&str> {
        match self {
            Self::Table(table) => vec![&table.id],
            Self::Figure(figure) => vec![&figure.id],
            Self::Patterns(patterns) => patterns.iter().map(|one| one.id.as_str()).collect(),
            Self::Claims(claims) => claims.iter().map(|claim| claim.id.as_str()).collect(),
            _ => Vec::new(),
        }
    }
}
