//! Arrays over joints, and the steps that compute them.

use super::super::{Operand, Program, Shape, fuse_multiply_adds};
use super::{Coordinates, Tree};

/// A function over arrays.
#[derive(Debug, Clone, PartialEq)]
pub struct Arrays {
    /// Straight-line code whose results are the first arrays.
    pub setup: Program,
    /// All arrays: those of the setup first.
    pub arrays: Vec<Array>,
    /// The steps of the computation, in order.
    pub steps: Vec<Step>,
    /// Results of the function in their order.
    pub outputs: Vec<ArrayOutput>,
    /// The joints.
    pub joints: Tree,
    /// The coordinates that the joints follow; `None` if each joint is one.
    pub coordinates: Option<Coordinates>,
    /// Joints that are the velocities of one joint with a quaternion, from the base outwards.
    pub chains: Vec<Vec<usize>>,
    /// It is true if products and sums of the steps are fused.
    pub is_fused: bool,
}

/// Rows of one entry per joint or per coordinate.
#[derive(Debug, Clone, PartialEq)]
pub struct Array {
    /// The name of the array, as an identifier.
    pub name: String,
    /// How many rows it has.
    pub rows: usize,
    /// Index set of its entries.
    pub over: Over,
}

/// Where a joint stands seen from another one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Relation {
    /// Before it on its path to the base, or another velocity of the same joint.
    Before,
    /// It is the same.
    Same,
    /// Beyond it.
    Beyond,
    /// On no path with it.
    Apart,
}

/// Index set of the entries of a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Over {
    /// Joints.
    Joints,
    /// Coordinates that joints follow. Where each joint is one, all arrays are over joints.
    Coordinates,
}

/// Refers to an array.
pub type ArrayId = usize;

/// One result of the function.
#[derive(Debug, Clone, PartialEq)]
pub struct ArrayOutput {
    /// Name for documentation.
    pub name: String,
    /// Shape of the result.
    pub shape: Shape,
    /// Where it stands.
    pub array: ArrayId,
}

/// One step over arrays. Sums of products start with their first product and add the others in their order.
#[derive(Debug, Clone, PartialEq)]
pub enum Step {
    /// A small straight-line program for each joint by itself.
    Map(Map),
    /// `to[·][j] = from[·][j]` and that of all joints before j; parents first.
    SumAncestors {
        /// Terms.
        from: ArrayId,
        /// Sums.
        to: ArrayId,
    },
    /// `to[·][j] = from[·][j]` and that of all joints beyond j; leaves first.
    SumSubtrees {
        /// Terms.
        from: ArrayId,
        /// Sums.
        to: ArrayId,
    },
    /// A matrix over pairs of joints on one path.
    Pairs(Pairs),
    /// `to[·][c]` is the sum of `from[·][j]` over the joints j that follow coordinate c.
    Collect {
        /// Over joints.
        from: ArrayId,
        /// Over coordinates.
        to: ArrayId,
    },
    /// `to[c][d]` is the sum of `from[i][j]` over the joints i that follow coordinate c and j that follow d; sums
    /// over i come first.
    Project {
        /// A matrix over joints.
        from: ArrayId,
        /// A matrix over coordinates.
        to: ArrayId,
    },
    /// `to[·][j] = from[·][k]` with the carrier k of joint j, or 0 if that is the base.
    GatherCarriers {
        /// Source array.
        from: ArrayId,
        /// Target array.
        to: ArrayId,
    },
    /// `to[·][j] = from[·][k]` with the last velocity k of the joint that j belongs to.
    GatherLast {
        /// Source array.
        from: ArrayId,
        /// Target array.
        to: ArrayId,
    },
    /// `to[·][j] = from[·][c]` with the coordinate c that joint j follows.
    Spread {
        /// Over coordinates.
        from: ArrayId,
        /// Over joints.
        to: ArrayId,
    },
    /// Inverse of a symmetric positive definite matrix with the zeros of a mass matrix, by Gauss and Jordan
    /// without pivots from the leaves to the base.
    Invert {
        /// The matrix.
        from: ArrayId,
        /// Its inverse.
        to: ArrayId,
    },
    /// `to = −left · right`, matrices over the coordinates.
    NegativeProduct {
        /// Left factor.
        left: ArrayId,
        /// Right factor.
        right: ArrayId,
        /// The product.
        to: ArrayId,
    },
    /// `to = matrix · vector` for a symmetric matrix.
    Apply {
        /// The matrix.
        matrix: ArrayId,
        /// The vector, an array of one row.
        vector: ArrayId,
        /// The product, an array of one row.
        to: ArrayId,
    },
}

/// A straight-line program for each joint.
#[derive(Debug, Clone, PartialEq)]
pub struct Map {
    /// The name of the step, as an identifier.
    pub name: String,
    /// The purpose of the step, for the documentation.
    pub about: String,
    /// Arrays that it reads; its inputs are their rows at one joint.
    pub reads: Vec<ArrayId>,
    /// Arrays that it writes; its results are their rows at the joint.
    pub writes: Vec<ArrayId>,
    /// The computation at each joint.
    pub body: Program,
}

/// `to[i][j]` is `Σ before.0[r][i] · before.1[r][j]` where j is before i on its path to the base or another velocity of
/// one joint, `diagonal[i]` where i = j, `Σ beyond.0[r][i] · beyond.1[r][j]` where i is before j, and 0 elsewhere.
#[derive(Debug, Clone, PartialEq)]
pub struct Pairs {
    /// Rows by i and rows by j where j is before i.
    pub before: (ArrayId, ArrayId),
    /// Rows by i and rows by j where j is beyond i.
    pub beyond: (ArrayId, ArrayId),
    /// An array of one row.
    pub diagonal: ArrayId,
    /// The matrix.
    pub to: ArrayId,
}

impl Arrays {
    /// The coordinates: the joints where each of them is one.
    #[must_use]
    pub fn coordinates(&self) -> &Tree {
        self.coordinates.as_ref().map_or(&self.joints, |coordinates| &coordinates.tree)
    }

    /// Where joint `j` stands seen from joint `i`.
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

    /// Whether each joint but the first follows the one before it, and none has a quaternion.
    #[must_use]
    pub fn is_chain(&self) -> bool {
        self.joints.is_chain() && self.chains.is_empty()
    }

    /// For each joint what carries the joint that it belongs to; `None` for the base.
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

    /// For each joint the last velocity of the joint that it belongs to.
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

    /// Tree of the index set of an array.
    #[must_use]
    pub fn tree(&self, array: ArrayId) -> &Tree {
        self.over(self.arrays[array].over)
    }

    /// Whether a matrix over coordinates is zero in each entry whose two coordinates are on no common path. Forces of one
    /// coordinate that depend on another branch, as the friction of a shaft that moves two, are elsewhere.
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

    /// The same with fused multiply-adds: each product that only sums read is part of these sums.
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
