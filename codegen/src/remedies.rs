//! Help texts for diagnostics without a help text, by the code of the diagnostic.

/// Help text for the diagnostic with this code; `None` if the code has no text.
pub(crate) fn remedy(code: &str) -> Option<&'static str> {
    Some(match code {
        "number-not-finite" => "give a finite number, or remove the entry",
        "number-too-large" => "values are in m, kg, s and rad: check unit and exponent",
        "toml-syntax" => {
            "check this line and the line before: text needs quotes, lists need [ ], tables need { }, and \
             commas separate entries"
        }
        "xml-syntax" => "each opening tag needs a closing tag of the same name; attribute values need quotes",
        "axis-not-unit" => "give a direction with at least one non-zero number",
        "formula-syntax" => {
            "a formula consists of numbers, names, + - * /, parentheses and calls such as sin(y); braces \
             and semicolons are not allowed"
        }
        "formula-too-deep" => "use fewer nested brackets, or define a part of the formula as a parameter",
        "formula-kind" => {
            "comparisons such as v > 0 are truth values: combine them with && and ||, and use + - * / for numbers"
        }
        "unknown-function" => "separate arguments with commas; write decimals with a point",
        "negative-friction" => "friction that brakes has a positive coefficient: change the sign",
        "missing-attribute" => "add the attribute: it has no default",
        "missing-element" => "add the element: it has no default",
        "duplicate-name" => "use different names",
        "not-a-number" => "separate numbers with spaces and write decimals with a point: \"0 0 0.5\"",
        "not-a-word" => "remove the attribute to use its default",
        "geom-size" => {
            "a sphere needs its radius, a capsule or cylinder its radius and half length, a box or \
             ellipsoid its three half lengths"
        }
        "unusable-name" => "give a non-empty name on one line",
        "not-positive" => "give a number greater than 0, or remove the limit",
        "too-many-problems" => "correct the first problems first: later ones often follow from them",
        _ => return None,
    })
}
