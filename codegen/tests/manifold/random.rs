//! Seeded numbers.

/// SplitMix64.
pub struct Random(pub u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// A number between −size and size.
    pub fn number(&mut self, size: f64) -> f64 {
        ((self.next() >> 11) as f64 / (1_u64 << 52) as f64 - 1.0) * size
    }

    pub fn vector<const K: usize>(&mut self, size: f64) -> [f64; K] {
        core::array::from_fn(|_| self.number(size))
    }

    pub fn matrix<const R: usize, const C: usize>(&mut self, size: f64) -> [[f64; C]; R] {
        core::array::from_fn(|_| self.vector(size))
    }

    /// A vector of this length.
    pub fn direction(&mut self, length: f64) -> [f64; 3] {
        loop {
            let vector: [f64; 3] = self.vector(1.0);
            let found = vector.iter().map(|x| x * x).sum::<f64>().sqrt();
            if found > 0.1 {
                return vector.map(|x| x * (length / found));
            }
        }
    }

    pub fn quaternion(&mut self) -> [f64; 4] {
        loop {
            let q: [f64; 4] = self.vector(1.0);
            let length = q.iter().map(|x| x * x).sum::<f64>().sqrt();
            if length > 0.1 {
                return q.map(|x| x / length);
            }
        }
    }

    /// A pose.
    pub fn pose(&mut self) -> [f64; 7] {
        let ([x, y, z], [a, b, c, d]) = (self.vector(1.0), self.quaternion());
        [x, y, z, a, b, c, d]
    }
}

/// The largest difference of two lists of numbers.
pub fn distance(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let largest = |sum: f64, (a, b): (&f64, &f64)| match (a - b).abs() {
        difference if difference.is_nan() => f64::INFINITY,
        difference => sum.max(difference),
    };
    a.iter().zip(b).fold(0.0, largest)
}
