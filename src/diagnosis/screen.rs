//! What these runs can show of each effect: detection limits, what parameters absorb, and what looks alike.

use super::candidate::Candidate;
use super::inference::{Evidence, Signatures};
use serde::Serialize;

/// Deviations from which on an effect shows.
const SHOWS: f64 = 3.0;
/// Cosine from which on two effects cannot be distinguished.
pub const ALIKE: f64 = 0.95;

/// What can be seen of an effect.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Screened {
    /// Name with the channel.
    pub name: String,
    /// χ² [-] that it explains beyond parameters.
    pub score: f64,
    /// Distance from the neutral magnitude that shows with three deviations, in `unit`, or the magnitude itself where the
    /// neutral one is infinite; none where none does.
    pub detectable: Option<f64>,
    /// Unit of the magnitude.
    pub unit: &'static str,
    /// Share [-] of its signature that parameters absorb.
    pub absorbed: f64,
    /// Effects that show like it, with cosines.
    pub equivalent: Vec<(String, f64)>,
}

/// Every candidate, in their order.
pub fn screen(
    candidates: &[Candidate],
    evidence: &Evidence,
    signatures: &Signatures,
) -> Vec<Screened> {
    let names: Vec<String> = candidates.iter().map(Candidate::name).collect();
    let of = |(place, candidate): (usize, &Candidate)| {
        let others = (0..names.len()).filter(|other| *other != place);
        let cosine = |other: usize| signatures.cosines[(place, other)];
        let alike = others.filter(|other| cosine(*other).abs() >= ALIKE);
        let [whole, left] = signatures.typical[place];
        Screened {
            name: names[place].clone(),
            score: (evidence.none - evidence.misfits[place]).max(0.0),
            detectable: detectable(candidate, &signatures.by_size[place]),
            unit: candidate.seat.unit,
            absorbed: 1.0 - left / whole.max(f64::MIN_POSITIVE),
            equivalent: alike
                .map(|other| (names[other].clone(), cosine(other)))
                .collect(),
        }
    };
    candidates.iter().enumerate().map(of).collect()
}

/// The smallest size of those tried that shows, with what is beyond the ends in proportion to the magnitude.
fn detectable(candidate: &Candidate, by_size: &[[f64; 2]]) -> Option<f64> {
    let neutral = candidate.seat.neutral;
    let [first, last] = [by_size.first()?, by_size.last()?];
    let departure = |size: f64| {
        if neutral.is_finite() {
            (candidate.magnitude(size) - neutral).abs()
        } else {
            candidate.magnitude(size)
        }
    };
    let in_proportion = |[size, deviations]: [f64; 2]| {
        let factor = SHOWS / deviations.max(f64::MIN_POSITIVE);
        if neutral.is_finite() {
            departure(size) * factor
        } else {
            // The farther from infinity, the more shows.
            departure(size) / factor
        }
    };
    if first[1] >= SHOWS {
        return Some(in_proportion(*first));
    }
    let crossing = by_size.windows(2).find(|pair| pair[1][1] >= SHOWS);
    if let Some([[from, below], [to, above]]) = crossing.and_then(|pair| pair.first_chunk()) {
        let share = (SHOWS - below) / (above - below);
        return Some(departure(from + share * (to - from)));
    }
    // Beyond the high level nothing was simulated: within a factor of ten it is in proportion.
    (last[1] > 0.1 * SHOWS).then(|| in_proportion(*last))
}
