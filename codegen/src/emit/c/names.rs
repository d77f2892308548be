//! Converts names of descriptions and programs to identifiers of C99 and C++.

use crate::emit::names::Spelling;

/// Keywords of C99, C11, C23 and C++, and names that common headers and compilers define as macros.
const KEYWORDS: [&str; 159] = [
    "BUFSIZ",
    "CHAR_BIT",
    "EOF",
    "FLT_EVAL_METHOD",
    "FLT_RADIX",
    "FP_FAST_FMA",
    "FP_FAST_FMAF",
    "HUGE_VAL",
    "HUGE_VALF",
    "I",
    "INFINITY",
    "INT_MAX",
    "INT_MIN",
    "M_1_PI",
    "M_2_PI",
    "M_2_SQRTPI",
    "M_E",
    "M_LN10",
    "M_LN2",
    "M_LOG10E",
    "M_LOG2E",
    "M_PI",
    "M_PI_2",
    "M_PI_4",
    "M_SQRT1_2",
    "M_SQRT2",
    "NAN",
    "NULL",
    "OVERFLOW",
    "RAND_MAX",
    "SIZE_MAX",
    "UINT64_C",
    "UINT64_MAX",
    "UNDERFLOW",
    "alignas",
    "alignof",
    "and",
    "and_eq",
    "asm",
    "assert",
    "auto",
    "bitand",
    "bitor",
    "bool",
    "break",
    "case",
    "catch",
    "char",
    "char16_t",
    "char32_t",
    "char8_t",
    "class",
    "co_await",
    "co_return",
    "co_yield",
    "compl",
    "complex",
    "concept",
    "const",
    "const_cast",
    "consteval",
    "constexpr",
    "constinit",
    "continue",
    "copysign",
    "copysignf",
    "decltype",
    "default",
    "delete",
    "do",
    "double",
    "dynamic_cast",
    "else",
    "enum",
    "errno",
    "explicit",
    "export",
    "extern",
    "fabs",
    "fabsf",
    "false",
    "far",
    "final",
    "float",
    "fma",
    "fmaf",
    "for",
    "fpclassify",
    "friend",
    "goto",
    "i386",
    "if",
    "import",
    "inline",
    "int",
    "isfinite",
    "isinf",
    "isnan",
    "isnormal",
    "linux",
    "long",
    "main",
    "memcpy",
    "module",
    "mutable",
    "namespace",
    "near",
    "new",
    "noexcept",
    "not",
    "not_eq",
    "nullptr",
    "operator",
    "or",
    "or_eq",
    "override",
    "private",
    "protected",
    "public",
    "register",
    "reinterpret_cast",
    "requires",
    "restrict",
    "return",
    "short",
    "signbit",
    "signed",
    "size_t",
    "sizeof",
    "static",
    "static_assert",
    "static_cast",
    "struct",
    "sun",
    "switch",
    "template",
    "this",
    "thread_local",
    "throw",
    "true",
    "try",
    "typedef",
    "typeid",
    "typename",
    "typeof",
    "typeof_unqual",
    "uint64_t",
    "union",
    "unix",
    "unsigned",
    "using",
    "virtual",
    "vms",
    "void",
    "volatile",
    "wchar_t",
    "while",
    "xor",
    "xor_eq",
];

/// Rules for names of values, fields and functions in C. Such a name must not begin with one of the given
/// prefixes, because names of the module itself begin with them.
pub(super) fn spelling(prefixes: Vec<String>) -> Spelling {
    Spelling { keywords: &KEYWORDS, has_free_underscores: false, prefixes }
}

/// Prefix of a module's names in C without the underscore after it, made from the name of the module's files.
pub(super) fn prefix(name: &str) -> String {
    spelling(vec![]).identifier(name).trim_end_matches('_').to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keywords_are_sorted_for_the_binary_search() {
        assert!(KEYWORDS.is_sorted());
    }

    #[test]
    fn strange_names_become_identifiers() {
        let spelling = spelling(vec!["arm_".to_owned()]);
        let cases = [
            ("y_1", "y_1"),
            ("ω_1", "omega_1"),
            ("restrict", "restrict_"),
            ("class", "class_"),
            ("linux", "linux_"),
            ("_Bool", "x_Bool"),
            ("__FILE__", "x_FILE_"),
            ("a__b", "a_b"),
            ("arm_step", "x_arm_step"),
            ("2x", "x2x"),
            ("", "x"),
            ("a\"; abort(); //", "a_abort_"),
        ];
        for (name, expected) in cases {
            assert_eq!(spelling.identifier(name), expected, "{name:?}");
        }
    }

    #[test]
    fn names_of_modules_are_prefixes() {
        assert_eq!(prefix("double"), "double");
        assert_eq!(prefix("my-arm.v2"), "my_arm_v2");
    }
}
