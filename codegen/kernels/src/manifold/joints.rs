/// For each joint its number of position entries, its first position entry and its first velocity entry.
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

/// K entries from the first one on; each is `otherwise` where there are fewer.
#[inline]
pub(super) fn read<const K: usize>(entries: &[f64], first: usize) -> [f64; K] {
    match entries.get(first..).and_then(|rest| rest.first_chunk()) {
        Some(chunk) => *chunk,
        None => [f64::NAN; K],
    }
}

/// Sets K entries from the first one on, where there are so many.
#[inline]
pub(super) fn write<const K: usize>(entries: &mut [f64], first: usize, values: &[f64; K]) {
    if let Some(chunk) = entries
        .get_mut(first..)
        .and_then(|rest| rest.first_chunk_mut())
    {
        *chunk = *values;
    }
}
