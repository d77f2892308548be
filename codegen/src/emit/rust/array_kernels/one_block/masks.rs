/// Bit masks that select the entries of a row before joint i, and the entry of joint i. Compilers would turn
/// selections by `if` into branches.
struct Masks<const L: usize>;

impl<const L: usize> Masks<L> {
    const BEFORE: [[u64; L]; L] = {
        let mut masks = [[0; L]; L];
        let mut i = 0;
        while i < L {
            let mut j = 0;
            while j < i {
                masks[i][j] = !0;
                j += 1;
            }
            i += 1;
        }
        masks
    };

    const OWN: [[u64; L]; L] = {
        let mut masks = [[0; L]; L];
        let mut i = 0;
        while i < L {
            masks[i][i] = !0;
            i += 1;
        }
        masks
    };
}
