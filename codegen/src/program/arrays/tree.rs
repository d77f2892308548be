//! Trees to which the entries of arrays belong: the joints, and the coordinates that they follow.

/// A tree of joints or of coordinates.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Tree {
    /// Parent of each entry in the tree; `None` for an entry on the base.
    pub parents: Vec<Option<usize>>,
    /// Entries of the tree. Parents precede children.
    pub order: Vec<usize>,
}

impl Tree {
    /// The number of entries in the tree.
    #[must_use]
    pub fn len(&self) -> usize {
        self.parents.len()
    }

    /// Whether the tree has no entries.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.parents.is_empty()
    }

    /// Whether the entries form one chain, in which the previous entry is the parent of each entry except the
    /// first.
    #[must_use]
    pub fn is_chain(&self) -> bool {
        let parents = self.parents.iter().enumerate();
        parents.into_iter().all(|(index, parent)| *parent == index.checked_sub(1))
    }

    /// Whether entry `j` is before entry `i` on its path to the base.
    #[must_use]
    pub fn is_before(&self, j: usize, i: usize) -> bool {
        let path = std::iter::successors(self.parents[i], |&next| self.parents[next]);
        path.into_iter().any(|ancestor| ancestor == j)
    }

    /// Whether two entries are equal, or one is on the other's path to the base.
    #[must_use]
    pub fn meet(&self, i: usize, j: usize) -> bool {
        i == j || self.is_before(i, j) || self.is_before(j, i)
    }
}

/// Coordinates that the joints follow, for robots in which some joints are not independent.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Coordinates {
    /// Index of the coordinate that each joint follows. Independent joints come first, in order.
    pub of_joints: Vec<usize>,
    /// Tree of the coordinates. Two coordinates are on one path if the inversion of the mass matrix combines
    /// their rows.
    pub tree: Tree,
}

impl Coordinates {
    /// Finds the tree of the coordinates.
    ///
    /// - `of_joints`: index of the coordinate that each joint follows
    #[must_use]
    pub fn new(joints: &Tree, of_joints: Vec<usize>) -> Self {
        let n = of_joints.iter().max().map_or(0, |&last| last + 1);
        let mut meet = vec![vec![false; n]; n];
        for (i, &row) in of_joints.iter().enumerate() {
            for (j, &column) in of_joints.iter().enumerate() {
                meet[row][column] |= joints.meet(i, j);
            }
        }
        let order: Vec<usize> = joints.order.iter().copied().filter(|&joint| joint < n).collect();
        let parents = elimination(meet, &order);
        Self { of_joints, tree: Tree { parents, order } }
    }

    /// Joints that follow the coordinate of another joint, each with this coordinate.
    pub fn followers(&self) -> impl DoubleEndedIterator<Item = (usize, usize)> {
        let joints = self.of_joints.iter().copied().enumerate();
        joints.skip(self.tree.len())
    }
}

/// Elimination tree of a symmetric matrix (Liu 1990). Two rows are on one path if the inversion combines
/// these rows. The inversion goes from the end of `order` to its beginning.
fn elimination(mut meet: Vec<Vec<bool>>, order: &[usize]) -> Vec<Option<usize>> {
    let mut parents = vec![None; order.len()];
    for (place, &pivot) in order.iter().enumerate().rev() {
        let others: Vec<usize> = order[..place].iter().copied().filter(|&other| meet[pivot][other]).collect();
        parents[pivot] = others.last().copied();
        for &row in &others {
            for &column in &others {
                meet[row][column] = true;
            }
        }
    }
    parents
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coordinates_of_two_branches_that_a_joint_joins_stand_on_one_path() {
        // Two fingers on a wrist; the second finger's tip follows the first finger.
        let joints = Tree { parents: vec![None, Some(0), Some(0), Some(2)], order: vec![0, 1, 2, 3] };
        let apart = Coordinates::new(&joints, vec![0, 1, 2, 2]);
        assert_eq!(apart.tree.parents, [None, Some(0), Some(0)]);
        let joined = Coordinates::new(&joints, vec![0, 1, 2, 1]);
        assert_eq!(joined.tree.parents, [None, Some(0), Some(1)]);
        assert_eq!(joined.followers().collect::<Vec<_>>(), [(3, 1)]);
    }
}
