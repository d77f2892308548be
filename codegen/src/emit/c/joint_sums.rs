//! Prints functions that sum over joints: along paths to the base, over subtrees, and over the joints of a
//! coordinate.

use super::arrays::Emission;
use super::{layout, signature};
use crate::emit::arrays::followers;

impl Emission<'_> {
    pub(super) fn sum_ancestors(&self) -> String {
        let sums = self.form.joints.order.iter().map(|&joint| match self.form.joints.parents[joint] {
            Some(parent) => format!("to[{joint}] = from[{joint}] + to[{parent}];"),
            None => format!("to[{joint}] = from[{joint}];"),
        });
        // Padding is read together with the rows, so it must be set. Otherwise it could contain subnormal
        // numbers, which are slow.
        let zero = self.context.literal(0.0);
        let padding = (self.form.joints.len()..self.row.len).map(|entry| format!("to[{entry}] = {zero};"));
        let sums: Vec<String> = sums.chain(padding).collect();
        self.sum_function("sum_ancestors", "Sums along the path of each joint to the base.", &sums)
    }

    pub(super) fn sum_subtrees(&self) -> String {
        let sums = self.form.joints.order.iter().rev().filter_map(|&joint| {
            let parent = self.form.joints.parents[joint]?;
            Some(format!("to[{parent}] += to[{joint}];"))
        });
        let copy = format!("memcpy(to, from, {} * sizeof *to);", self.row.len);
        let sums: Vec<String> = std::iter::once(copy).chain(sums).collect();
        self.sum_function("sum_subtrees", "Sums over the subtree of each joint.", &sums)
    }

    /// Statements that sum a row with an entry per joint to a row with an entry per coordinate.
    fn collected(&self) -> Vec<String> {
        let joints = followers(self.form).into_iter().enumerate();
        let sum = |(coordinate, joints): (usize, Vec<usize>)| {
            let terms: Vec<String> = joints.iter().map(|joint| format!("from[{joint}]")).collect();
            format!("to[{coordinate}] = {};", terms.join(" + "))
        };
        joints.map(sum).collect()
    }

    pub(super) fn collect(&self) -> String {
        let lengths = [self.row.len, self.row.coordinates];
        self.function("collect", "Adds the joints that follow each coordinate.", lengths, &self.collected())
    }

    pub(super) fn spread(&self) -> String {
        let of_joints = self.form.coordinates.iter().flat_map(|coordinates| &coordinates.of_joints);
        let sources: Vec<_> = of_joints.copied().map(Some).collect();
        let lengths = [self.row.coordinates, self.row.len];
        self.gather("spread", "Copies the values of coordinates to their joints.", lengths, &sources)
    }

    pub(super) fn gather_carriers(&self) -> String {
        let about = "Copies the values of carriers to their joints; zero if the carrier is the base.";
        self.gather("gather_carriers", about, [self.row.len; 2], &self.form.carriers())
    }

    pub(super) fn gather_last(&self) -> String {
        let sources: Vec<_> = self.form.last().into_iter().map(Some).collect();
        let about = "Copies the value of a joint's last velocity to its other velocities.";
        self.gather("gather_last", about, [self.row.len; 2], &sources)
    }

    /// Adds a private function that copies entries of rows, and returns its name. Entries without a source
    /// stay zero.
    fn gather(&self, stem: &str, about: &str, lengths: [usize; 2], sources: &[Option<usize>]) -> String {
        let copies = sources.iter().enumerate();
        let copies = copies.filter_map(|(place, &source)| Some(format!("to[{place}] = from[{}];", source?)));
        let copies: Vec<String> = copies.collect();
        self.function(stem, about, lengths, &copies)
    }

    pub(super) fn project(&self) -> String {
        let (context, ty, joints) = (self.context, self.context.ty(), self.row.len);
        let followers = followers(self.form).into_iter().enumerate();
        let rows = followers.map(|(coordinate, rows)| {
            let terms: Vec<String> = rows.iter().map(|row| format!("matrix[{} + j]", row * joints)).collect();
            format!("rows[{} + j] = {};", coordinate * joints, terms.join(" + "))
        });
        let rows: String = rows.map(|row| layout::indented(&row)).collect();
        let count = self.form.coordinates().len();
        let sums: String = self.collected().iter().map(|sum| layout::indented(sum)).collect();
        let statements = [
            format!("{ty} rows[{}];", count * joints),
            format!("for (int j = 0; j < {joints}; ++j) {{\n{rows}}}"),
            format!("const {ty} *from = rows;"),
            format!("for (int i = 0; i < {count}; ++i, from += {joints}, to += width) {{\n{sums}}}"),
        ];
        self.context.shared.add(&self.context.function("project"), |name| {
            let arguments = [
                signature::read(context, "matrix"),
                "int width".to_owned(),
                signature::written(context, "to"),
            ];
            let head =
                layout::call(0, &format!("{} void {name}", context.constant("INLINE")), &arguments, "");
            let about = "// Adds the rows and columns of the joints that follow each coordinate.";
            format!("{about}\n{}", layout::function(&head, &statements))
        })
    }

    fn sum_function(&self, stem: &str, about: &str, sums: &[String]) -> String {
        self.function(stem, about, [self.row.len; 2], sums)
    }

    /// Adds a private function that applies statements to each row, and returns its name.
    ///
    /// - `lengths`: length of a row that is read, and of a row that is written, including padding
    fn function(&self, stem: &str, about: &str, [from, to]: [usize; 2], sums: &[String]) -> String {
        let context = self.context;
        self.context.shared.add(&self.context.function(stem), |name| {
            let arguments =
                ["int rows".to_owned(), signature::read(context, "from"), signature::written(context, "to")];
            let head =
                layout::call(0, &format!("{} void {name}", context.constant("INLINE")), &arguments, "");
            let sums: String = sums.iter().map(|sum| layout::indented(sum)).collect();
            let each = format!("for (; rows > 0; --rows, from += {from}, to += {to}) {{\n{sums}}}");
            format!("// {about}\n{}", layout::function(&head, &[each]))
        })
    }
}
