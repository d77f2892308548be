//! Names of joints and inputs in messages.

use core::fmt;

/// Largest number of digits of a number.
const WIDTH: usize = 20;

/// The names "1", "2", …, which the compiler computes for each length.
struct Numbers<const L: usize>;

impl<const L: usize> Numbers<L> {
    const DIGITS: [[u8; WIDTH]; L] = {
        let mut all = [[0; WIDTH]; L];
        let mut i = 0;
        while i < L {
            let (mut rest, mut place) = (i + 1, WIDTH);
            while rest > 0 {
                place -= 1;
                all[i][place] = b'0' + (rest % 10) as u8;
                rest /= 10;
            }
            i += 1;
        }
        all
    };

    const NAMES: [&'static str; L] = {
        let digits: &'static [[u8; WIDTH]; L] = &Self::DIGITS;
        let mut names = [""; L];
        let mut i = 0;
        while i < L {
            let mut text: &'static [u8] = &digits[i];
            while let [0, rest @ ..] = text {
                text = rest;
            }
            names[i] = match str::from_utf8(text) {
                Ok(name) => name,
                Err(_) => panic!("digits are ASCII"),
            };
            i += 1;
        }
        names
    };
}

/// Returns "1", "2", … as names of joints or inputs without names.
pub fn numbered<const L: usize>() -> [&'static str; L] {
    Numbers::<L>::NAMES
}

/// Returns the names of the velocities as names of the positions. Does not compile for robots with
/// quaternions.
pub(super) fn names_of_arms<'a, const N: usize, const NY: usize>(
    names: &'a [&'static str; N],
) -> &'a [&'static str; NY] {
    const { assert!(N == NY, "a robot with quaternions must name its positions") }
    names.first_chunk().unwrap_or(const { &[""; NY] })
}

/// Displays a name in a message. A single word is written unchanged. Other names are quoted and escaped, because names come from
/// descriptions and can contain any characters.
pub struct Named<'a>(pub &'a str);

impl fmt::Display for Named<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let word = |c: char| c.is_alphanumeric() || "_-./".contains(c);
        if !self.0.is_empty() && self.0.chars().all(word) {
            f.write_str(self.0)
        } else {
            write!(f, "{:?}", self.0)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_has_no_name_is_numbered_from_1() {
        let names = numbered::<120>();
        assert_eq!((names[0], names[8], names[9]), ("1", "9", "10"));
        assert_eq!((names[99], names[119]), ("100", "120"));
        assert_eq!(numbered::<0>(), [""; 0]);
    }

    #[test]
    fn names_that_are_no_words_are_quoted() {
        let shown = |name: &str| Named(name).to_string();
        assert_eq!(shown("joint_a1"), "joint_a1");
        assert_eq!(shown("größe.1"), "größe.1");
        assert_eq!(shown("left arm, upper"), r#""left arm, upper""#);
        assert_eq!(shown("a\"b\n"), r#""a\"b\n""#);
        assert_eq!(shown(""), r#""""#);
    }
}
