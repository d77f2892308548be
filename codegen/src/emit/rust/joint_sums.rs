//! Prints functions for sums over joints: along paths to the base, over subtrees, and over the joints of a
//! coordinate.

use proc_macro2::{Ident, Literal, TokenStream};
use quote::quote;

use super::arrays::Emission;
use super::doc_comment::DocComment;
use crate::emit::arrays::followers;

impl Emission<'_> {
    /// Statements that sum a row with an entry per joint to a row with an entry per coordinate.
    fn collected(&self) -> Vec<TokenStream> {
        let joints = followers(self.form).into_iter().enumerate();
        let sum = |(coordinate, joints): (usize, Vec<usize>)| {
            let coordinate = Literal::usize_unsuffixed(coordinate);
            let joints = joints.into_iter().map(Literal::usize_unsuffixed);
            quote!(to[#coordinate] = #(from[#joints])+*;)
        };
        joints.map(sum).collect()
    }

    pub(super) fn collect(&self) -> Ident {
        let (ty, zero, mut sums) = (self.context.ty(), self.context.zero(), self.collected());
        for padding in self.form.coordinates().len()..self.row.coordinates {
            let padding = Literal::usize_unsuffixed(padding);
            sums.push(quote!(to[#padding] = #zero;));
        }
        let [joints, coordinates] = self.lengths();
        let documentation = DocComment::new("Adds the joints that follow each coordinate.").tokens();
        self.context.shared.add("collect", |name| {
            quote! {
                #documentation
                fn #name<const R: usize>(from: &[[#ty; #joints]; R], to: &mut [[#ty; #coordinates]; R]) {
                    for (from, to) in from.iter().zip(to) { #(#sums)* }
                }
            }
        })
    }

    pub(super) fn project(&self) -> Ident {
        let (ty, zero, sums) = (self.context.ty(), self.context.zero(), self.collected());
        let [joints, coordinates] = self.lengths();
        let [rows, count] =
            [&self.form.joints, self.form.coordinates()].map(|tree| Literal::usize_unsuffixed(tree.len()));
        let more = followers(self.form).into_iter().enumerate().flat_map(|(coordinate, joints)| {
            let coordinate = Literal::usize_unsuffixed(coordinate);
            let joints = joints.into_iter().skip(1).map(Literal::usize_unsuffixed);
            joints.map(move |joint| quote!(rows[#coordinate][j] += rows[#joint][j];)).collect::<Vec<_>>()
        });
        let more: Vec<TokenStream> = more.collect();
        let documentation =
            DocComment::new("Adds the rows and columns of the joints that follow each coordinate.");
        let documentation = documentation.tokens();
        let allowed = quote!(#[allow(clippy::needless_range_loop, reason = "one index for all rows")]);
        self.context.shared.add("project", |name| {
            quote! {
                #documentation
                #allowed
                fn #name<const W: usize>(from: &[[#ty; #joints]; #rows], to: &mut [[#ty; W]; #count]) {
                    let mut rows = *from;
                    for j in 0..#joints { #(#more)* }
                    for (from, result) in rows.iter().zip(to) {
                        let mut to = [#zero; #coordinates];
                        #(#sums)*
                        result.copy_from_slice(to.split_at(W).0);
                    }
                }
            }
        })
    }

    pub(super) fn spread(&self) -> Ident {
        let of_joints = self.form.coordinates.iter().flat_map(|coordinates| &coordinates.of_joints);
        let sources: Vec<_> = of_joints.copied().map(Some).collect();
        let lengths = [self.row.coordinates, self.row.len];
        self.gather("spread", "Copies the values of coordinates to their joints.", lengths, &sources)
    }

    pub(super) fn gather_carriers(&self) -> Ident {
        let about = "Copies the values of carriers to their joints; zero if the carrier is the base.";
        self.gather("gather_carriers", about, [self.row.len; 2], &self.form.carriers())
    }

    pub(super) fn gather_last(&self) -> Ident {
        let sources: Vec<_> = self.form.last().into_iter().map(Some).collect();
        let about = "Copies the value of a joint's last velocity to its other velocities.";
        self.gather("gather_last", about, [self.row.len; 2], &sources)
    }

    /// Adds a private function that copies entries of rows, and returns its name. Entries without a source,
    /// and padding, become zero.
    fn gather(
        &self,
        stem: &str,
        about: &str,
        [read, length]: [usize; 2],
        sources: &[Option<usize>],
    ) -> Ident {
        let (ty, zero) = (self.context.ty(), self.context.zero());
        let padding = std::iter::repeat(&None);
        let copies = sources.iter().chain(padding).take(length).enumerate().map(|(place, source)| {
            let place = Literal::usize_unsuffixed(place);
            match source.map(Literal::usize_unsuffixed) {
                Some(source) => quote!(to[#place] = from[#source];),
                None => quote!(to[#place] = #zero;),
            }
        });
        let copies: Vec<TokenStream> = copies.collect();
        let [read, written] = [read, length].map(Literal::usize_unsuffixed);
        let documentation = DocComment::new(about).tokens();
        self.context.shared.add(stem, |name| {
            quote! {
                #documentation
                fn #name<const R: usize>(from: &[[#ty; #read]; R], to: &mut [[#ty; #written]; R]) {
                    for (from, to) in from.iter().zip(to) { #(#copies)* }
                }
            }
        })
    }

    /// Lengths of rows over joints and over coordinates, including padding.
    fn lengths(&self) -> [Literal; 2] {
        [self.row.len, self.row.coordinates].map(Literal::usize_unsuffixed)
    }

    pub(super) fn sum_ancestors(&self) -> Ident {
        let sums = self.form.joints.order.iter().map(|&joint| {
            let index = Literal::usize_unsuffixed(joint);
            match self.form.joints.parents[joint] {
                Some(parent) => {
                    let parent = Literal::usize_unsuffixed(parent);
                    quote!(to[#index] = from[#index] + to[#parent];)
                }
                None => quote!(to[#index] = from[#index];),
            }
        });
        // Rows of one block have their own variables, whose padding is zero.
        let padding = (self.form.joints.len()..self.row.len).filter(|_| !self.row.is_one_block());
        let padding = padding.map(|index| {
            let index = Literal::usize_unsuffixed(index);
            quote!(to[#index] = from[#index];)
        });
        self.sums(
            "sum_ancestors",
            "Sums along the path of each joint to the base.",
            &sums.chain(padding).collect::<Vec<_>>(),
        )
    }

    pub(super) fn sum_subtrees(&self) -> Ident {
        let sums = self.form.joints.order.iter().rev().filter_map(|&joint| {
            let parent = Literal::usize_unsuffixed(self.form.joints.parents[joint]?);
            let index = Literal::usize_unsuffixed(joint);
            Some(quote!(to[#parent] += to[#index];))
        });
        let copy = std::iter::once(quote!(*to = *from;));
        self.sums(
            "sum_subtrees",
            "Sums over the subtree of each joint.",
            &copy.chain(sums).collect::<Vec<_>>(),
        )
    }

    fn sums(&self, name: &str, about: &str, statements: &[TokenStream]) -> Ident {
        let (ty, lanes) = (self.context.ty(), Literal::usize_unsuffixed(self.row.len));
        let documentation = DocComment::new(about).tokens();
        self.context.shared.add(name, |name| {
            quote! {
                #documentation
                fn #name<const R: usize>(from: &[[#ty; #lanes]; R], to: &mut [[#ty; #lanes]; R]) {
                    for (from, to) in from.iter().zip(to) { #(#statements)* }
                }
            }
        })
    }
}
