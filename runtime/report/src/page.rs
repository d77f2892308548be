//! The HTML page, which loads no other file.

use maud::{DOCTYPE, Markup, PreEscaped, html};

use super::block::{Block, Section};
use super::claim::{Claim, Criterion, Verdict};
use super::equation::Equation;
use super::error::ReportError;
use super::inline::{Inline, inlines};
use super::pattern::Pattern;
use super::plot::{Figure, Plot};
use super::report::Report;
use super::scene::{Scene, SceneJoint, SceneSymbol};
use super::style::STYLE;
use super::table::{Cell, Table};
use super::{diagram, equation, number, pattern, plot};

/// Script of the 3-D view, which uses no library.
const SCRIPT: &str = include_str!("scene.js");
/// Content security policy. It prevents the browser from loading anything.
const POLICY: &str =
    "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; img-src data:";

type Rendered = Result<Markup, ReportError>;

pub(super) fn html(report: &Report) -> Result<String, ReportError> {
    let sections = joined(report.sections.iter().map(section))?;
    let has_scene =
        report.sections.iter().flat_map(Section::all_blocks).any(|block| matches!(block, Block::Scene(_)));
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta http-equiv="Content-Security-Policy" content=(POLICY);
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="color-scheme" content="light dark";
                title { (report.title) }
                style { (PreEscaped(STYLE)) }
            }
            body {
                a.skip href="#content" { "Skip to the content" }
                (contents(report))
                main id="content" {
                    (head(report)?)
                    (sections)
                    (foot(report))
                }
                @if has_scene {
                    script { (PreEscaped(SCRIPT)) }
                }
            }
        }
    };
    Ok(page.into_string())
}

fn joined(parts: impl Iterator<Item = Rendered>) -> Rendered {
    let parts = parts.collect::<Result<Vec<_>, _>>()?;
    Ok(html! { @for part in &parts { (part) "\n" } })
}

fn contents(report: &Report) -> Markup {
    html! {
        nav.contents aria-label="Contents" {
            ol {
                @for section in &report.sections {
                    li { a href=(format!("#{}", section.id)) { (section.title) } }
                }
            }
        }
    }
}

fn head(report: &Report) -> Rendered {
    Ok(html! {
        header {
            h1 { (report.title) }
            @if !report.lead.is_empty() {
                p.lead { (line(&report.lead)?) }
            }
            @if !report.facts.is_empty() {
                dl.facts {
                    @for (name, value) in &report.facts {
                        div { dt { (name) } dd { (value) } }
                    }
                }
            }
        }
    })
}

/// Link to the data of a page.
const DATA: &str = "<a href=\"report.json\">report.json</a>";

/// Whether a text is the page of a report. The test does not depend on the wording, so pages of other
/// versions are recognized.
pub(super) fn is_page(text: &[u8]) -> bool {
    [POLICY, DATA].iter().all(|part| text.windows(part.len()).any(|window| window == part.as_bytes()))
}

fn foot(report: &Report) -> Markup {
    html! {
        footer {
            p {
                "The same numbers, unrounded, are next to this page in "
                (PreEscaped(DATA))
                " and in one CSV file for each table and figure."
            }
            @if !report.made_by.is_empty() {
                p { "Made by " code { (report.made_by) } }
            }
        }
    }
}

fn section(section: &Section) -> Rendered {
    let blocks = joined(section.blocks.iter().map(block))?;
    Ok(html! {
        section id=(section.id) {
            h2 { a.anchor href=(format!("#{}", section.id)) { (section.title) } }
            (blocks)
        }
    })
}

fn block(block: &Block) -> Rendered {
    match block {
        Block::Text(parts) => Ok(html! { p { (line(parts)?) } }),
        Block::Heading(parts) => Ok(html! { h3 { (line(parts)?) } }),
        Block::Equations(equations) => Ok(equation_list(equations, "equations", None)),
        Block::Abbreviations(equations) => {
            let widest = equations.iter().map(Equation::width).max().unwrap_or(0);
            // Columns are as wide as the longest equation. Equations that are wider than the page can be scrolled.
            let style = format!("columns: {}em", widest.clamp(24, 90) / 2);
            Ok(equation_list(equations, "abbreviations", Some(style)))
        }
        Block::Table(table) => table_markup(table),
        Block::Claims(claims) => claims_markup(claims),
        Block::Figure(figure) => figure_markup(figure),
        Block::Patterns(patterns) => patterns_markup(patterns),
        Block::Tree(scene) => Ok(html! { div.wide.scrolls tabindex="0" { (diagram::tree(scene)) } }),
        Block::Scene(scene) => Ok(scene_markup(scene)),
        Block::Code(text) => Ok(html! { pre.wide tabindex="0" { (text) } }),
        Block::Details { summary, is_open, blocks } => {
            let inner = joined(blocks.iter().map(self::block))?;
            Ok(html! {
                details open[*is_open] {
                    summary { (line(summary)?) }
                    (inner)
                }
            })
        }
    }
}

