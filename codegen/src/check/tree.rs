//! The tree of a description's links, in which each parent precedes its children.

use crate::description::{JointDescription, Name, RobotDescription};
use crate::diagnostic::{Report, Span, nearest};
use std::collections::BTreeMap;

/// Links and joints in the order of the model.
#[derive(Debug, Default)]
pub(super) struct Tree {
    /// Names of the links. The base is the first link.
    pub links: Vec<Name>,
    /// For each link the index, in the description, of the joint that carries the link; `None` for the base.
    pub joints: Vec<Option<usize>>,
    /// For each link the index of the parent link. The base is its own parent.
    pub parents: Vec<usize>,
    /// Index of each link by its name.
    pub index: BTreeMap<String, usize>,
}

impl Tree {
    /// Indices of the links whose joint moves, parents first.
    pub fn moved_links(&self, robot: &RobotDescription) -> impl Iterator<Item = usize> {
        let joint = |link: usize| self.joints[link].and_then(|joint| robot.joints.get(joint));
        (0..self.links.len()).filter(move |&link| joint(link).is_some_and(JointDescription::moves))
    }

    /// Whether each link moves.
    pub fn moving(&self, robot: &RobotDescription) -> Vec<bool> {
        let carriers = self.carriers(robot).into_iter();
        carriers.map(|carrier| carrier > 0).collect()
    }

    /// For each link the index of its carrier: the first link whose joint moves, on the path from the link
    /// itself to the base. If no joint on the path moves, the carrier is the base.
    pub fn carriers(&self, robot: &RobotDescription) -> Vec<usize> {
        let mut carriers = vec![0; self.links.len()];
        for link in self.moved_links(robot) {
            carriers[link] = link;
        }
        for link in 0..self.links.len() {
            if carriers[link] == 0 {
                carriers[link] = carriers[self.parents[link]];
            }
        }
        carriers
    }

    /// Indices of the links on the path from the parent of a link to the base.
    pub fn ancestors(&self, link: usize) -> impl Iterator<Item = usize> {
        let parent = |&link: &usize| (link > 0).then(|| self.parents[link]);
        std::iter::successors(parent(&link), parent)
    }
}

/// The links of a description by index, and the joints between them.
struct Graph<'d> {
    names: Vec<&'d Name>,
    numbers: BTreeMap<&'d str, usize>,
    /// For each link the joint that carries it; `None` for a root.
    carried_by: Vec<Option<usize>>,
    /// For each link the joints to its children.
    carries: Vec<Vec<usize>>,
}

/// Builds the tree. Returns `None` and reports an error if there are two roots, a cycle, or a link that two
/// joints carry.
pub(super) fn build(robot: &RobotDescription, report: &mut Report) -> Option<Tree> {
    let before = report.error_count();
    let graph = Graph::new(robot, report);
    let root = graph.root(robot, report)?;
    let tree = graph.walk(root, &robot.joints);
    graph.report_cycles(&tree, robot, report);
    let complete = tree.links.len() == graph.names.len() && report.error_count() == before;
    complete.then_some(tree)
}

impl<'d> Graph<'d> {
    fn new(robot: &'d RobotDescription, report: &mut Report) -> Self {
        let mut graph =
            Self { names: Vec::new(), numbers: BTreeMap::new(), carried_by: Vec::new(), carries: Vec::new() };
        graph.declare_links(robot, report);
        for (index, joint) in robot.joints.iter().enumerate() {
            let (Some(parent), Some(child)) = (&joint.parent, &joint.child) else {
                continue;
            };
            let (parent, child) = (graph.number(parent), graph.number(child));
            graph.carries[parent].push(index);
            match graph.carried_by[child] {
                None => graph.carried_by[child] = Some(index),
                Some(first) => report_two_joints(joint, &robot.joints[first], report),
            }
        }
        if robot.sort_joints {
            for joints in &mut graph.carries {
                joints.sort_by(|a, b| robot.joints[*a].name.value.cmp(&robot.joints[*b].name.value));
            }
        }
        graph
    }

    fn declare_links(&mut self, robot: &'d RobotDescription, report: &mut Report) {
        for link in &robot.links {
            if let Some(first) = self.numbers.get(link.value.as_str()) {
                let place = report.place(self.names[*first].span);
                let message =
                    format!("two links are named `{}`: rename this one or the one at {place}", link.value);
                report.error(link.span, "duplicate-name", message);
            }
            self.number(link);
        }
        let declared = !robot.links.is_empty();
        for name in robot.joints.iter().flat_map(|joint| [&joint.parent, &joint.child]).flatten() {
            if declared && !self.numbers.contains_key(name.value.as_str()) {
                report.error(name.span, "unknown-link", format!("unknown link `{}`", name.value));
                if let Some(help) = nearest(&name.value, robot.links.iter().map(|link| link.value.as_str())) {
                    report.help(help);
                }
                self.number(name);
            }
        }
        if let Some(base) = &robot.base {
            self.number(base);
        }
    }

    fn number(&mut self, name: &'d Name) -> usize {
        let next = self.names.len();
        let number = *self.numbers.entry(&name.value).or_insert(next);
        if number == next {
            self.names.push(name);
            self.carried_by.push(None);
            self.carries.push(Vec::new());
        }
        number
    }

