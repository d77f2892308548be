//! Reasons for which a search finds no motion.

/// Why no motion was found, and what helps.
///
/// - `at_rest`: what already stands in the way of standing still
pub(super) fn refused(at_rest: &[String]) -> String {
    if at_rest.is_empty() {
        return "no motion tried, down to a tenth of the size that the limits allow, shows all parameters within the efforts of joints and \
                inputs, and within the limits of joints that follow others: raise the efforts, lower the speed, lengthen the period, or \
                narrow the limits of the joints that are followed"
            .into();
    }
    format!(
        "standing still in the middle of the positions already needs more than the share that a plan may use of {}: raise the \
         efforts or the share, or narrow the limits to positions that need less",
        at_rest.join(", ")
    )
}
