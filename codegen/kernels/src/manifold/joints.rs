/// For each joint: its number of position entries, and the indices of its first position entry and first
/// velocity.
pub(super) fn places<const J: usize>(widths: &[usize; J]) -> [(usize, usize, usize); J] {
    let mut places = [(0, 0, 0); J];
    let (mut position, mut velocity) = (0_usize, 0_usize);
    for (place, width) in places.iter_mut().zip(widths) {
        *place = (*width, position, velocity);
        position = position.wrapping_add(*width);
        velocity = velocity.wrapping_add(width.wrapping_sub(usize::from(*width > 1)));
    }
    places
}

/// Reads K entries from index `first` on. All are NaN if there are fewer than K entries.
#[inline]
pub(super) fn read<const K: usize>(entries: &[f64], first: usize) -> [f64; K] {
    match entries.get(first..).and_then(|rest| rest.first_chunk()) {
        Some(chunk) => *chunk,
        None => [f64::NAN; K],
    }
}

/// Writes K entries from index `first` on, if there are at least K entries.
#[inline]
pub(super) fn write<const K: usize>(entries: &mut [f64], first: usize, values: &[f64; K]) {
    if let Some(chunk) = entries
        .get_mut(first..)
        .and_then(|rest| rest.first_chunk_mut())
    {
        *chunk = *values;
    }
}