    fn root(&self, robot: &RobotDescription, report: &mut Report) -> Option<usize> {
        let roots: Vec<usize> =
            (0..self.names.len()).filter(|link| self.carried_by[*link].is_none()).collect();
        match roots.as_slice() {
            [root] => match &robot.base {
                Some(base) if base.value != self.names[*root].value => {
                    let message = format!("`{}` is carried by a joint, so it cannot be the base", base.value);
                    report.error(base.span, "base-moves", message);
                    None
                }
                _ => Some(*root),
            },
            [] if self.names.is_empty() => {
                if !report.has_errors() {
                    let message = "the description has no joints";
                    report.error(robot.name.span, "no-moving-joint", message);
                    report.help("a robot needs at least one [[joints]] entry, or <joint> in a URDF");
                }
                None
            }
            [] => {
                self.report_cycles(&Tree::default(), robot, report);
                None
            }
            [first, others @ ..] => {
                self.report_roots(*first, others, report);
                None
            }
        }
    }

    fn report_roots(&self, first: usize, others: &[usize], report: &mut Report) {
        for other in others {
            let (base, name) = (self.names[first], self.names[*other]);
            let message =
                format!("the robot has two roots: no joint carries `{}` or `{}`", base.value, name.value);
            report.error(name.span, "two-roots", message);
            let carried = (0..self.names.len()).filter(|link| self.carried_by[*link].is_some());
            let hint = nearest(&name.value, carried.map(|link| self.names[link].value.as_str()));
            let hint = hint.filter(|hint| hint.starts_with("did"));
            report.help(match hint {
                Some(hint) => format!("{hint} Otherwise add a joint that carries `{}`", name.value),
                None => format!("add a joint from `{}` to `{}`, or correct the name", base.value, name.value),
            });
        }
    }

    /// Visits the links depth first. A stack replaces recursion, because chains may be long.
    fn walk(&self, root: usize, joints: &[JointDescription]) -> Tree {
        let mut tree = Tree::default();
        let mut stack = vec![(root, None, 0)];
        let mut seen = vec![false; self.names.len()];
        while let Some((link, joint, parent)) = stack.pop() {
            if std::mem::replace(&mut seen[link], true) {
                continue;
            }
            let index = tree.links.len();
            tree.links.push(self.names[link].clone());
            tree.joints.push(joint);
            tree.parents.push(parent);
            tree.index.insert(self.names[link].value.clone(), index);
            for joint in self.carries[link].iter().rev() {
                let child =
                    joints[*joint].child.as_ref().and_then(|child| self.numbers.get(child.value.as_str()));
                stack.extend(child.map(|child| (*child, Some(*joint), index)));
            }
        }
        tree
    }

    fn report_cycles(&self, tree: &Tree, robot: &RobotDescription, report: &mut Report) {
        let mut seen: Vec<bool> =
            self.names.iter().map(|name| tree.index.contains_key(&name.value)).collect();
        for start in 0..self.names.len() {
            let mut path = Vec::new();
            let mut link = start;
            while !std::mem::replace(&mut seen[link], true) {
                path.push(link);
                let joint = self.carried_by[link].and_then(|joint| robot.joints.get(joint));
                let parent = joint.and_then(|joint| joint.parent.as_ref());
                let Some(parent) = parent.and_then(|parent| self.numbers.get(parent.value.as_str())) else {
                    break;
                };
                link = *parent;
            }
            if let Some(first) = path.iter().position(|member| *member == link) {
                self.report_cycle(&path[first..], robot, report);
            }
        }
    }

    fn report_cycle(&self, members: &[usize], robot: &RobotDescription, report: &mut Report) {
        let names: Vec<String> =
            members.iter().rev().take(8).map(|link| format!("`{}`", self.names[*link].value)).collect();
        let dots = if members.len() > 8 { " → …" } else { "" };
        let joint = members.iter().filter_map(|link| self.carried_by[*link]).max();
        let span =
            joint.and_then(|joint| robot.joints.get(joint)).map_or(Span::default(), |joint| joint.name.span);
        if let [link] = members {
            // A default parent has the span of the joint's name.
            let parent = joint.and_then(|joint| robot.joints.get(joint)?.parent.as_ref());
            let is_default = parent.is_some_and(|parent| parent.span == span);
            report_carried_by_itself(&self.names[*link].value, is_default, span, report);
            return;
        }
        report.error(span, "cycle", format!("the links {}{dots} form a cycle", names.join(" → ")));
        report.help("each link is carried by one joint, and the chain of parents must end at the base");
    }
}

/// Reports a joint whose parent and child are the same link. This happens by default if the first joint has
/// the name of the base.
fn report_carried_by_itself(link: &str, is_default: bool, span: Span, report: &mut Report) {
    let message = format!("link `{link}` would carry itself: this joint names it as parent and child");
    report.error(span, "cycle", message);
    let other = if link == "world" { "ground" } else { "world" };
    report.help(match is_default {
        true => format!(
            "rename the joint or the base, for example `base = \"{other}\"`. A joint without `child` moves the link with its own \
             name, and a first joint without `parent` is on the base"
        ),
        false => "name two different links: `parent` carries the joint, `child` moves with it".to_owned(),
    });
}

fn report_two_joints(second: &JointDescription, first: &JointDescription, report: &mut Report) {
    let Some(child) = &second.child else { return };
    let message = format!(
        "link `{}` is carried by two joints, `{}` and `{}`",
        child.value, first.name.value, second.name.value
    );
    report.error(child.span, "two-parents", message);
    report.help("each link has one joint to its parent. Closed loops are not supported");
}
