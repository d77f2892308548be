//! Drawing of the kinematic tree, with links in boxes and joints on the lines between them.

use maud::{Markup, html};

use super::number::rounded;
use super::scene::{Scene, SceneJoint, SceneKind, SceneMotion, SceneSymbol};

const BOX: (f64, f64) = (156.0, 34.0);
const ROW: f64 = 78.0;
const LANE: f64 = 290.0;
const MARGIN: f64 = 8.0;

/// A link in the drawing.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Place {
    /// Column of the link. If the link has several children, it can be between two columns.
    lane: f64,
    depth: f64,
}

/// The drawing as an `svg` element.
pub(super) fn tree(scene: &Scene) -> Markup {
    let children = children(scene);
    let (places, lanes) = places(&children);
    let depth = places.iter().fold(0.0, |most: f64, place| most.max(place.depth));
    let (width, height) = (lanes.max(1.0) * LANE + 2.0 * MARGIN, depth * ROW + BOX.1 + 2.0 * MARGIN);
    let label = format!(
        "Kinematic tree of {}: {} joints, {} of them move",
        scene.name,
        scene.joints.len(),
        scene.coordinates().len()
    );
    html! {
        svg.tree viewBox=(format!("0 0 {width} {height}")) style=(format!("width: {width}px")) role="img" aria-label=(label) {
            @for (joint, entry) in scene.joints.iter().enumerate() {
                (edge(scene, entry, places[node(entry.parent)], places[joint + 1]))
            }
            (link(&scene.base, mass(scene, None), places[0]))
            @for (joint, entry) in scene.joints.iter().enumerate() {
                (link(&entry.link, mass(scene, Some(joint)), places[joint + 1]))
            }
        }
    }
}

/// Index of the link that a joint carries. The base has the index 0.
fn node(joint: Option<usize>) -> usize {
    joint.map_or(0, |joint| joint + 1)
}

fn children(scene: &Scene) -> Vec<Vec<usize>> {
    let mut children = vec![Vec::new(); scene.joints.len() + 1];
    for (joint, entry) in scene.joints.iter().enumerate() {
        if let Some(siblings) = children.get_mut(node(entry.parent)) {
            siblings.push(joint + 1);
        }
    }
    children
}

/// Places of the links. Leaves of the tree take columns from the left. Other links are above the middle of
/// their children.
fn places(children: &[Vec<usize>]) -> (Vec<Place>, f64) {
    let mut places = vec![Place { lane: 0.0, depth: 0.0 }; children.len()];
    // Parents precede their children. Depths are computed from parents to children, and columns from children to parents.
    for (parent, own) in children.iter().enumerate() {
        for &child in own {
            places[child].depth = places[parent].depth + 1.0;
        }
    }
    let mut leaves = 0.0;
    for leaf in depth_first(children) {
        if children[leaf].is_empty() {
            places[leaf].lane = leaves;
            leaves += 1.0;
        }
    }
    for parent in (0..children.len()).rev() {
        if let (Some(&first), Some(&last)) = (children[parent].first(), children[parent].last()) {
            places[parent].lane = 0.5 * (places[first].lane + places[last].lane);
        }
    }
    (places, leaves)
}

fn depth_first(children: &[Vec<usize>]) -> Vec<usize> {
    let (mut order, mut stack) = (Vec::new(), vec![0]);
    while let Some(link) = stack.pop() {
        order.push(link);
        stack.extend(children[link].iter().rev());
    }
    order
}

fn mass(scene: &Scene, joint: Option<usize>) -> f64 {
    let own = scene.bodies.iter().filter(|body| body.joint == joint);
    own.map(|body| body.mass).sum()
}

fn center(place: Place) -> (f64, f64) {
    (MARGIN + 0.5 * BOX.0 + place.lane * LANE, MARGIN + 0.5 * BOX.1 + place.depth * ROW)
}

fn link(name: &str, mass: f64, place: Place) -> Markup {
    let (x, y) = center(place);
    let mass = if mass > 0.0 { format!("{} kg", rounded(mass, 4)) } else { String::new() };
    html! {
        rect.link x=(x - 0.5 * BOX.0) y=(y - 0.5 * BOX.1) width=(BOX.0) height=(BOX.1) rx="4" {}
        text.name x=(x) y=(y + if mass.is_empty() { 4.5 } else { -2.0 }) text-anchor="middle" {
            (shortened(name, 22))
            title { (name) }
        }
        @if !mass.is_empty() {
            text.small x=(x) y=(y + 11.0) text-anchor="middle" { (mass) }
        }
    }
}

