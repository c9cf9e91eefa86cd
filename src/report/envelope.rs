//! Many samples in few columns, without losing a spike.

/// Smallest and largest finite sample of each of `columns` equal stretches; `None` where a stretch
/// has none.
///
/// Every finite sample lies within its column's bounds, so drawing the bounds hides nothing.
pub fn envelope(samples: &[f64], columns: usize) -> Vec<Option<[f64; 2]>> {
    let columns = columns.clamp(1, samples.len().max(1));
    (0..columns)
        .map(|column| {
            let start = column * samples.len() / columns;
            let end = (column + 1) * samples.len() / columns;
            bounds(&samples[start..end])
        })
        .collect()
}

/// Smallest and largest finite value; `None` without any.
pub fn bounds(values: &[f64]) -> Option<[f64; 2]> {
    values
        .iter()
        .filter(|value| value.is_finite())
        .fold(None, |bounds, &value| match bounds {
            None => Some([value, value]),
            Some([low, high]) => Some([value.min(low), value.max(high)]),
        })
}

/// Share [-] of the values at either end that may lie beyond a scale.
const RARE: f64 = 1.0e-3;
/// How many times wider all values have to lie than all but the rare ones, that these get no scale.
const FLATTENED: f64 = 3.0;
/// Room [-] beside the others, by their range.
const ROOM: f64 = 0.3;
/// Values below which none is rare.
const FEW: usize = 500;

/// The scale of values, and what lies beyond it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extent {
    /// Least and greatest value on the scale.
    pub range: [f64; 2],
    /// The value farthest beyond; none where all are on the scale.
    pub farthest: Option<f64>,
}

/// The scale of many values: from the least to the greatest finite one, but where one in a thousand would flatten all
/// others to less than a third of it, that of the others. `None` without any.
pub fn extent(values: &[f64]) -> Option<Extent> {
    let [low, high] = bounds(values)?;
    let all = Extent {
        range: [low, high],
        farthest: None,
    };
    let mut finite: Vec<f64> = values.iter().copied().filter(|it| it.is_finite()).collect();
    if finite.len() < FEW {
        return Some(all);
    }
    let rare = (RARE * finite.len() as f64) as usize;
    let last = finite.len() - 1;
    let least = *finite.select_nth_unstable_by(rare, f64::total_cmp).1;
    let most = *finite.select_nth_unstable_by(last - rare, f64::total_cmp).1;
    let width = most - least;
    if width <= 0.0 || high - low <= FLATTENED * width {
        return Some(all);
    }
    let range = [low.max(least - ROOM * width), high.min(most + ROOM * width)];
    let below = range[0] - low;
    let farthest = if high - range[1] >= below { high } else { low };
    Some(Extent {
        range,
        farthest: Some(farthest),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_rare_spike_gets_no_scale_and_a_tone_and_its_harmonics_keep_theirs() {
        let tone = |i: u32| libm::sin(0.1 * f64::from(i));
        let mut samples: Vec<f64> = (0..4000).map(tone).collect();
        let all = extent(&samples).unwrap();
        assert_eq!((Some(all.range), all.farthest), (bounds(&samples), None));
        samples[700] = 90.0;
        let Extent { range, farthest } = extent(&samples).unwrap();
        assert_eq!(farthest, Some(90.0));
        assert!(range[1] < 1.7 && range[0] < -0.999, "{range:?}");
        // A spike in ten samples is no rare one.
        let impacts: Vec<f64> = (0..4000)
            .map(|i| if i % 10 == 0 { 90.0 } else { tone(i) })
            .collect();
        assert_eq!(extent(&impacts).unwrap().farthest, None);
        assert_eq!(extent(&[f64::NAN]), None);
        assert_eq!(extent(&[0.0, 1.0, 500.0]).unwrap().range, [0.0, 500.0]);
    }

    proptest! {
        #[test]
        fn no_column_count_hides_a_spike(
            length in 1..5000usize, columns in 0..1500usize, place in 0.0..1.0f64, spike in -9.0..9.0f64,
        ) {
            let mut samples = vec![0.0; length];
            let index = (place * length as f64) as usize;
            samples[index] = spike;
            let columns = envelope(&samples, columns);
            let seen = columns.iter().flatten().any(|[low, high]| *low == spike || *high == spike);
            prop_assert!(seen);
        }
    }

    #[test]
    fn a_stretch_of_nan_is_a_gap_and_nothing_else() {
        let samples = [1.0, 2.0, f64::NAN, f64::INFINITY, 3.0, f64::NAN];
        let expected = [Some([1.0, 2.0]), None, Some([3.0, 3.0])];
        assert_eq!(envelope(&samples, 3), expected);
        assert_eq!(envelope(&[], 3), [None]);
    }
}
