//! Page with the results of all experiments. It begins with the claims.

use crate::equations;
use crate::study::{Outcome, Part, Study};
use gelenk_report::{Block, Claim, Report, Section, text};

/// Command of the full run.
pub const COMMAND: &str = "cargo run --release -p gelenk-runtime --example powercube";

/// Returns the report with all parts, in the order of their claims.
pub fn report(study: &Study, mut parts: Vec<Part>) -> Outcome<Report> {
    parts.sort_by_key(|part| part.claims.iter().map(number).min());
    let mut claims = Vec::new();
    let mut sections = Vec::new();
    for part in parts {
        claims.extend(part.claims);
        sections.push(part.section);
    }
    claims.sort_by_key(number);
    for claim in &mut claims {
        claim.statement = format!("{}. {}", label(claim), claim.statement);
    }
    let report = Report::new("Friction models for the MPC of a PowerCube, reproduced")
        .lead("The claims of J. Fehr, A. Kargl and H. Eschmann, “Identification of Friction Models for MPC-based Control of a PowerCube Serial Robot”, tried on the simulated arm: from its equations, with plants and controllers that do not share a model where model error is the matter.")
        .fact("Robot", "Schunk PowerCube, joints β and γ")
        .fact("Trajectory", "published, 1220 samples, 20 ms")
        .fact("Randomness", "seeded: every run gives the same numbers, measured times apart")
        .fact("Form", study.pick("full", "short: fewer samples and seeds"))
        .section(
            Section::new("claims", "The claims")
                .block(text("Each verdict follows from numbers and thresholds in the program; each names what would flip it, and a test flips it. Everything is simulated: “holds” means here, with these plants."))
                .block(Block::Claims(claims)),
        )
        .section(equations::section()?);
    let mut report = sections.into_iter().fold(report, Report::section);
    report.made_by = study.pick(COMMAND.to_owned(), format!("GELENK_EXAMPLE_SHORT=1 {COMMAND}"));
    Ok(report)
}

/// Label of a claim, for example `8b` for the identifier `claim-8b`.
fn label(claim: &Claim) -> &str {
    claim.id.strip_prefix("claim-").unwrap_or(&claim.id)
}

/// Sorting key of a claim: its number in the paper and its letter.
fn number(claim: &Claim) -> (u32, String) {
    let label = label(claim);
    let end = label.find(|c: char| !c.is_ascii_digit()).unwrap_or(label.len());
    let (digits, rest) = label.split_at(end);
    (digits.parse().unwrap_or(u32::MAX), rest.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn claims_stand_in_the_order_of_their_numbers() {
        let part = |section: &str, ids: &[&str]| Part {
            section: Section::new(section, section),
            claims: ids.iter().map(|id| Claim::new(*id, "It holds.")).collect(),
        };
        let study = Study { is_short: true };
        let parts = vec![part("a", &["claim-10", "claim-2"]), part("b", &["claim-8b", "claim-8a"])];
        let report = report(&study, parts).unwrap();
        let statements: Vec<&str> = report.claims().map(|one| one.statement.as_str()).collect();
        let expected = ["2. It holds.", "8a. It holds.", "8b. It holds.", "10. It holds."];
        assert_eq!(statements, expected);
        let sections: Vec<&str> = report.sections.iter().map(|one| one.id.as_str()).collect();
        assert_eq!(sections, ["claims", "equations", "a", "b"]);
    }
}
