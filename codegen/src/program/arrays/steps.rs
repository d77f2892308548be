//! Arrays over joints, and the loops (steps) that compute them.

use super::super::{Operand, Program, Shape, fuse_multiply_adds};
use super::{Coordinates, Tree};

/// A function as loops over the joints: straight-line code, then steps on arrays, each of which is a loop.
#[derive(Debug, Clone, PartialEq)]
pub struct Arrays {
    /// Straight-line code before the loops. Its results are the first arrays.
    pub setup: Program,
    /// All arrays of the function. The results of the straight-line code before the loops are first.
    pub arrays: Vec<Array>,
    /// Steps in order. Each is a loop over joints or coordinates.
    pub steps: Vec<Step>,
    /// Results of the function, in order.
    pub outputs: Vec<ArrayOutput>,
    /// Tree of the joints over which the loops run.
    pub joints: Tree,
    /// Coordinates that the joints follow; `None` if each joint is independent.
    pub coordinates: Option<Coordinates>,
    /// For each joint with a quaternion, its velocities from the base outwards. The loops treat each velocity
    /// as one joint.
    pub chains: Vec<Vec<usize>>,
    /// Whether products and sums in the loops are contracted to fused multiply-adds.
    pub is_fused: bool,
}

/// An array of one or more rows with one entry per joint or coordinate.
#[derive(Debug, Clone, PartialEq)]
pub struct Array {
    /// Name of the array, an identifier.
    pub name: String,
    /// Number of rows of the array.
    pub rows: usize,
    /// Index set of each row's entries: joints or coordinates.
    pub over: Over,
}

/// Relation of a joint to another joint in the tree: before, beyond, the same, or apart.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Relation {
    /// The joint is before the other joint on the path to the base, or both are velocities of the same joint
    /// with a quaternion.
    Before,
    /// Both are the same joint.
    Same,
    /// The joint is beyond the other joint: the other joint is on its path to the base.
    Beyond,
    /// Neither joint is on the path from the other joint to the base.
    Apart,
}

/// Index set of the entries of a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Over {
    /// The row has one entry per joint.
    Joints,
    /// The row has one entry per coordinate that joints follow. If each joint is independent, all arrays are
    /// over joints.
    Coordinates,
}

/// Index of an array in the list of all arrays.
pub type ArrayId = usize;

/// One result of a function with loops over joints.
#[derive(Debug, Clone, PartialEq)]
pub struct ArrayOutput {
    /// Name of the result for documentation.
    pub name: String,
    /// Shape of the result: number, vector or matrix.
    pub shape: Shape,
    /// Index of the array that contains the result.
    pub array: ArrayId,
}

/// A step: a loop that computes arrays. A sum of products starts with the first product and adds the other
/// products in order.
#[derive(Debug, Clone, PartialEq)]
pub enum Step {
    /// Runs the same small straight-line program for each joint.
    Map(Map),
    /// `to[·][j] = from[·][j]` plus the entries of all joints before j, computed from parents to children.
    SumAncestors {
        /// Array with each joint's own term.
        from: ArrayId,
        /// Array of the sums along the paths to the base.
        to: ArrayId,
    },
    /// `to[·][j] = from[·][j]` plus the entries of all joints beyond j, computed from children to parents.
    SumSubtrees {
        /// Array with each joint's own term.
        from: ArrayId,
        /// Array of the sums over the subtrees.
        to: ArrayId,
    },
    /// Computes a matrix whose entries belong to pairs of joints on one path to the base.
    Pairs(Pairs),
    /// `to[·][c]` is the sum of `from[·][j]` over the joints j that follow coordinate c.
    Collect {
        /// Array with one entry per joint, which is summed.
        from: ArrayId,
        /// Array of the sums, with one entry per coordinate.
        to: ArrayId,
    },
    /// `to[c][d]` is the sum of `from[i][j]` over the joints i that follow coordinate c and the joints j that
    /// follow coordinate d. The sums over i are computed first.
    Project {
        /// The matrix over joints that is summed.
        from: ArrayId,
        /// The matrix of the sums, over coordinates.
        to: ArrayId,
    },
    /// `to[·][j] = from[·][k]` for each joint j, with the joint k whose body carries joint j, or 0 if the
    /// base carries joint j.
    GatherCarriers {
        /// Array from which the values of the carrying joints are copied.
        from: ArrayId,
        /// Array to which the values are copied.
        to: ArrayId,
    },
    /// `to[·][j] = from[·][k]` for each velocity j, with the index k of the last velocity of the same joint. A
    /// spherical joint has three velocities, a floating joint six.
    GatherLast {
        /// Array from which the values of the last velocities are copied.
        from: ArrayId,
        /// Array to which the values are copied.
        to: ArrayId,
    },
    /// `to[·][j] = from[·][c]` with the coordinate c that joint j follows.
    Spread {
        /// Array over coordinates from which the values are copied.
        from: ArrayId,
        /// Array over joints to which the values are copied.
        to: ArrayId,
    },
    /// Inverse of a symmetric positive definite matrix that has the zeros of a mass matrix. It is computed by
    /// Gauss–Jordan elimination without pivoting, from the leaves to the base.
    Invert {
        /// The matrix to be inverted.
        from: ArrayId,
        /// The inverse of the matrix.
        to: ArrayId,
    },
    /// `to = −left · right` for matrices over the coordinates.
    NegativeProduct {
        /// Left factor of the product.
        left: ArrayId,
        /// Right factor of the product.
        right: ArrayId,
        /// The negative product `−left · right`.
        to: ArrayId,
    },
    /// `to = matrix · vector` for a symmetric matrix.
    Apply {
        /// The symmetric matrix of the product.
        matrix: ArrayId,
        /// The vector of the product, an array of one row.
        vector: ArrayId,
        /// The product of matrix and vector, an array of one row.
        to: ArrayId,
    },
}

