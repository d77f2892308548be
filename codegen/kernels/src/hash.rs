//! Hashes that are the same on every platform.

/// Hash of bytes by the method FNV-1a with 64 bits (Fowler, Noll and Vo 1991).
pub fn fnv1a(bytes: impl Iterator<Item = u8>) -> u64 {
    bytes.fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    })
}

#[cfg(test)]
mod tests {
    /// Values of the authors' test vectors.
    #[test]
    fn hashes_are_those_of_the_authors() {
        assert_eq!(super::fnv1a(core::iter::empty()), 0xcbf2_9ce4_8422_2325);
        assert_eq!(
            super::fnv1a(b"foobar".iter().copied()),
            0x8594_4171_f739_67e8
        );
    }
}