fn edge(scene: &Scene, joint: &SceneJoint, from: Place, to: Place) -> Markup {
    let ((x1, y1), (x2, y2)) = (center(from), center(to));
    let (start, end) = (y1 + 0.5 * BOX.1, y2 - 0.5 * BOX.1);
    let middle = 0.5 * (start + end);
    let line = format!("M{x1} {start}L{x1} {}L{x2} {}L{x2} {end}", start + 8.0, start + 8.0);
    html! {
        path.edge.fixed[joint.motion == SceneMotion::Fixed] d=(line) {}
        (symbol(joint, x2, middle))
        text.joint x=(x2 + 15.0) y=(middle + 0.5) {
            (shortened(&joint.name, 20))
            title { (joint.name) }
        }
        text.small x=(x2 + 15.0) y=(middle + 13.0) { (words(scene, joint)) }
    }
}

/// Symbol of a joint. It is a circle for a rotation, a square for a translation, a circle in a square for both, and a bar
/// for a fixed joint. The symbol is filled if the joint has an input.
fn symbol(joint: &SceneJoint, x: f64, y: f64) -> Markup {
    let is_driven = joint.input.is_some();
    let moves = matches!(joint.motion, SceneMotion::Coordinate(_) | SceneMotion::Follows { .. });
    html! {
        @if !moves {
            rect.held x=(x - 7.0) y=(y - 2.5) width="14" height="5" {}
        } @else {
            @match joint.kind {
                SceneKind::Slides => {
                    rect.joint.driven[is_driven] x=(x - 6.5) y=(y - 6.5) width="13" height="13" {}
                }
                SceneKind::Turns => {
                    circle.joint.driven[is_driven] cx=(x) cy=(y) r="7" {}
                }
                SceneKind::Screws { .. } => {
                    rect.joint x=(x - 6.5) y=(y - 6.5) width="13" height="13" {}
                    circle.joint.driven[is_driven] cx=(x) cy=(y) r="4" {}
                }
            }
        }
    }
}

fn words(scene: &Scene, joint: &SceneJoint) -> String {
    let letter = |coordinate: usize| {
        let (letter, number) = scene.symbol(coordinate).letter();
        format!("{letter}{}", subscript(number))
    };
    let kind = match joint.kind {
        SceneKind::Turns => "turns",
        SceneKind::Slides => "slides",
        SceneKind::Screws { .. } => "turns and slides",
    };
    match &joint.motion {
        SceneMotion::Fixed => "fixed".to_owned(),
        SceneMotion::Held(position) => format!("held at {} {}", rounded(*position, 4), joint.unit()),
        SceneMotion::Coordinate(index) => match joint.input {
            Some(_) => format!("{}, {kind}, driven", letter(*index)),
            None if matches!(scene.symbol(*index), SceneSymbol::Driven(_)) => {
                format!("{}, {kind} as given", letter(*index))
            }
            None => format!("{}, {kind}", letter(*index)),
        },
        SceneMotion::Follows { terms, .. } => {
            let names = terms.iter().map(|(index, _)| letter(*index));
            format!("{kind} with {}", names.collect::<Vec<_>>().join(", "))
        }
    }
}

fn subscript(number: usize) -> String {
    let small = |c: char| match c.to_digit(10) {
        Some(digit) => char::from_u32(u32::from('₀') + digit).unwrap_or(c),
        None => c,
    };
    number.to_string().chars().map(small).collect()
}

/// A name of at most `most` letters. An ellipsis replaces further letters.
fn shortened(name: &str, most: usize) -> String {
    if name.chars().count() <= most {
        return name.to_owned();
    }
    let kept: String = name.chars().take(most - 1).collect();
    format!("{kept}…")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn branches_stand_side_by_side() {
        // A torso with two arms. The first arm has two links.
        let (places, lanes) = places(&[vec![1], vec![2, 3], vec![4], vec![], vec![]]);
        assert_eq!(lanes, 2.0);
        let lane_and_depth: Vec<(f64, f64)> = places.iter().map(|place| (place.lane, place.depth)).collect();
        assert_eq!(lane_and_depth, [(0.5, 0.0), (0.5, 1.0), (0.0, 2.0), (1.0, 2.0), (0.0, 3.0)]);
    }
}
