//! Name patterns of joints that are held at a position.

/// A name pattern of joints that are held, and the position at which they are held.
#[derive(Debug, Clone, PartialEq)]
pub struct Hold {
    /// Name pattern, in which `*` matches any text.
    pub pattern: String,
    /// Position at which the joints are held (rad or m).
    pub position: f64,
}

impl Hold {
    /// Reads `PATTERN[=VALUE]`. Without a value the position is 0.
    ///
    /// # Errors
    /// A message if the value is not a finite number.
    pub fn parse(text: &str) -> Result<Self, String> {
        let (pattern, value) = text.rsplit_once('=').unwrap_or((text, "0"));
        let value = value.trim().parse().ok().filter(|value: &f64| value.is_finite());
        let position = value.ok_or("the value must be a finite number (rad or m)")?;
        Ok(Self { pattern: pattern.trim().to_owned(), position })
    }

    /// Whether a joint's name matches the pattern.
    #[must_use]
    pub fn matches(&self, name: &str) -> bool {
        let mut parts = self.pattern.split('*');
        let Some(rest) = name.strip_prefix(parts.next().unwrap_or_default()) else { return false };
        let Some(last) = parts.next_back() else { return rest.is_empty() };
        let Some(mut rest) = rest.strip_suffix(last) else { return false };
        parts.all(|part| rest.split_once(part).map(|(_, after)| rest = after).is_some())
    }

    /// The pattern with its position, in the form `PATTERN=VALUE` that [`Self::parse`] reads.
    #[must_use]
    pub fn text(&self) -> String {
        match self.position {
            0.0 => self.pattern.clone(),
            position => format!("{}={position:?}", self.pattern),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Hold;

    #[test]
    fn stars_stand_for_any_text() {
        let matches = |pattern: &str, name: &str| Hold::parse(pattern).is_ok_and(|hold| hold.matches(name));
        assert!(matches("finger", "finger") && !matches("finger", "finger_1"));
        assert!(matches("*", "") && matches("a*b*c=1", "a_b_c") && !matches("a*b*c", "a_c"));
        assert!(!matches("ab*ba", "aba") && matches("*_joint", "left_joint"));
    }

    #[test]
    fn values_are_numbers() {
        assert_eq!(Hold::parse("a = -0.5").map(|hold| hold.text()), Ok("a=-0.5".to_owned()));
        assert!(Hold::parse("a=b").is_err() && Hold::parse("a=inf").is_err());
    }
}