fn line(parts: &[Inline]) -> Rendered {
    let part = |part: &Inline| match part {
        Inline::Text(text) => Ok(html! { (text) }),
        Inline::Code(text) => Ok(html! { code { (text) } }),
        Inline::Math(latex) => equation::inline(latex).map(PreEscaped),
    };
    let parts = parts.iter().map(part).collect::<Result<Vec<_>, _>>()?;
    Ok(html! { @for part in &parts { (part) } })
}

fn equation_list(equations: &[Equation], class: &str, style: Option<String>) -> Markup {
    html! {
        div.wide.(class) style=[style] tabindex="0" role="group" aria-label="Equations" {
            @for equation in equations {
                div { (PreEscaped(equation.mathml())) }
            }
        }
    }
}

fn table_markup(table: &Table) -> Rendered {
    let headings = table.columns.iter().enumerate();
    let headings = headings.map(|(index, column)| {
        let is_number = table.is_numeric(index);
        Ok(html! {
            th.number[is_number] scope="col" {
                (line(&column.heading)?)
                @if !column.unit.is_empty() { " " span.unit { "[" (column.unit) "]" } }
            }
        })
    });
    let headings = joined(headings)?;
    let rows = joined(table.rows.iter().map(|row| table_row(table, row)))?;
    let caption = format!("{}-caption", table.id);
    Ok(html! {
        @if !table.caption.is_empty() { p.caption id=(caption) { (line(&table.caption)?) } }
        div.wide.scrolls tabindex="0" {
            table id=(table.id) aria-labelledby=[(!table.caption.is_empty()).then_some(caption)] {
                thead { tr { (headings) } }
                tbody { (rows) }
            }
        }
    })
}

fn table_row(table: &Table, row: &[Cell]) -> Rendered {
    let cells = row.iter().enumerate().map(|(index, cell)| {
        let is_number = table.is_numeric(index);
        Ok(html! { td.number[is_number] { (cell_markup(cell)?) } })
    });
    Ok(html! { tr { (joined(cells)?) } })
}

fn cell_markup(cell: &Cell) -> Rendered {
    Ok(match cell {
        Cell::Empty => html! { span.none { "–" } },
        Cell::Text(text) => html! { (text) },
        Cell::Code(text) => html! { code { (text) } },
        Cell::Line(parts) => line(parts)?,
        Cell::Formula { latex, .. } => PreEscaped(equation::inline(latex)?),
        Cell::Rounded(value, digits) => html! { (number::rounded(*value, *digits)) },
        Cell::Exact(value) => html! { (number::exact(*value)) },
        Cell::Count(count) => html! { (count) },
    })
}

fn claims_markup(claims: &[Claim]) -> Rendered {
    let rows = joined(claims.iter().map(claim_row))?;
    Ok(html! {
        div.wide.scrolls tabindex="0" {
            table.claims {
                thead {
                    tr {
                        th scope="col" { "Statement" }
                        th scope="col" { "Measured" }
                        th scope="col" { "Verdict" }
                    }
                }
                tbody { (rows) }
            }
        }
    })
}

fn claim_row(claim: &Claim) -> Rendered {
    let statement = line(&inlines(&claim.statement))?;
    let remark = line(&inlines(&claim.remark))?;
    Ok(html! {
        tr id=(claim.id) {
            td {
                (statement)
                @if !claim.remark.is_empty() { p.remark { (remark) } }
                @if let Some(id) = &claim.shown_in {
                    p.remark { "Shown in " a href=(format!("#{id}")) { (id) } "." }
                }
            }
            td {
                ul.criteria { @for criterion in &claim.criteria { (criterion_markup(criterion)) } }
            }
            td { (verdict_markup(claim)) }
        }
    })
}

fn criterion_markup(criterion: &Criterion) -> Markup {
    html! {
        li.missed[!criterion.is_met()] {
            (criterion.name) ": "
            span.value { (criterion.measured()) } " "
            span.threshold { "(" (criterion.threshold()) ")" }
        }
    }
}

fn verdict_markup(claim: &Claim) -> Markup {
    let verdict = claim.verdict();
    let (class, sign) = match verdict {
        Verdict::Holds => ("holds", "✓"),
        Verdict::HoldsConditionally => ("conditional", "◐"),
        Verdict::DoesNotHold => ("fails", "✗"),
    };
    html! {
        span.verdict.(class) { span.sign aria-hidden="true" { (sign) } " " (verdict) }
        @if let Some(condition) = &claim.condition { p.remark { "Condition: " (condition) } }
        @if !claim.flipped_by.is_empty() { p.remark { "Would flip: " (claim.flipped_by) } }
    }
}

