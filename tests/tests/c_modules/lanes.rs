//! Functions over eight states of a module in C, compared with the function of one state.

use std::fmt::Write as _;

/// How a function over several states is called.
pub struct Lanes {
    /// The function of one state.
    pub function: String,
    /// Entries of its inputs.
    pub inputs: Vec<usize>,
    /// Entries of its results.
    pub results: Vec<usize>,
    /// It is true if its result is a number, which it returns.
    pub is_number: bool,
    pub has_parameters: bool,
}

impl Lanes {
    /// A function in C that ends the program where states of many have other bits than states alone. What is asked for
    /// stands in `x`; the other states hold its numbers in other places.
    pub fn check(&self, name: &str, prefix: &str, ty: &str) -> String {
        let total: usize = self.inputs.iter().sum();
        let results: usize = self.results.iter().sum();
        let (declared, passed) = match self.has_parameters {
            true => (format!(", const {prefix}_parameters *p"), Some("p".to_owned())),
            false => (String::new(), None),
        };
        let places = |lengths: &[usize], at: &dyn Fn(usize, usize) -> String| -> Vec<String> {
            let mut start = 0;
            let places = lengths.iter().map(|&len| {
                start += len;
                at(start - len, len)
            });
            places.collect()
        };
        let fill = places(&self.inputs, &|start, len| {
            format!(
                "for (int e = 0; e < {len}; ++e) in[{} + s * {len} + e] = x[({start} + e + s) % {total}];",
                8 * start
            )
        });
        let many = [
            places(&self.inputs, &|start, _| format!("&in[{}]", 8 * start)),
            passed.clone().into_iter().collect(),
            places(&self.results, &|start, _| format!("&many[{}]", 8 * start)),
        ];
        let arguments = places(&self.inputs, &|start, len| format!("&in[{} + s * {len}]", 8 * start));
        let arguments = arguments.into_iter().chain(passed);
        let single = match self.is_number {
            true => format!("one[0] = {}({});", self.function, arguments.collect::<Vec<_>>().join(", ")),
            false => {
                let results = places(&self.results, &|start, _| format!("&one[{start}]"));
                format!("{}({});", self.function, arguments.chain(results).collect::<Vec<_>>().join(", "))
            }
        };
        let compare = places(&self.results, &|start, len| {
            format!("same(\"{}\", &many[{} + s * {len}], &one[{start}], {len});", self.function, 8 * start)
        });
        let mut text = String::new();
        let _ = writeln!(
            text,
            "static void {name}(const {ty} *x{declared})\n{{\n    static {ty} in[{}], many[{}], one[{results}];\n    \
             memset(many, 0xff, sizeof many);\n    for (int s = 0; s < 8; ++s) {{ {} }}\n    {}_lanes({});\n    \
             for (int s = 0; s < 8; ++s) {{ {single} {} }}\n}}",
            8 * total,
            8 * results,
            fill.join(" "),
            self.function,
            many.concat().join(", "),
            compare.join(" "),
        );
        text
    }
}

/// Comparison that all checks call: IEEE 754 leaves sign and payload of a NaN open, all other values must
/// agree in every bit.
pub fn same(ty: &str) -> String {
    format!(
        "static void same(const char *name, const {ty} *a, const {ty} *b, int count)\n{{\n    \
         for (int i = 0; i < count; ++i) {{\n        \
         if (memcmp(&a[i], &b[i], sizeof *a) != 0 && (a[i] == a[i] || b[i] == b[i])) {{\n            \
         fprintf(stderr, \"%s_lanes: entry %d is %.17g, alone %.17g\\n\", name, i, (double)a[i], (double)b[i]);\n            \
         exit(1);\n        }}\n    }}\n}}\n"
    )
}
