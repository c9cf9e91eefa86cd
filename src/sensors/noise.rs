//! White Gaussian noise, quickly and with the same bits everywhere.

use super::single_pole::SinglePole;
use rand::Rng;
use rand_chacha::ChaCha8Rng;
use std::f64::consts::FRAC_PI_2;
use std::sync::LazyLock;

/// Layers that cover the bell.
const LAYERS: usize = 256;
/// Where the tail begins.
const TAIL: f64 = 3.654_152_885_361_009;
/// Area of each layer.
const AREA: f64 = 0.004_928_673_233_974_655;

static LAYER_EDGES: LazyLock<Edges> = LazyLock::new(Edges::new);

/// Noise of a constant density from 0 to half the rate at which it is added.
pub(super) struct WhiteNoise {
    rng: ChaCha8Rng,
    standard_deviation: f64,
    edges: &'static Edges,
}

impl WhiteNoise {
    /// Noise of `density` [unit/√Hz] on samples at `rate` [Hz]; none where the density is 0, so
    /// that nothing is drawn.
    pub(super) fn of_density(density: f64, rate: f64, rng: ChaCha8Rng) -> Option<Self> {
        Self::of_deviation(density * libm::sqrt(rate / 2.0), rng)
    }

    /// Noise of a standard deviation [unit]; none where it is 0.
    pub(super) fn of_deviation(standard_deviation: f64, rng: ChaCha8Rng) -> Option<Self> {
        (standard_deviation > 0.0).then(|| Self {
            rng,
            standard_deviation,
            edges: &LAYER_EDGES,
        })
    }

    /// Adds noise to every sample.
    pub(super) fn add_to(&mut self, samples: &mut [f64]) {
        for sample in samples {
            *sample += self.draw();
        }
    }

    /// One number.
    pub(super) fn draw(&mut self) -> f64 {
        self.standard_deviation * self.edges.draw(&mut self.rng)
    }
}

/// White noise behind a low pass of first order.
pub(super) struct LowPassedNoise {
    white: WhiteNoise,
    low_pass: SinglePole,
}

impl LowPassedNoise {
    /// Noise of root mean square `rms` [unit] behind a `corner` [Hz], on samples at `rate` [Hz]; none where it is 0.
    pub(super) fn new(rms: f64, corner: f64, rate: f64, rng: ChaCha8Rng) -> Option<Self> {
        // A low pass of first order lets π/2 of its corner through.
        let density = rms / libm::sqrt(FRAC_PI_2 * corner);
        let mut low_pass = SinglePole::new(corner, rate)?;
        low_pass.apply(&mut [0.0]);
        Some(Self {
            white: WhiteNoise::of_density(density, rate, rng)?,
            low_pass,
        })
    }

    /// Adds noise to every sample.
    pub(super) fn add_to(&mut self, samples: &mut [f64]) {
        for sample in samples {
            *sample += self.draw();
        }
    }

    /// One number.
    pub(super) fn draw(&mut self) -> f64 {
        let mut sample = [self.white.draw()];
        self.low_pass.apply(&mut sample);
        sample[0]
    }
}

/// The ziggurat: layers of equal area under the normal density.
///
/// # Reference
/// Marsaglia and Tsang (2000), *The Ziggurat Method for Generating Random Variables*, with the
/// independent bits of Doornik (2005).
struct Edges {
    /// Right edge of each layer; the first is that of a box with the tail's area.
    x: [f64; LAYERS + 1],
    /// Density at each edge.
    f: [f64; LAYERS + 1],
}

impl Edges {
    fn new() -> Self {
        let mut x = [0.0; LAYERS + 1];
        x[0] = AREA / density(TAIL);
        x[1] = TAIL;
        for i in 2..LAYERS {
            let above = AREA / x[i - 1] + density(x[i - 1]);
            x[i] = libm::sqrt(-2.0 * libm::log(above));
        }
        Self {
            f: x.map(density),
            x,
        }
    }

    /// A standard normal number.
    #[inline]
    fn draw(&self, rng: &mut ChaCha8Rng) -> f64 {
        loop {
            let bits = rng.next_u64();
            let layer = (bits & 0xff) as usize;
            let x = ((bits as i64) >> 11) as f64 * (1.0 / (1_u64 << 52) as f64) * self.x[layer];
            if x.abs() < self.x[layer + 1] {
                return x;
            }
            if let Some(x) = self.at_the_rim(layer, x, rng) {
                return x;
            }
        }
    }

    /// The cases, one in a hundred, where `x` is not inside the layer above.
    #[cold]
    fn at_the_rim(&self, layer: usize, x: f64, rng: &mut ChaCha8Rng) -> Option<f64> {
        if layer == 0 {
            return Some(tail(rng).copysign(x));
        }
        let (low, high) = (self.f[layer], self.f[layer + 1]);
        (low + (high - low) * uniform(rng) < density(x)).then_some(x)
    }
}

fn density(x: f64) -> f64 {
    libm::exp(-0.5 * x * x)
}

/// A number in (0, 1].
fn uniform(rng: &mut ChaCha8Rng) -> f64 {
    ((rng.next_u64() >> 11) + 1) as f64 / (1_u64 << 53) as f64
}

/// A normal number beyond the tail's beginning.
fn tail(rng: &mut ChaCha8Rng) -> f64 {
    loop {
        let x = -libm::log(uniform(rng)) / TAIL;
        if -2.0 * libm::log(uniform(rng)) > x * x {
            return TAIL + x;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quantity::Seed;

    #[test]
    fn the_numbers_are_normal_in_moments_and_in_tail() {
        let n = 2_000_000;
        let mut noise = WhiteNoise::of_deviation(1.0, Seed(1).rng("noise", 0)).unwrap();
        let draws: Vec<f64> = (0..n).map(|_| noise.draw()).collect();
        let mean = |f: &dyn Fn(f64) -> f64| draws.iter().map(|x| f(*x)).sum::<f64>() / n as f64;
        // Five standard errors of each moment: sqrt(variance of the moment / n).
        let error = |variance: f64| 5.0 * (variance / n as f64).sqrt();
        assert!(mean(&|x| x).abs() < error(1.0));
        assert!((mean(&|x| x * x) - 1.0).abs() < error(2.0));
        assert!(mean(&|x| x * x * x).abs() < error(15.0));
        assert!((mean(&|x| x.powi(4)) - 3.0).abs() < error(96.0));
        for (limit, beyond) in [(1.0, 0.317_310_5), (2.5, 0.012_419_3), (TAIL, 2.580_3e-4)] {
            let found = mean(&|x| f64::from(x.abs() > limit));
            assert!((found - beyond).abs() < error(beyond), "{limit}: {found}");
        }
    }

    #[test]
    fn the_top_layer_closes_on_the_peak() {
        let edges = Edges::new();
        let top = edges.x[LAYERS - 1] * (1.0 - edges.f[LAYERS - 1]);
        assert!((top - AREA).abs() < 1e-9, "area of the top layer {top}");
    }
}