fn figure_markup(figure: &Figure) -> Rendered {
    let plots = joined(figure.plots.iter().map(|one| plot_markup(one, &figure.id)))?;
    Ok(html! {
        figure.wide id=(figure.id) {
            div.plots { (plots) }
            @if !figure.caption.is_empty() { figcaption { (line(&figure.caption)?) } }
        }
    })
}

fn patterns_markup(patterns: &[Pattern]) -> Rendered {
    let panels = patterns.iter().map(|one| {
        Ok(html! {
            div.pattern id=(one.id) {
                p.plot-title { (line(&one.title)?) }
                (pattern::svg(one))
                p.remark { (one.count()) " of " (one.size()) " entries" }
            }
        })
    });
    Ok(html! { div.wide.patterns { (joined(panels)?) } })
}

fn plot_markup(one: &Plot, id: &str) -> Rendered {
    let drawing = plot::svg(one, id)?;
    Ok(html! {
        div.panel {
            @if !one.title.is_empty() { p.plot-title { (one.title) } }
            div.scrolls tabindex="0" { (PreEscaped(drawing)) }
            @if one.series.len() > 1 || one.title.is_empty() {
                ul.legend {
                    @for (index, series) in one.series.iter().enumerate() {
                        li {
                            (legend_mark(index, series.marks))
                            (series.name)
                        }
                    }
                }
            }
        }
    })
}

fn legend_mark(index: usize, marks: plot::Marks) -> Markup {
    let colour = format!("var(--series-{})", index % plot::COLOURS + 1);
    html! {
        svg.key viewBox="0 0 26 10" aria-hidden="true" {
            @if marks == plot::Marks::Points {
                circle cx="13" cy="5" r="2.5" fill=(colour) {}
            } @else {
                line x1="1" y1="5" x2="25" y2="5" stroke=(colour) stroke-width="2"
                    stroke-dasharray=[(marks == plot::Marks::Dashed).then_some("7 4")] {}
            }
        }
    }
}

fn scene_markup(scene: &Scene) -> Markup {
    // Only a tag can end a script element, so `<` is escaped.
    let data = scene.json().to_string().replace('<', "\\u003c");
    let label = format!(
        "{} in three dimensions. Arrow keys turn the view, plus and minus zoom, 0 resets it.",
        scene.name
    );
    html! {
        figure.scene.wide {
            script.data type="application/json" { (PreEscaped(data)) }
            div.stage {
                canvas tabindex="0" role="img" aria-label=(label) {}
                div.views role="group" aria-label="View" {
                    button type="button" data-view="oblique" { "Oblique" }
                    button type="button" data-view="front" { "Front" }
                    button type="button" data-view="side" { "Side" }
                    button type="button" data-view="top" { "Top" }
                    button type="button" data-view="closer" aria-label="Closer" { "+" }
                    button type="button" data-view="farther" aria-label="Farther" { "−" }
                }
            }
            div.controls {
                @for (index, joint) in scene.coordinates().into_iter().enumerate() {
                    (slider(index, scene.symbol(index), joint))
                }
                button.home type="button" { "Reset all joints" }
                @if !scene.frames.is_empty() {
                    table.frames {
                        thead { tr { th scope="col" { "Frame" } th scope="col" { "Origin in the base frame [m]" } } }
                        tbody {
                            @for frame in &scene.frames {
                                tr { td { (frame.name) } td { output data-frame=(frame.name) {} } }
                            }
                        }
                    }
                }
            }
            figcaption {
                "Grey: links. Coloured: axes of the joints that move. "
                "The quartered disc marks the centre of mass, and its size grows with the mass; red, green and blue are the "
                "axes x, y, z of the base and of the named frames. Drag or use the arrow keys to turn the view, plus and minus to "
                "zoom, 0 to reset."
            }
            noscript { p { "Only this view needs scripts." } }
        }
    }
}

/// The slider of a joint. The sliders of a joint with a quaternion displace and rotate its body, and do not represent
/// coordinates.
fn slider(index: usize, symbol: SceneSymbol, joint: &SceneJoint) -> Markup {
    let [low, high] = joint.range();
    let letter = Some(symbol.letter()).filter(|_| !matches!(symbol, SceneSymbol::Velocity(_)));
    let label = letter.map_or(String::new(), |(letter, number)| format!("{letter}{number} "));
    html! {
        div.slider {
            span.joint-name {
                @if let Some((letter, number)) = letter {
                    i { (letter) } sub { (number) } " "
                }
                (joint.name)
            }
            output {}
            input type="range" aria-label=(format!("{label}{}", joint.name)) min=(low) max=(high) step="any" value=(joint.start()) data-coordinate=(index)
                data-start=(joint.start()) data-unit=(joint.unit());
        }
    }
}