/// A step that runs a straight-line program for each joint.
#[derive(Debug, Clone, PartialEq)]
pub struct Map {
    /// Name of the step in generated code, an identifier.
    pub name: String,
    /// Purpose of the step, for the documentation of its loop.
    pub about: String,
    /// Arrays that the step reads. The inputs of `body` are the rows of these arrays at one joint.
    pub reads: Vec<ArrayId>,
    /// Arrays that the step writes. The results of `body` are the rows of these arrays at the joint.
    pub writes: Vec<ArrayId>,
    /// The straight-line program that runs at each joint.
    pub body: Program,
}

/// A step that computes a matrix over pairs of joints. The sums are over the rows r of the arrays. The entry
/// `to[i][j]` is
///
/// - `Σ before.0[r][i] · before.1[r][j]` if j is before i on its path to the base, or is another velocity of
///   the same joint
/// - `diagonal[i]` if i = j
/// - `Σ beyond.0[r][i] · beyond.1[r][j]` if i is before j
/// - 0 otherwise
#[derive(Debug, Clone, PartialEq)]
pub struct Pairs {
    /// The two arrays whose products are the entries with joint j before joint i. The first array is read at
    /// joint i, the second at joint j.
    pub before: (ArrayId, ArrayId),
    /// The two arrays whose products are the entries with joint j beyond joint i. The first array is read at
    /// joint i, the second at joint j.
    pub beyond: (ArrayId, ArrayId),
    /// Array with the diagonal of the matrix, with one row.
    pub diagonal: ArrayId,
    /// Array in which the matrix is stored.
    pub to: ArrayId,
}

impl Arrays {
    /// Tree of the coordinates. It equals the tree of the joints if each joint is independent.
    #[must_use]
    pub fn coordinates(&self) -> &Tree {
        self.coordinates.as_ref().map_or(&self.joints, |coordinates| &coordinates.tree)
    }

    /// Relation of joint `j` to joint `i` in the tree: before, beyond, the same, or apart.
    #[must_use]
    pub fn relation(&self, i: usize, j: usize) -> Relation {
        let is_one_joint = || self.chains.iter().any(|chain| chain.contains(&i) && chain.contains(&j));
        match () {
            () if i == j => Relation::Same,
            () if self.joints.is_before(j, i) || is_one_joint() => Relation::Before,
            () if self.joints.is_before(i, j) => Relation::Beyond,
            () => Relation::Apart,
        }
    }

    /// Whether the joints form one chain, in which each joint except the first is carried by the previous
    /// joint. False if a joint has a quaternion.
    #[must_use]
    pub fn is_chain(&self) -> bool {
        self.joints.is_chain() && self.chains.is_empty()
    }

