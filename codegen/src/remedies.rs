//! Remedies by code, for diagnostics whose finder gives none.

/// The advice for problems with this code.
pub(crate) fn remedy(code: &str) -> Option<&'static str> {
    Some(match code {
        "number-not-finite" => "give a finite number, or leave the limit out",
        "number-too-large" => "numbers are in m, kg, s and rad: check unit and exponent",
        "toml-syntax" => {
            "text needs quotes, a list [ ], a table in { }, and commas separate entries: check this line and the one before it"
        }
        "xml-syntax" => {
            "each tag that is opened is closed by its own name, and values of attributes need quotes"
        }
        "axis-not-unit" => "give a direction: numbers that are not all 0",
        "formula-syntax" => {
            "a formula has numbers, names, + - * /, parentheses and calls such as sin(y), no braces and no semicolons"
        }
        "formula-too-deep" => {
            "write it with fewer brackets within brackets, or name a part of it as a parameter"
        }
        "formula-kind" => {
            "comparisons such as v > 0 are truth values; && and || join them, + - * / join numbers"
        }
        "unknown-function" => "commas separate the arguments of a function, and decimals follow a point",
        "negative-friction" => "friction that brakes has a positive coefficient: change the sign",
        "missing-attribute" => "add the attribute: it has no default",
        "missing-element" => "add the element: it has no default",
        "duplicate-name" => "give each its own name",
        "not-a-number" => "spaces separate numbers, and decimals follow a point: \"0 0 0.5\"",
        "not-a-word" => "leave the attribute out for its default",
        "geom-size" => {
            "a sphere has its radius, a capsule or cylinder radius and half its length, a box or ellipsoid half of its three lengths"
        }
        "unusable-name" => "a name is one line of text that is not empty",
        "not-positive" => "give a number greater than 0, or leave it out if nothing is limited",
        "too-many-problems" => "correct those that are shown first: others often follow from them",
        _ => return None,
    })
}
