//! Interpolation of samples to a grid of equal time steps, for each piece between gaps.

use super::channel::Channel;

/// Time interval in which no channel has a gap.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Piece {
    /// Time in s at which the interval begins.
    pub start: f64,
    /// Time in s at which the interval ends.
    pub end: f64,
}

impl Piece {
    /// Returns the duration in s.
    pub(crate) fn duration(&self) -> f64 {
        self.end - self.start
    }

    /// Returns times with equal steps, beginning with the start.
    pub(crate) fn grid(&self, step: f64) -> Vec<f64> {
        let count = (self.duration() / step * (1.0 + 1e-12)).floor().max(0.0) as usize;
        (0..=count).map(|i| self.start + step * i as f64).collect()
    }
}

/// Returns the intervals in which all channels have samples and no channel has a pause longer than `largest_step` (in s).
pub(super) fn pieces(channels: &[&Channel], largest_step: f64) -> Vec<Piece> {
    let first = |c: &&Channel| c.times.first().copied().unwrap_or(f64::INFINITY);
    let last = |c: &&Channel| c.times.last().copied().unwrap_or(f64::NEG_INFINITY);
    let start = channels.iter().map(first).fold(f64::NEG_INFINITY, f64::max);
    let end = channels.iter().map(last).fold(f64::INFINITY, f64::min);
    let mut gaps: Vec<(f64, f64)> = Vec::new();
    for channel in channels {
        // A channel with long holds has longer time steps, which are not gaps.
        let allowed = largest_step.max(2.5 * channel.step());
        gaps.extend(channel.times.windows(2).filter(|t| t[1] - t[0] > allowed).map(|t| (t[0], t[1])));
    }
    gaps.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (mut pieces, mut from) = (Vec::new(), start);
    for (before, after) in gaps {
        pieces.push(Piece { start: from, end: before.min(end) });
        from = from.max(after);
    }
    pieces.push(Piece { start: from, end });
    pieces.retain(|p| p.end > p.start);
    pieces
}

/// Returns the values of a channel at the increasing times `grid`, from cubics through two samples on each side.
///
/// Samples that are much closer to each other than the usual step are averaged first, because a cubic through them would
/// amplify their noise.
pub(super) fn interpolate(channel: &Channel, grid: &[f64]) -> Vec<f64> {
    let (times, values) = merged(channel);
    let mut right = 0;
    let mut value = |t: &f64| {
        while right < times.len() && times[right] < *t {
            right += 1;
        }
        cubic(&times, &values, right, *t)
    };
    grid.iter().map(&mut value).collect()
}

/// Returns times and values in which samples that are closer than 0.3 usual steps are replaced by their mean.
fn merged(channel: &Channel) -> (Vec<f64>, Vec<f64>) {
    let near = 0.3 * channel.step();
    let (mut times, mut values): (Vec<f64>, Vec<f64>) = (Vec::new(), Vec::new());
    let mut count = 1.0;
    for (t, y) in channel.times.iter().zip(&channel.values) {
        match (times.last_mut(), values.last_mut()) {
            (Some(last), Some(value)) if t - *last < near => {
                count += 1.0;
                *last += (t - *last) / count;
                *value += (y - *value) / count;
            }
            _ => {
                times.push(*t);
                values.push(*y);
                count = 1.0;
            }
        }
    }
    (times, values)
}

/// Returns Lagrange's cubic at `t` between the samples `right − 1` and `right`. At the ends it is linear or constant.
fn cubic(times: &[f64], values: &[f64], right: usize, t: f64) -> f64 {
    let Some(last) = times.len().checked_sub(1) else { return f64::NAN };
    if right == 0 || right > last {
        return values[right.min(last)];
    }
    if right == 1 || right == last {
        let share = (t - times[right - 1]) / (times[right] - times[right - 1]);
        return values[right - 1] + share * (values[right] - values[right - 1]);
    }
    let nodes = right - 2..right + 2;
    let weight = |i: usize| -> f64 {
        nodes.clone().filter(|j| *j != i).map(|j| (t - times[j]) / (times[i] - times[j])).product()
    };
    nodes.clone().map(|i| values[i] * weight(i)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn jittered_samples_of_a_cubic_come_back_on_the_grid() {
        let times: Vec<f64> = (0..100).map(|i| 0.01 * f64::from(i) + 2e-3 * f64::from(i * i % 3)).collect();
        let cubic = |t: f64| 1.0 - 2.0 * t + t * t * t;
        let signal: Vec<f64> = times.iter().map(|t| cubic(*t)).collect();
        let channel = Channel::new(&times, &signal, true);
        let grid = Piece { start: 0.02, end: 0.97 }.grid(0.01);
        assert_eq!(grid.len(), 96);
        for (t, y) in grid.iter().zip(interpolate(&channel, &grid)) {
            assert!((y - cubic(*t)).abs() < 1e-12, "{t}");
        }
    }

    #[test]
    fn gaps_of_any_channel_split() {
        let even: Vec<f64> = (0..300).map(|i| 0.01 * f64::from(i)).collect();
        let wave: Vec<f64> = even.iter().map(|t| t.sin()).collect();
        let whole = Channel::new(&even, &wave, true);
        let mut holes = wave.clone();
        holes[100..120].fill(f64::NAN);
        holes[299] = f64::NAN;
        let split = Channel::new(&even, &holes, true);
        let found = pieces(&[&whole, &split], 0.05);
        let ends: Vec<[f64; 2]> = found.iter().map(|p| [p.start, p.end]).collect();
        assert_eq!(ends, [[0.0, 0.99], [1.2, 2.98]]);
        assert_eq!(pieces(&[&whole, &split], 0.5).len(), 1);
        let nothing = Channel::new(&even, &[f64::NAN; 300], true);
        assert!(pieces(&[&whole, &nothing], 0.05).is_empty());
    }
}