    /// Carrier of each joint: the joint whose body carries it; `None` for the base. A velocity of a joint
    /// with a quaternion has the carrier of the whole joint.
    #[must_use]
    pub fn carriers(&self) -> Vec<Option<usize>> {
        let mut carriers = self.joints.parents.clone();
        for chain in &self.chains {
            for &joint in chain {
                carriers[joint] = chain.first().and_then(|&first| self.joints.parents[first]);
            }
        }
        carriers
    }

    /// For each joint over which the loops run, its last velocity if it belongs to a joint with a quaternion;
    /// otherwise the joint itself.
    #[must_use]
    pub fn last(&self) -> Vec<usize> {
        let mut last: Vec<usize> = (0..self.joints.len()).collect();
        for chain in &self.chains {
            for &joint in chain {
                last[joint] = *chain.last().unwrap_or(&joint);
            }
        }
        last
    }

    /// Tree of the joints or coordinates to which an array's entries belong.
    #[must_use]
    pub fn tree(&self, array: ArrayId) -> &Tree {
        self.over(self.arrays[array].over)
    }

    /// Whether an entry (i, j) of a matrix is zero if neither coordinate is on the path from the other to the
    /// base. This is false e.g. for the friction of a shaft that moves two branches, because its force on one
    /// branch depends on the other.
    #[must_use]
    pub fn is_over_paths(&self, array: ArrayId) -> bool {
        let Some(output) = self.setup.outputs.get(array) else {
            let made = self.steps.iter().find(|step| step.writes(array));
            return match made {
                Some(Step::Pairs(_)) => true,
                Some(Step::Project { from, .. }) => self.is_over_paths(*from),
                _ => false,
            };
        };
        let (tree, n) = (self.coordinates(), self.coordinates().len());
        let is_there = |entry: &Operand| *entry != Operand::Constant(0.0);
        let mut entries = output.entries.iter().enumerate();
        entries.all(|(index, entry)| tree.meet(index / n, index % n) || !is_there(entry))
    }

    pub(super) fn over(&self, over: Over) -> &Tree {
        match over {
            Over::Joints => &self.joints,
            Over::Coordinates => self.coordinates(),
        }
    }

    /// Fuses multiply-adds in the loops: each product that is used only by sums becomes part of these sums.
    #[must_use]
    pub fn fused(&self) -> Self {
        let mut fused = self.clone();
        fused.setup = fuse_multiply_adds(&self.setup);
        for step in &mut fused.steps {
            if let Step::Map(map) = step {
                map.body = fuse_multiply_adds(&map.body);
            }
        }
        fused.is_fused = true;
        fused
    }
}

impl Step {
    /// Whether the step reads an array.
    #[must_use]
    pub fn reads(&self, array: ArrayId) -> bool {
        match self {
            Self::Map(map) => map.reads.contains(&array),
            Self::SumAncestors { from, .. }
            | Self::SumSubtrees { from, .. }
            | Self::Collect { from, .. }
            | Self::Project { from, .. }
            | Self::GatherCarriers { from, .. }
            | Self::GatherLast { from, .. }
            | Self::Spread { from, .. }
            | Self::Invert { from, .. } => *from == array,
            Self::Pairs(Pairs { before, beyond, diagonal, .. }) => {
                [before.0, before.1, beyond.0, beyond.1, *diagonal].contains(&array)
            }
            Self::NegativeProduct { left, right, .. } => [*left, *right].contains(&array),
            Self::Apply { matrix, vector, .. } => [*matrix, *vector].contains(&array),
        }
    }

    /// Whether the step writes an array.
    #[must_use]
    pub fn writes(&self, array: ArrayId) -> bool {
        match self {
            Self::Map(map) => map.writes.contains(&array),
            Self::SumAncestors { to, .. }
            | Self::SumSubtrees { to, .. }
            | Self::Pairs(Pairs { to, .. })
            | Self::Collect { to, .. }
            | Self::Project { to, .. }
            | Self::GatherCarriers { to, .. }
            | Self::GatherLast { to, .. }
            | Self::Spread { to, .. }
            | Self::Invert { to, .. }
            | Self::NegativeProduct { to, .. }
            | Self::Apply { to, .. } => *to == array,
        }
    }
}
