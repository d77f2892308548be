//! Prints constant tables for loops over the joints of a tree: which joints carry each other, and which
//! coordinates are coupled.

use proc_macro2::{Ident, Literal};
use quote::quote;

use super::arrays::Emission;
use super::doc_comment::DocComment;
use crate::emit::arrays;
use crate::program::arrays::{Arrays, Relation};

impl Emission<'_> {
    /// Adds the table of [`arrays::relation`], which says for each pair of joints whether one carries the
    /// other, and returns its name.
    pub(super) fn add_relations(&self) -> Ident {
        let about = "Relation of joint j to joint i: −1 if j is before i on its path to the base, 1 if j is i or beyond i, otherwise 0.";
        self.add_table("RELATIONS", about, self.form.joints.len(), self.row.len, arrays::relation)
    }

    /// Adds two tables with lists for each joint: the SIMD blocks of columns with joints before it, and the
    /// blocks with joints beyond it. Returns the names of both tables.
    pub(super) fn add_blocks(&self) -> [Ident; 2] {
        let table = |name: &str, about: &str, is_in: fn(Relation) -> bool| {
            let (joints, block) = (self.form.joints.len(), self.row.block);
            let in_block = |i: usize, first: usize| {
                (first..joints.min(first + block)).any(|j| is_in(self.form.relation(i, j)))
            };
            let blocks = |i: usize| (0..self.row.len / block).filter(move |of| in_block(i, of * block));
            self.add_lists(name, about, (0..joints).map(|i| blocks(i).collect()).collect())
        };
        [
            table("BLOCKS_BEFORE", "Blocks of columns with joints before joint i.", |of| {
                of == Relation::Before
            }),
            table("BLOCKS_BEYOND", "Blocks of columns with joints beyond joint i.", |of| {
                of == Relation::Beyond
            }),
        ]
    }

    /// Adds a table that lists for each SIMD block of a matrix's columns the rows that can be non-zero.
    /// Returns the name of the table.
    pub(super) fn add_rows_of_blocks(&self, matrix: usize) -> Ident {
        let (tree, block) = (self.form.coordinates(), self.row.block);
        let is_over_paths = self.form.is_over_paths(matrix);
        let meets = |row: usize, first: usize| {
            !is_over_paths || (first..tree.len().min(first + block)).any(|column| tree.meet(row, column))
        };
        let rows = |of: usize| (0..tree.len()).filter(move |&row| meets(row, of * block)).collect();
        let about = match is_over_paths {
            true => {
                "For each block of columns, the rows that can be non-zero, in a matrix over coordinates on one path."
            }
            false => "For each block of columns, all rows, because every row can be non-zero.",
        };
        self.add_lists("ROWS_OF_BLOCKS", about, (0..self.row.coordinates / block).map(rows).collect())
    }

    fn add_lists(&self, name: &str, about: &str, lists: Vec<Vec<usize>>) -> Ident {
        let count = Literal::usize_unsuffixed(lists.len());
        let lists = lists.into_iter().map(|list| {
            let list = list.into_iter().map(Literal::usize_unsuffixed);
            quote!(&[#(#list),*])
        });
        let (lists, documentation) = (lists.collect::<Vec<_>>(), DocComment::new(about).tokens());
        self.context
            .shared
            .add(name, |name| quote!(#documentation const #name: [&[usize]; #count] = [#(#lists),*];))
    }

    /// Adds the table of [`arrays::meeting`], the pairs of coordinates with common non-zero entries in the
    /// inverse mass matrix, and returns its name.
    pub(super) fn add_meetings(&self) -> Ident {
        let about = "Whether the inversion of the mass matrix combines the rows of coordinates i and j: 1 if it does, otherwise 0.";
        let (count, lanes) = (self.form.coordinates().len(), self.row.coordinates);
        self.add_table("MEETINGS", about, count, lanes, arrays::meeting)
    }

    fn add_table(
        &self,
        name: &str,
        about: &str,
        count: usize,
        lanes: usize,
        entry: fn(&Arrays, usize, usize) -> i8,
    ) -> Ident {
        let rows = (0..count).map(|i| {
            let row = (0..lanes).map(|j| Literal::i8_unsuffixed(entry(self.form, i, j)));
            quote!([#(#row),*])
        });
        let (rows, count) = (rows.collect::<Vec<_>>(), Literal::usize_unsuffixed(count));
        let lanes = Literal::usize_unsuffixed(lanes);
        let documentation = DocComment::new(about).tokens();
        self.context
            .shared
            .add(name, |name| quote!(#documentation const #name: [[i8; #lanes]; #count] = [#(#rows),*];))
    }
}
